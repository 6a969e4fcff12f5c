from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad._native.planning import Checks
from evenroad._native.robot import Checker

Int8s: TypeAlias = npt.NDArray[np.int8]

TURN_BITS: int
MOST_TURNS: int
MOST_MULTI_TURN: int

class SceneGraph:
    """A roadmap in one scene: what is known of its milestones and edges, and those inserted there; for one thread."""

    size: int
    def __init__(
        self,
        milestones: Floats,
        edges: Ints32,
        turns: Int8s,
        joints: tuple[Floats, Floats, Bools, Bools],
    ) -> None: ...
    def within(self, low: Floats, high: Floats, changed: Checks | None = None) -> SceneGraph: ...
    def insert(self, path: Floats) -> None: ...

class Search:
    """A search that requests each check; `rules` are links of each terminal, and greed."""

    path: Floats
    goal: int
    counts: tuple[int, int]
    def __init__(self, graph: SceneGraph, start_and_goals: Floats, rules: tuple[int, float]) -> None: ...
    def next_check(self) -> tuple[Literal["milestone", "motion"], bool, Floats, Floats] | None: ...
    def record(self, is_free: bool) -> None: ...

class ProvedSearch:
    """A search with native checks: of everything, and of what the roadmap does not know to be free."""

    path: Floats
    goal: int
    counts: tuple[int, int, int]
    def __init__(
        self,
        graph: SceneGraph,
        start_and_goals: Floats,
        rules: tuple[int, float],
        everything: Checks,
        moved: Checks,
    ) -> None: ...
    def go_on(self, most_motions: int, batches: int) -> Literal["found", "no path", "not free", "spent", "paused"]: ...

def rows_joined(
    walls: list[Checker], inside: Checker, pool: Floats, from_rows: Ints, rows: Ints, early: Floats
) -> tuple[Ints, Ints]: ...
def scenes_free(checkers: list[Checker], q: Floats) -> Ints32: ...
