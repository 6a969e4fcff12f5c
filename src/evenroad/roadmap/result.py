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


@dataclass(frozen=True, eq=False)
class Roadmap:
    """The milestones and free motions of one query, as they were searched.

    Attributes
    ----------
    configurations : ndarray, shape (v, dim)
        Valid milestones, then start, then goal.
    edges : ndarray of int32, shape (m, 2)
        Motions found free, as pairs of rows, smaller first.
    """

    configurations: npt.NDArray[np.float64]
    edges: npt.NDArray[np.int32]


@dataclass(frozen=True, eq=False, kw_only=True)
class PlanResult:
    """The answer to one query.

    Attributes
    ----------
    status : Status
        ``solved``, ``start_invalid``, ``goal_invalid`` or ``not_connected``.
    message : str
        One sentence for people: what happened and, without a path, what to try.
    start, goal : ndarray, shape (dim,)
        The query.
    path : ndarray, shape (p, dim), or None
        Waypoints after shortcutting, from start to goal, in the units of the space.
    milestone_path : ndarray, shape (q, dim), or None
        The shortest path along the roadmap, before shortcutting.
    cost, milestone_cost : float or None
        Lengths of the two in the metric of the space.
    counts : dict of str to int
        ``points``, ``valid``, ``edges_checked``, ``edges_free``, ``shortcut_motions`` and, when not connected,
        ``start_piece`` and ``goal_piece`` (milestones that each end can reach).
    seconds : dict of str to float
        Wall time of each phase: ``validity``, ``neighbours``, ``motions``, ``search``, ``shortcut``.
    origin : Origin
        Where the points came from.
    rule : str
        The connection rule, by name.
    roadmap : Roadmap or None
        What was searched; None when start or goal is invalid.
    """

    status: Status
    message: str
    start: npt.NDArray[np.float64]
    goal: npt.NDArray[np.float64]
    origin: Origin
    rule: str
    path: npt.NDArray[np.float64] | None = None
    milestone_path: npt.NDArray[np.float64] | None = None
    cost: float | None = None
    milestone_cost: float | None = None
    counts: dict[str, int] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    roadmap: Roadmap | None = None

    @property
    def solved(self) -> bool:
        """Whether a path was found."""
        return self.status is Status.SOLVED
