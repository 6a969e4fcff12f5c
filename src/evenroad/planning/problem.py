"""Problem, a query that planners solve, and Planner, their interface."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, TypedDict, runtime_checkable

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad._rng import RngLike
from evenroad.collision.arm_world import ArmWorld
from evenroad.loading.model import RobotModel
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.connector import Smooth, require_smooth
from evenroad.planning.result import PlanResult
from evenroad.poses.constraint import Constraint
from evenroad.poses.goals import Goals
from evenroad.roadmap.budget import Budget
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.driving.goal_region import GoalRegion

_USUAL = Budget()


class Wanted(TypedDict, total=False):
    """Keywords about the path of a :class:`Problem`."""

    budget: Budget
    smooth: Smooth
    rng: RngLike
    certified: bool
    constraints: Constraint | None
    prefer_clearance: float


@dataclass(frozen=True, eq=False)
class Problem:
    """A query: a path in a world from a start to one of several goals.

    Attributes
    ----------
    world : World
        The world, which checks configurations and motions.
    start, goals : ndarrays, shapes (dim,) and (g, dim)
        Configurations; they become read-only.
    budget : Budget
        Limits of the search.
    smooth : bool or "quick"
        Whether the path is smoothed; "quick": by straight shortcuts alone.
    rng : int, SeedSequence or Generator
        Seed of the planner.
    certified : bool
        Whether every motion is to be proved free; :func:`evenroad.plan` checks it once more.
    constraints : Constraint, optional
        Constraints of an arm's path; :func:`evenroad.plan` divides such a problem into others without constraints.
    given : Goals, optional
        Names and poses of an arm's goals, if these were given as more than configurations.
    model : RobotModel, optional
        The record of the arm's file.
    regions : tuple of GoalRegion
        Regions that some goals are poses of; a proof that there is no path is about all of their poses.
    prefer_clearance : float
        Distance from obstacles that a path of a disk or a car keeps where there is room for it, in map units.
    """

    world: World
    start: Floats
    goals: Floats
    _: KW_ONLY
    budget: Budget = _USUAL
    smooth: Smooth = True
    rng: RngLike = 0
    certified: bool = False
    constraints: Constraint | None = None
    given: Goals | None = None
    model: RobotModel | None = None
    regions: tuple[GoalRegion, ...] = ()
    prefer_clearance: float = 0.0

    def __post_init__(self) -> None:
        require_smooth(self.smooth)
        require_positive("prefer_clearance", self.prefer_clearance, or_zero=True)
        self.start.setflags(write=False)
        self.goals.setflags(write=False)

    @cached_property
    def start_and_goals(self) -> Floats:
        """The start, then the goals, (1 + g, dim)."""
        terminals = np.concatenate([self.start[np.newaxis], self.goals])
        terminals.setflags(write=False)
        return terminals

    @property
    def arm(self) -> ArmWorld:
        """The world of an arm."""
        assert isinstance(self.world, ArmWorld), "only of an arm's problem"
        return self.world

    @property
    def source(self) -> RobotFile | None:
        """The file of the arm."""
        return None if self.model is None else self.model.file

    @property
    def goal_names(self) -> tuple[str, ...]:
        """The caller's texts for the goals, or nothing."""
        return () if self.given is None else self.given.names

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes about what was changed in reading the files, and what seems unusual in them."""
        of_robot = () if self.model is None else self.model.notes
        return of_robot + tuple(getattr(self.world, "notes", ()))

    @property
    def tip(self) -> str:
        """The link that goal poses refer to, or nothing."""
        return self.given.poses[0][0].tip if self.given is not None and self.given.poses else ""


@runtime_checkable
class Planner(Protocol):
    """A frozen value that solves problems."""

    def solve(self, problem: Problem) -> PlanResult:
        """Return a path, or why there is none; after a Ctrl-C raise Interrupted if there is a path."""


class Interrupted(KeyboardInterrupt):
    """A Ctrl-C while a path became shorter: `best` is the shortest result so far."""

    def __init__(self, best: PlanResult) -> None:
        super().__init__()
        self.best = best
