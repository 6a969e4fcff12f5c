from collections.abc import Sequence
from typing import Literal

from evenroad._arrays import Bools, Floats, Ints
from evenroad._native.robot import Checker

CLEARANCES: tuple[float, float]

class Counts:
    motions: int
    configurations: int
    batches: int

class Checks:
    counts: Counts
    def __init__(self, checker: Checker) -> None: ...

class Points:
    def __init__(self, points: Floats) -> None: ...

class Drivers:
    def __init__(self, samples: Points, steps: Points, pairs: Points, directions: Points) -> None: ...

class Answer:
    ended: Literal["paused", "spent", "not free", "solved"]
    raw: Floats
    path: Floats
    raw_length: float
    length: float
    nodes: int
    configurations: int
    motions: int
    smoothing_motions: int
    search_seconds: float
    smoothing_seconds: float
    is_cut: bool
    def smooth_with_clearance(self, checker: Checker, roomier: Checker, drivers: Drivers) -> None: ...

class Trees:
    path: Floats
    goal: int
    sizes: tuple[int, int]
    trees: tuple[tuple[Floats, Ints], tuple[Floats, Ints]]
    def __init__(self, checks: Checks, terminals: Floats, samples: Points, steps: Points) -> None: ...
    def grow(self, most_motions: int, batches: int) -> Literal["paused", "spent", "not free", "solved"]: ...

class Improver:
    path: Floats
    along_trees: Floats
    goal: int
    length: float
    rounds: int
    motions: int
    smoothing_motions: int
    nodes: int
    def __init__(
        self,
        checks: Checks,
        terminals: Floats,
        drivers: Drivers,
        path: Floats,
        goal: int,
        motions: int,
        is_smoothing: bool,
    ) -> None: ...
    def improve(self, rounds: int, motions: int, batches: int) -> Literal["paused", "spent", "shortest"]: ...

class Tree:
    nodes: tuple[Floats, Ints]
    def __init__(self, period: Floats) -> None: ...
    def add(self, q: Floats, parent: int) -> int: ...
    def nearest(self, q: Floats) -> int: ...
    def remove_branch(self, node: int) -> None: ...

class Columns:
    """The queries with a path, the first waypoint of each, all waypoints, and lengths and seconds."""

    solved: Bools
    begins: Ints
    waypoints: Floats
    lengths: Floats
    seconds: Floats

class ManyQueries:
    columns: Columns
    def __init__(
        self,
        checkers: Sequence[Checker],
        roomier: Sequence[Checker | None],
        of: Ints,
        terminals: Floats,
        drivers: Drivers,
        motions: int,
        seconds: tuple[float, float],
        smoothing: Literal["none", "quick", "full", "with clearance"],
    ) -> None: ...
    def go_on(self, threads: int, seconds: float) -> int: ...
    def answer(self, query: int) -> Answer: ...

def answer(
    checker: Checker,
    start: Floats,
    goal: Floats,
    drivers: Drivers,
    motions: int,
    search_seconds: float,
    smoothing: Literal["none", "quick", "full", "with clearance"],
) -> Answer: ...
def shorten(checks: Checks, path: Floats, pairs: Points, most_shortcuts: int) -> tuple[Floats, int]: ...
def smooth(
    checks: Checks, path: Floats, drivers: Drivers, most_batches: int, proved: bool
) -> tuple[Floats | None, int]: ...
def smooth_with_clearance(
    checks: Checks, roomier: Checks, path: Floats, drivers: Drivers, most_batches: int
) -> tuple[Floats, int]: ...
