import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints

class ShapeTables:
    def __init__(self, points: Floats, corners: Ints, sizes: Floats, numbers: Ints) -> None: ...

class JointTables:
    def __init__(self, links: Ints, poses: Floats, rules: Floats) -> None: ...

class Paths:
    def __init__(self, curves: Floats, tolerance: float, frames: Ints, limits: Floats, numbers: Floats) -> None: ...

class Touch:
    motion: int
    share: float
    pair: int
    gap: float
    most: float

class Answers:
    answers: npt.NDArray[np.uint8]
    directions: npt.NDArray[np.float32]
    touch: Touch

def write_answers(
    shape_tables: ShapeTables,
    joint_tables: JointTables,
    nodes: Ints,
    shapes: Ints,
    pairs: Ints,
    keeps: Floats,
    paths: Paths,
    most: int,
) -> Answers | None: ...
