"""Problem and Planner: what is to be solved, and who solves it."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Protocol, runtime_checkable

from evenroad._arrays import Floats
from evenroad._rng import RngLike
from evenroad.planning.connector import Connector, Smooth
from evenroad.planning.query import ProvesApart
from evenroad.planning.result import PlanResult
from evenroad.roadmap.budget import Budget
from evenroad.world import World


@dataclass(frozen=True, eq=False)
class Problem:
    """Find a path in a world from a start to one of some goals.

    Attributes
    ----------
    world : World
        Checks configurations and motions.
    start, goals : ndarrays, shapes (dim,) and (g, dim)
        Configurations.
    budget : Budget
        Limits of the search.
    smooth : bool or "quick"
        Whether the path is made shorter once it is found; "quick": by straight shortcuts alone.
    rng : int, SeedSequence or Generator
        Seed of what a planner draws.
    apart : callable, optional
        Proves, instead of the world, that no path exists, where other goals would do, too.  It takes start, goals and
        whether to be quick, and returns an :class:`evenroad.world.Apart` or None.
    connector : Connector, optional
        Joins start and goal in this kind of world, and smooths paths, in compiled code.
    """

    world: World
    start: Floats
    goals: Floats
    _: KW_ONLY
    budget: Budget
    smooth: Smooth = True
    rng: RngLike = 0
    apart: ProvesApart | None = None
    connector: Connector | None = None


@runtime_checkable
class Planner(Protocol):
    """Solves problems; a frozen value that says how."""

    def solve(self, problem: Problem) -> PlanResult:
        """Return a path, or why there is none."""
