"""Constraints that a certificate claims: an axis of a link near a direction, a point of a link in a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.constraints.keep import Keep
from evenroad.constraints.tip import UP, KeepInBox, KeepInPlane, KeepOnLine, KeepUpright
from evenroad.errors import NotAvailable
from evenroad.geometry.pose import Pose
from evenroad.geometry.rotation import rotation_from_z
from evenroad.robots.robot import Robot

_FAR = 1e6
"""Where the box of a line or a plane ends [m]."""


@dataclass(frozen=True)
class Axis:
    """An `axis` of a link that stays within an angle of a `direction` of the root; both have length 1."""

    link: str
    within: float
    axis: Floats
    direction: Floats

    @property
    def line(self) -> str:
        """Its line in a header."""
        return f"axis {_text([self.within, *self.axis, *self.direction])} {self.link}"

    def row(self, at: Pose) -> tuple[int, float, Floats]:
        """Return its kind, limit and numbers for the kernel, of a link that has a pose in its frame."""
        limit = 2.0 * np.sin(0.5 * min(self.within, np.pi))
        return 0, float(limit), np.concatenate([at.rotation_matrix @ self.axis, self.direction, np.zeros(15)])


@dataclass(frozen=True)
class Point:
    """A `point` of a link that stays within a distance of a box, from `low` to `high` along the axes of `turn`."""

    link: str
    within: float
    point: Floats
    turn: Pose
    low: Floats
    high: Floats

    @property
    def line(self) -> str:
        """Its line in a header."""
        return f"point {_text([self.within, *self.point, *self.turn.xyzw, *self.low, *self.high])} {self.link}"

    def row(self, at: Pose) -> tuple[int, float, Floats]:
        """Return its kind, limit and numbers for the kernel, of a link that has a pose in its frame."""
        rows = self.turn.rotation_matrix.T.ravel()
        return 1, self.within, np.concatenate([at.apply(self.point), np.zeros(3), rows, self.low, self.high])


def claimed_keeps(keeps: Sequence[Keep], robot: Robot) -> tuple[Axis | Point, ...]:
    """Return what a certificate claims of bound constraints; NotAvailable for those that no certificate speaks of."""
    return tuple(_claimed(keep, robot) for keep in keeps)


def _claimed(keep: Keep, robot: Robot) -> Axis | Point:
    if isinstance(keep, KeepUpright):
        link, at = _carrier(robot, keep.tip)
        return Axis(link, keep.within, at.rotation_matrix @ np.array(keep.axis, dtype=float), np.array(UP))
    if isinstance(keep, KeepInBox):
        link, at = _carrier(robot, keep.tip)
        return Point(link, keep.within, np.array(at.xyz), Pose(), np.array(keep.low), np.array(keep.high))
    if isinstance(keep, KeepInPlane):
        link, at = _carrier(robot, keep.tip)
        turn = Pose(rotation=rotation_from_z(np.array(keep.normal, dtype=float).tolist()))
        middle = turn.inverse().apply(np.array(keep.through, dtype=float))
        free = np.array([0.0, 0.0, _FAR] if isinstance(keep, KeepOnLine) else [_FAR, _FAR, 0.0])
        return Point(link, keep.within, np.array(at.xyz), turn, middle - free, middle + free)
    raise NotAvailable(f"no certificate speaks of the constraint {type(keep).__name__}")


def _carrier(robot: Robot, tip: str) -> tuple[str, Pose]:
    """Return a link of the robot's file, and the pose of a tip there, which may be what it holds."""
    joint = next((joint for joint in robot.joints if joint.child == tip and tip in robot.holds), None)
    return (tip, Pose()) if joint is None else (joint.parent, joint.origin)


def rows_of(keeps: Sequence[Axis | Point], placement: Mapping[str, tuple[int, Pose]]) -> tuple[Ints, Floats, Floats]:
    """Return frame and kind, (n, 2), limit, (n,), and numbers, (n, 21), of each constraint, for the kernel."""
    rows = [(placement[keep.link][0], *keep.row(placement[keep.link][1])) for keep in keeps]
    frames = np.array([(frame, kind) for frame, kind, _, _ in rows], dtype=np.int64).reshape(-1, 2)
    limits, numbers = np.array([row[2] for row in rows], dtype=float), [row[3] for row in rows]
    return frames, limits, np.array(numbers, dtype=float).reshape(-1, 21)


def _text(numbers: Sequence[float]) -> str:
    return " ".join(repr(float(number)) for number in numbers)
