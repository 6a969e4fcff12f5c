"""Constraints of a door, of two tips together, and of joints."""

# What methods of the constraints return stands in `Keep`.
# ruff: noqa: D102
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_row, require_known, require_positive
from evenroad.constraints.keep import WITHIN, Keep, pose_row, tip_pose
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector
from evenroad.poses.cartesian_path import Moves
from evenroad.poses.pose_goal import as_axis
from evenroad.robots.robot import Robot

if TYPE_CHECKING:
    from evenroad._native.robot import KeepKind


@dataclass(frozen=True)
class KeepOnCircle(Keep):
    """A link moves with a door: its origin stays on a circle about the hinge, and it turns with the door.

    Parameters
    ----------
    centre : sequence of 3 floats
        A point of the hinge in the frame of the root [m].
    axis : sequence of 3 floats, or "x", "y", "z"
        Direction of the hinge.
    within : float
        Largest distance from the circle, > 0 [m].  The rotation may be off by ten times as much [rad].
    pose : Pose, optional
        A pose of the link that it passes; default: that at the start.
    tip : str
        The link; default: that of the goal poses, or the last one.

    Raises
    ------
    InvalidValue
        If a number is out of range, or the tip is on the hinge at the start.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepOnCircle((0.8, 0.3, 0)).axis
    (0.0, 0.0, 1.0)
    """

    centre: Vector
    axis: Vector | str = "z"
    within: float = WITHIN
    pose: Pose | None = None
    tip: str = ""
    deviation: ClassVar[str] = "circle_m"
    kept: ClassVar[str] = "its circle"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("within", self.within), axis=as_axis("axis", self.axis))
        set_fields(self, centre=as_row("centre", self.centre, 3))

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        tip = self.tip or tip
        made = replace(self, pose=self.pose or tip_pose(robot, tip, q), tip=tip)
        if made.radius < 10.0 * self.within:
            raise InvalidValue(
                f"the circle of {tip!r} needs a radius, got {made.radius:.3g} m about {shown(self.centre)}"
            )
        return made

    @property
    def frame(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Hinge, and the directions along it, outward at the pose, and of the turn."""
        assert self.pose is not None, "only of a bound constraint"
        along = np.array(self.axis, dtype=np.float64)
        gap = np.subtract(self.pose.xyz, self.centre)
        out = gap - along * (gap @ along)
        out = out / max(float(np.linalg.norm(out)), 1e-12)
        return np.array(self.centre), along, out, np.cross(along, out)

    @property
    def radius(self) -> float:
        """Radius of the circle [m]."""
        assert self.pose is not None, "only of a bound constraint"
        return float(np.subtract(self.pose.xyz, self.centre) @ self.frame[2])

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        assert self.pose is not None, "only of a bound constraint"
        return "circle", np.concatenate([*self.frame, [self.radius], pose_row(self.pose)])

    def bend(self, moves: Sequence[Moves]) -> Floats:
        # The second derivative of the distance from the hinge is at most that of the tip, plus its squared speed over
        # that distance. The door's angle is a polar angle. No motion within the limit is nearer than half the radius.
        (tip,), near = moves, 0.5 * self.radius
        rate = tip.speed / near
        swing = tip.push / near + 2.0 * rate**2
        return 2.0 * tip.push + tip.speed**2 / near + 0.1 * (tip.swing + rate**2 + swing)


@dataclass(frozen=True)
class KeepTogether(Keep):
    """Two links keep their relative pose, like two hands that hold one box.

    Parameters
    ----------
    first, second : str
        The links.
    within : float
        Largest distance of the second from its place relative to the first, > 0 [m].  It may turn by ten times as much
        [rad].
    pose : Pose, optional
        Pose of the second in the frame of the first; default: that at the start.

    Raises
    ------
    InvalidValue
        If `within` is not such a number.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepTogether("tool0", "left_tool0").tips
    ('tool0', 'left_tool0')
    """

    first: str
    second: str
    within: float = WITHIN
    pose: Pose | None = None
    deviation: ClassVar[str] = "together_m"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("within", self.within))

    @property
    def tips(self) -> tuple[str, ...]:
        return self.first, self.second

    @property
    def key(self) -> tuple[object, ...]:
        return type(self), *self.tips

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        first, second = (tip_pose(robot, link, q) for link in self.tips)
        return replace(self, pose=self.pose or first.inverse() @ second)

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        assert self.pose is not None, "only of a bound constraint"
        return "together", np.array(pose_row(self.pose))

    def bend(self, moves: Sequence[Moves]) -> Floats:
        assert self.pose is not None, "only of a bound constraint"
        a, b = moves
        far = float(np.linalg.norm(self.pose.xyz)) + 0.1
        gap = a.push + b.push + 2.0 * a.turn * (a.speed + b.speed) + a.swing * far
        return gap + 0.1 * 2.5 * (a.turn + b.turn) ** 2

    def words(self, off: float) -> str:
        return f"{self.second!r} is {off:.4g} m off where {self.first!r} holds it, more than {self.within:.4g}"


@dataclass(frozen=True)
class KeepJoints(Keep):
    """Joints stay within ranges.

    Parameters
    ----------
    ranges : mapping of str to (low, high)
        Joint -> range [rad or m].
    within : float
        Largest excess of a joint over its range [rad or m].
    joints : tuple of str
        All joints of the robot; filled from it.

    Raises
    ------
    InvalidValue
        If a range is not low <= high.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepJoints({"elbow_joint": (0, 2.5)}).ranges
    {'elbow_joint': (0, 2.5)}
    """

    ranges: Mapping[str, tuple[float, float]]
    within: float = 1e-9
    joints: tuple[str, ...] = ()
    deviation: ClassVar[str] = "joints_rad"

    def __post_init__(self) -> None:
        for name, each in dict(self.ranges).items():
            low, high = as_row(f"the range of {name!r}", each, 2)
            if low > high:
                raise InvalidValue(f"the range of {name!r} must be low <= high, got {shown(each)}")

    @property
    def tips(self) -> tuple[str, ...]:
        return ()

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        for name in self.ranges:
            require_known(f"joint of {robot.name!r}:", name, robot.group)
        return replace(self, joints=robot.group)

    @property
    def bounds(self) -> Floats:
        """Lows and highs of all joints, (2, dim)."""
        return np.array([self.ranges.get(name, (-np.inf, np.inf)) for name in self.joints]).T

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        return "joints", self.bounds.ravel()

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return np.zeros(1)

    def words(self, off: float) -> str:
        return f"a joint is {off:.4g} outside of its range"
