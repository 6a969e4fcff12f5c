"""PlanResult: a path, or the reason why there is none, with everything that was counted."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from evenroad.points.pointset import Origin


class Status(StrEnum):
    """How a query ended.  No path is an answer, not an error."""

    SOLVED = "solved"
    START_INVALID = "start_invalid"
    GOAL_INVALID = "goal_invalid"
    NOT_CONNECTED = "not_connected"
    BUDGET_SPENT = "budget_spent"
    MESH_COLLISION = "mesh_collision"
    NOT_CERTIFIED = "not_certified"


@dataclass(frozen=True, eq=False)
class SearchedGraph:
    """The milestones and motions known to be free in one query: what pictures show.

    Attributes
    ----------
    configurations : ndarray, shape (v, dim)
        Milestones not known to be invalid, then the start, then the goals.
    edges : ndarray of int32, shape (m, 2)
        Motions found free, as pairs of rows, smaller first.
    milestones : int
        How many of the rows are milestones.
    """

    configurations: npt.NDArray[np.float64]
    edges: npt.NDArray[np.int32]
    milestones: int


@dataclass(frozen=True)
class Stage:
    """One stage of a plan that grows, or a round of one that improves in which a better path was found.

    Attributes
    ----------
    points, valid : int
        N so far, and how many of them are valid; of a round, the nodes of all trees so far, all valid.
    edges_checked : int
        Motions checked up to the end of this stage.
    cost : float or None
        Of this stage's path along the roadmap, of a round's path after shortcutting; None when there was none.
    seconds : float
        Wall time from the start of the query to the end of this stage; not compared.
    """

    points: int
    valid: int
    edges_checked: int
    cost: float | None
    seconds: float = field(default=0.0, compare=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class PlanResult:
    """The answer to one query.

    Attributes
    ----------
    status : Status
        ``solved``, ``start_invalid``, ``goal_invalid`` (all goals), ``not_connected``, ``budget_spent``; or
        ``mesh_collision``: the path is free in its world, but the robot's meshes touch something; or
        ``not_certified``: a proof was asked for, and the path is free only at the states that were tested.
    message : str
        One sentence for people: what happened and, without a path, what to try.
    start : ndarray, shape (dim,)
        Of the query.
    goals : ndarray, shape (g, dim)
        Of the query.
    goal_index : int or None
        Which of the goals the path ends at; None without a path.
    path : ndarray, shape (p, dim), or None
        Waypoints after shortcutting, from start to goal, in the units of the space.
    milestone_path : ndarray, shape (q, dim), or None
        The shortest path along the roadmap, before shortcutting.
    proof : str or None
        What is shown of the motions of `path`: ``exact`` (no gap, up to rounding), ``certified`` (no gap), or
        ``resolution`` (free at states close together); None without a path.
    cost, milestone_cost : float or None
        Of the two: lengths in the metric of the space, or the user's edge costs.
    counts : dict of str to int
        ``points`` (N), ``valid`` (milestones known to be valid), ``configurations_checked`` (without those inside
        of motions), ``edges_considered``, ``edges_checked``, ``edges_free`` (known to be),
        ``shortcut_motions``, ``nodes`` (of trees), ``rounds`` (of a planner that improves) and, when not connected,
        ``start_component`` and ``goal_component`` (milestones that start and goals can reach over what is not known
        to be blocked).
    seconds : dict of str to float
        Wall time of each phase: ``validity``, ``neighbours``, ``motions``, ``search``, ``shortcut``.
    origin : Origin
        Where the points came from.
    rule : str
        The connection rule, by name.
    links : int or None
        To how many of the nearest milestones start and goals were linked besides (to all, up to 256); None: to none.
    planner : str
        Who searched: ``prm full``, ``prm lazy``, ``prm any`` (some path, not the shortest), each with
        ``+ lazy milestones`` where those were checked late; ``prm anytime``, ``fmt*``; or the world itself, with
        ``trees`` or ``cells``.
    stages : tuple of Stage
        How a plan that grows or improves came about, its cost over time; empty for all others.
    roadmap : SearchedGraph or None
        What was searched; None when start or goal is invalid, and where a reused roadmap was asked.
    """

    status: Status
    message: str
    start: npt.NDArray[np.float64]
    goals: npt.NDArray[np.float64]
    origin: Origin
    rule: str
    links: int | None = None
    planner: str = "prm full"
    goal_index: int | None = None
    path: npt.NDArray[np.float64] | None = None
    milestone_path: npt.NDArray[np.float64] | None = None
    proof: str | None = None
    cost: float | None = None
    milestone_cost: float | None = None
    counts: dict[str, int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    stages: tuple[Stage, ...] = ()
    roadmap: SearchedGraph | None = None

    @property
    def solved(self) -> bool:
        """Whether a path was found."""
        return self.status is Status.SOLVED

    @property
    def goal(self) -> npt.NDArray[np.float64]:
        """The goal that the path ends at, (dim,); without a path the first one."""
        return self.goals[0 if self.goal_index is None else self.goal_index]
