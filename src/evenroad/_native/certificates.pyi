import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints

def write_answers(
    shapes: tuple[Floats, Ints, Floats, Ints],
    joints: tuple[Ints, Floats, Floats],
    nodes: tuple[Ints, Ints],
    pairs: tuple[Ints, Floats],
    curves: Floats,
    most: int,
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32], int, float, int, float] | None: ...
