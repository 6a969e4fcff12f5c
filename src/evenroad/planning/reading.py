"""Options for reading configurations and poses."""

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
    """Options for reading texts and poses.

    Attributes
    ----------
    degrees : bool
        Angles in texts are degrees.
    tip, frame : str
        The link that goal poses refer to, and the link whose frame they are in.  Default: the last link, and the root.
    held : mapping, optional
        Values of joints that are not planned for, joint -> value [rad or m].
    """

    degrees: bool = False
    tip: str = ""
    frame: str = ""
    held: Mapping[str, float] | None = None
