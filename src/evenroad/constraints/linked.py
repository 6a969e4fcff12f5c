"""Constraints of a door, of two tips together, and of joints."""

# What methods of the constraints return stands in `Keep`.
# ruff: noqa: D102
from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_row, require_known, require_positive
from evenroad.constraints.keep import WITHIN, Keep, cross_matrix, turned_derivative, turns_of
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector
from evenroad.robot import Robot
from evenroad.robot.cartesian_path import Moves
from evenroad.robot.chain import chain_of
from evenroad.robot.pose_goal import as_axis


@dataclass(frozen=True)
class KeepOnCircle(Keep):
    """A link moves with a door: its origin on a circle about the hinge, turned as the door is.

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

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("within", self.within), axis=as_axis("axis", self.axis))
        set_fields(self, centre=as_row("centre", self.centre, 3))

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        tip = self.tip or tip
        row = chain_of(robot, tip).tip_poses(q[np.newaxis])[0].tolist()
        made = replace(self, pose=self.pose or Pose(tuple(row[9:]), tuple(row[:9])), tip=tip)
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

    def _angles(self, tips: Floats) -> tuple[Floats, Floats]:
        """Return the angle of the door at the tip's place, and its distance from the hinge, (n,) each."""
        centre, _, out, across = self.frame
        x, y = (tips[:, 9:] - centre) @ out, (tips[:, 9:] - centre) @ across
        return np.arctan2(y, x), np.maximum(np.hypot(x, y), 1e-9)

    def _door(self, angle: Floats) -> Floats:
        """Return the rotations of the tip at the door's angles, (n, 3, 3)."""
        assert self.pose is not None, "only of a bound constraint"
        skew = cross_matrix(np.array(self.axis, dtype=np.float64)[np.newaxis])[0]
        sine, cosine = np.sin(angle)[:, np.newaxis, np.newaxis], np.cos(angle)[:, np.newaxis, np.newaxis]
        return (np.eye(3) + sine * skew + (1.0 - cosine) * (skew @ skew)) @ self.pose.rotation_matrix

    def residual(self, q: Floats, tips: Sequence[Floats]) -> Floats:
        along = self.frame[1]
        assert self.pose is not None, "only of a bound constraint"
        angle, far = self._angles(tips[0])
        height = (tips[0][:, 9:] - np.array(self.pose.xyz)) @ along
        turned = 0.1 / math.sqrt(2.0) * (tips[0][:, :9] - self._door(angle).reshape(-1, 9))
        return np.column_stack([far - self.radius, height, turned])

    def derivative(self, q: Floats, tips: Sequence[Floats], of_tips: Sequence[Floats]) -> Floats:
        _, along, out, across = self.frame
        angle, far = self._angles(tips[0])
        radial = np.cos(angle)[:, np.newaxis] * out + np.sin(angle)[:, np.newaxis] * across
        tangent = np.cross(along, radial)
        moved, turned = of_tips[0][:, :3], of_tips[0][:, 3:]
        swing = (tangent[:, np.newaxis] @ moved) / far[:, np.newaxis, np.newaxis]
        of_door = along[np.newaxis, :, np.newaxis] * swing
        rows = turned_derivative(turns_of(tips[0]), turned) - turned_derivative(self._door(angle), of_door)
        height = along[np.newaxis, np.newaxis] @ moved
        return np.concatenate([radial[:, np.newaxis] @ moved, height, 0.1 / math.sqrt(2.0) * rows], axis=1)

    def bend(self, moves: Sequence[Moves]) -> Floats:
        # Of the distance from the hinge it is at most that of the tip and its speed squared by that distance, of the
        # door's angle as of a polar one; nearer than half the radius no motion is within the limit anyway.
        (tip,), near = moves, 0.5 * self.radius
        rate = tip.speed / near
        swing = tip.push / near + 2.0 * rate**2
        return 2.0 * tip.push + tip.speed**2 / near + 0.1 * (tip.swing + rate**2 + swing)

    def __str__(self) -> str:
        return "its circle"


@dataclass(frozen=True)
class KeepTogether(Keep):
    """Two links keep their pose to each other, as two hands that hold one box.

    Parameters
    ----------
    first, second : str
        The links.
    within : float
        Largest distance of the second from where it is held by the first, > 0 [m].  It may turn by ten times as much
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
        rows = [chain_of(robot, link).tip_poses(q[np.newaxis])[0].tolist() for link in self.tips]
        first, second = (Pose(tuple(row[9:]), tuple(row[:9])) for row in rows)
        return replace(self, pose=self.pose or first.inverse() @ second)

    def residual(self, q: Floats, tips: Sequence[Floats]) -> Floats:
        assert self.pose is not None, "only of a bound constraint"
        a, b = turns_of(tips[0]), turns_of(tips[1])
        gap = np.einsum("nji,nj->ni", a, tips[1][:, 9:] - tips[0][:, 9:]) - np.array(self.pose.xyz)
        turned = np.einsum("nji,njk->nik", a, b).reshape(-1, 9) - np.array(self.pose.rotation)
        return np.hstack([gap, 0.1 / math.sqrt(2.0) * turned])

    def derivative(self, q: Floats, tips: Sequence[Floats], of_tips: Sequence[Floats]) -> Floats:
        back = turns_of(tips[0]).transpose(0, 2, 1)
        apart = cross_matrix(tips[1][:, 9:] - tips[0][:, 9:])
        gap = back @ (of_tips[1][:, :3] - of_tips[0][:, :3] + apart @ of_tips[0][:, 3:])
        turned = turned_derivative(back @ turns_of(tips[1]), back @ (of_tips[1][:, 3:] - of_tips[0][:, 3:]))
        return np.concatenate([gap, 0.1 / math.sqrt(2.0) * turned], axis=1)

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
        How far outside a joint may be [rad or m].
    joints : tuple of str
        All joints of the robot; taken from it.

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

    def residual(self, q: Floats, tips: Sequence[Floats]) -> Floats:
        return q - np.clip(q, *self.bounds)

    def derivative(self, q: Floats, tips: Sequence[Floats], of_tips: Sequence[Floats]) -> Floats:
        return np.where((self.residual(q, tips) != 0.0)[:, :, np.newaxis], np.eye(q.shape[1]), 0.0)

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return np.zeros(1)

    def words(self, off: float) -> str:
        return f"a joint is {off:.4g} outside of its range"
