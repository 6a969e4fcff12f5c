import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats

def nearest(flat: Floats, columns: int, rows: int) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]: ...
def paint(
    camera: Floats,
    scale: float,
    columns: int,
    rows: int,
    studio: Floats,
    corners: Floats,
    normals: Floats,
    colours: Floats,
    closed: Bools,
    see_through: int,
    layers: Floats,
) -> npt.NDArray[np.uint8]: ...
