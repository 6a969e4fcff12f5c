from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints

class Elements:
    def __init__(
        self, points: Floats, corners: Ints, radius: float, disc: float, axis: Floats, is_box: bool
    ) -> None: ...

class Node:
    def __init__(self, frame: int, shapes: Sequence[Elements]) -> None: ...

class Pair:
    def __init__(self, first: Node, second: Node, keep: float) -> None: ...

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

def write_answers(joint_tables: JointTables, pairs: Sequence[Pair], paths: Paths, most: int) -> Answers | None: ...
def write_box(
    joint_tables: JointTables, pair: Pair, low: Floats, high: Floats, columns: Ints, most: int
) -> Answers | None: ...
def parabolas(states: Floats, low: Floats, high: Floats, tolerance: float) -> Floats: ...
def text_of_rows(rows: Floats, before: str) -> bytes: ...
