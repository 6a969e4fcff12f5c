from typing import Literal

from evenroad._arrays import Bools, Floats, Ints

class SplitCells:
    """Cells of the ranges of joints, split only where a path may lead through them.

    `low` and `size` are the lower end of each range and the extent of a cell there; `whole` says where cells go all
    around the circle.
    """

    def __init__(self, low: Floats, size: Floats, count: Ints, period: Floats, whole: Bools) -> None: ...
    @property
    def depths(self) -> list[int]:
        """How often the cells that wait were split, ascending."""

    def middles(self, depth: int) -> Floats: ...
    def decide(self, depth: int, unblocked: Bools, clear: Bools) -> None: ...
    def search(self, start: Floats, goals: Floats, most: int) -> Literal["apart", "joined", "split", "undecided"]: ...

def reached_cells(free: Bools, count: Ints, wraps: Bools, start: int) -> Bools: ...
