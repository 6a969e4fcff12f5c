"""How configurations and poses are given, and how they are read."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from evenroad.geometry.pose import Pose
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
