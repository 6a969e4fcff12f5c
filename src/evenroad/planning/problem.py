"""Problem and Planner: what is to be solved, and who solves it."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np

from evenroad._arrays import Floats
from evenroad._rng import RngLike
from evenroad.planning.connector import Smooth, require_smooth
from evenroad.planning.result import PlanResult
from evenroad.poses.goals import Goals
from evenroad.roadmap.budget import Budget
from evenroad.world import World

_USUAL = Budget()


@dataclass(frozen=True, eq=False)
class Problem:
    """Find a path in a world from a start to one of some goals.

    Attributes
    ----------
    world : World
        Checks configurations and motions.
    start, goals : ndarrays, shapes (dim,) and (g, dim)
        Configurations; they become read-only.
    budget : Budget
        Limits of the search.
    smooth : bool or "quick"
        Whether the path is made shorter once it is found; "quick": by straight shortcuts alone.
    rng : int, SeedSequence or Generator
        Seed of what a planner draws.
    given : Goals, optional
        What the goals of an arm were made of.
    """

    world: World
    start: Floats
    goals: Floats
    _: KW_ONLY
    budget: Budget = _USUAL
    smooth: Smooth = True
    rng: RngLike = 0
    given: Goals | None = None

    def __post_init__(self) -> None:
        require_smooth(self.smooth)
        self.start.setflags(write=False)
        self.goals.setflags(write=False)

    @cached_property
    def start_and_goals(self) -> Floats:
        """The start, then the goals, (1 + g, dim)."""
        terminals = np.concatenate([self.start[np.newaxis], self.goals])
        terminals.setflags(write=False)
        return terminals


@runtime_checkable
class Planner(Protocol):
    """Solves problems; a frozen value that says how."""

    def solve(self, problem: Problem) -> PlanResult:
        """Return a path, or why there is none."""
