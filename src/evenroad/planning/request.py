"""Request: a world, a start and goals, and how they were given."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.loading.description import RobotModel
from evenroad.loading.urdf_xml import RobotFile
from evenroad.planning.result import PlanResult, Status, make_result
from evenroad.poses.goals import Goals
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import ConfigurationLike

PathLike = str | os.PathLike[str]
Goal = ConfigurationLike | Pose | PoseGoal
"""A configuration, or a pose of a link."""


@dataclass(frozen=True)
class Reading:
    """How texts and poses are read.

    Attributes
    ----------
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        The link that goal poses place, and the link in whose frame.  Default: the last link, and the root.
    held : mapping, optional
        Values of joints that are not planned for, joint -> value [rad or m].
    """

    degrees: bool = False
    tip: str = ""
    frame: str = ""
    held: Mapping[str, float] | None = None


@dataclass(frozen=True, eq=False)
class Request:
    """A world, a start, (dim,), and goals, (g, dim).

    For an arm, `given` says what the goals were made of, and its robot holds the joints that are not planned for at the
    values of named states.  `source` is the file of the robot and `model` how it was read; both are None for a value.
    """

    world: Any
    start: Floats
    goals: Floats
    given: Goals | None = None
    source: RobotFile | None = None
    model: RobotModel | None = None

    @property
    def goal_names(self) -> tuple[str, ...]:
        """The texts by which the caller named the goals, or nothing."""
        return () if self.given is None else self.given.names

    @property
    def notes(self) -> tuple[str, ...]:
        """What was read otherwise than the files say, and what seems unusual in them."""
        of_robot = () if self.model is None else self.model.notes
        return of_robot + tuple(getattr(self.world, "notes", ()))

    @property
    def tip(self) -> str:
        """The link that goal poses place, or nothing."""
        return self.given.poses[0][0].tip if self.given is not None and self.given.poses else ""


def refused(request: Request, status: Status, message: str) -> PlanResult:
    """Return the result of a plan that was not made."""
    return make_result(request.world, request.start, request.goals, status, message)


def unreached(request: Request) -> PlanResult | None:
    """Return the result where no posture reaches a pose among the goals; else None."""
    given = request.given
    if given is None or not given.unreached:
        return None
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    if given.spent:
        status = Status.BUDGET_SPENT
    return replace(refused(request, status, given.unreached), timings={"goals": given.seconds})
