"""Request: a world, a start and goals, with what is known of how they were given."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.geometry.pose import Pose
from evenroad.robot import RobotModel
from evenroad.robot.goals import Goals
from evenroad.robot.pose_goal import PoseGoal
from evenroad.robot.urdf_xml import RobotFile

PathLike = str | os.PathLike[str]
ConfigurationLike = str | Mapping[str, float] | npt.ArrayLike
"""A configuration: numbers in the order of the group, joint -> value, or a text as
:func:`evenroad.robot.configuration` takes it."""

Goal = ConfigurationLike | Pose | PoseGoal
"""A configuration, or where a link is to be."""


@dataclass(frozen=True)
class Reading:
    """How texts and poses are read.

    Attributes
    ----------
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        Of which link goal poses are, and in the frame of which.  Default: the last link, and the root.
    held : mapping, optional
        Values of joints that are not planned for, joint -> value [rad or m].
    """

    degrees: bool = False
    tip: str = ""
    frame: str = ""
    held: Mapping[str, float] | None = None


@dataclass(frozen=True, eq=False)
class Request:
    """A world with where to start, (dim,), and the goals, (g, dim).

    Of an arm, `given` says what the goals were made of.  Its robot is held where named states have the joints that are
    not planned for.  `source`, where it was read, and `model`, how it was made, are None for a robot that was given as
    a value.
    """

    world: Any
    start: Floats
    goals: Floats
    given: Goals | None = None
    source: RobotFile | None = None
    model: RobotModel | None = None

    @property
    def goal_names(self) -> tuple[str, ...]:
        """By which texts the caller called the goals, or nothing."""
        return () if self.given is None else self.given.names

    @property
    def tip(self) -> str:
        """The link that goal poses are of, or nothing."""
        return self.given.poses[0][0].tip if self.given is not None and self.given.poses else ""
