"""PoseGoal: the pose of a link as a goal; and reading poses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import as_row, require_positive
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

_UNIT = 1e-3
"""Largest difference of the norm of a written quaternion from 1."""


@explains_calls
@dataclass(frozen=True)
class PoseGoal:
    """A pose of a link as a goal.

    Parameters
    ----------
    pose : Pose
        Pose of the link `tip`, in the frame of the link `frame`.
    tip : str
        The link; default: the only last link that the group moves.
    frame : str
        A link that the group does not move; default: the root.
    free_axis : sequence of 3 floats, or "x", "y", "z"
        An axis in the frame of the tip about which it may turn freely.  Default: none.
    position_only : bool
        Whether any rotation is allowed.
    position_tolerance, angle_tolerance : float
        Largest deviations of the origin and the rotation, >= 0 [m, rad].
    others : tuple of PoseGoal
        Goals of other links at the same time: ``goal & other`` has them.

    Raises
    ------
    InvalidValue
        If a number is invalid, or an axis has no direction.

    Examples
    --------
    >>> import evenroad as er
    >>> print(er.PoseGoal(er.Pose((0.4, 0.2, 0.3)), "tool0", free_axis="z"))
    tool0 at (0.4, 0.2, 0.3)
    """

    pose: Pose
    tip: str = ""
    frame: str = ""
    free_axis: Vector | None = None
    position_only: bool = False
    position_tolerance: float = 0.0
    angle_tolerance: float = 0.0
    others: tuple[PoseGoal, ...] = ()

    def __and__(self, other: PoseGoal) -> PoseGoal:
        """Return the goal that both links reach together, as two hands do."""
        if not isinstance(other, PoseGoal):
            raise InvalidValue(f"a pose goal goes with another one, got {shown(other)}")
        return replace(self, others=(*self.others, replace(other, others=()), *other.others))

    def __post_init__(self) -> None:
        if not isinstance(self.pose, Pose):
            raise InvalidValue(f"a pose goal must have a Pose, got {shown(self.pose)}")
        if self.free_axis is not None:
            if self.position_only:
                raise InvalidValue("position_only frees all axes: free_axis goes without it")
            set_fields(self, free_axis=as_axis("free_axis", self.free_axis))
        for name in ("position_tolerance", "angle_tolerance"):
            set_fields(self, **{name: require_positive(name, getattr(self, name), or_zero=True)})

    @property
    def is_exact(self) -> bool:
        """Whether position and rotation are given in full."""
        loose = self.position_only or self.position_tolerance or self.angle_tolerance
        return self.free_axis is None and not loose and not self.others

    def __str__(self) -> str:
        own = f"{self.tip or 'the tip'} at ({', '.join(f'{value:g}' for value in self.pose.xyz)})"
        return " and ".join([own, *map(str, self.others)])


def as_axis(name: str, axis: str | Sequence[float]) -> Vector:
    """Return a direction of length 1 from three numbers, or from x, -x, y, -y, z, -z."""
    if isinstance(axis, str):
        sign, letter = (-1.0, axis[1:]) if axis.startswith("-") else (1.0, axis)
        if letter in AXES:
            x, y, z = AXES[letter]
            return sign * x + 0.0, sign * y + 0.0, sign * z + 0.0
        try:
            axis = as_numbers(name, axis, (3,))
        except InvalidValue:
            raise InvalidValue(f"{name} must be x, -x, y, -y, z, -z or 3 finite numbers, got {shown(axis)}") from None
    row = as_row(name, axis, 3)
    length = math.hypot(*row)
    if length == 0.0:
        raise InvalidValue(f"{name} must be a direction, got zeros")
    x, y, z = (value / length for value in row)
    return x, y, z


def as_numbers(name: str, text: str, counts: Sequence[int]) -> tuple[float, ...]:
    """Return the finite numbers of a text, blanks or commas between them, as many as one of `counts`."""
    words = text.replace(",", " ").split()
    try:
        row = tuple(map(float, words))
    except ValueError:
        row = ()
    if len(words) not in counts or not row or not all(map(math.isfinite, row)):
        wanted = " or ".join(map(str, counts))
        raise InvalidValue(f"{name} must be {wanted} finite numbers, got {shown(text)}")
    return row


def pose_of(text: str, *, degrees: bool = False) -> tuple[Pose, bool]:
    """Return the pose of a text or numbers, and whether it has a rotation.

    ``x y z``, ``x y z roll pitch yaw`` (`degrees` or radians) or ``x y z qx qy qz qw`` [m], as ROS has them.  Raises
    InvalidValue for another number of finite numbers, or if the quaternion is not of norm 1 up to 0.001.
    """
    row = as_numbers("a goal pose", text, (3, 6, 7))
    xyz, rest = row[:3], row[3:]
    if len(rest) == 3:
        return Pose.from_rpy(xyz, np.radians(rest).tolist() if degrees else rest), True
    if len(rest) == 4:
        norm = math.hypot(*rest)
        if abs(norm - 1.0) > _UNIT:
            raise InvalidValue(
                f"the quaternion qx qy qz qw of a goal pose must be of norm 1, got {norm:.6g} in {shown(text)}: it is"
                " no rotation"
            )
        return Pose.from_quaternion(xyz, xyzw=rest), True
    return Pose((row[0], row[1], row[2])), False


def pose_goal_of(text: str, tip: str = "", frame: str = "", *, degrees: bool = False) -> PoseGoal:
    """Return the goal of a text, ``LINK: `` and a pose as :func:`pose_of` takes it, or without a link, of `tip`."""
    link, colon, numbers = text.rpartition(":")
    pose, turned = pose_of(numbers, degrees=degrees)
    return PoseGoal(pose, link.strip() if colon else tip, frame, position_only=not turned)


def as_pose_goal(goal: Pose | PoseGoal, tip: str = "", frame: str = "") -> PoseGoal:
    """Return a goal of a pose, with this tip and frame by default."""
    if isinstance(goal, Pose):
        return PoseGoal(goal, tip, frame)
    tip, frame = goal.tip or tip, goal.frame or frame
    # A goal is checked whenever it is made, which takes as long as a short plan.
    return goal if (tip, frame) == (goal.tip, goal.frame) else replace(goal, tip=tip, frame=frame)
