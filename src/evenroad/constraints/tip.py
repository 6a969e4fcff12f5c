"""Constraints of one tip: an axis upright, a rotation, a plane, a line, a box."""

# What methods of the constraints return stands in `Keep`.
# ruff: noqa: D102
from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import as_row, require_positive
from evenroad.constraints.keep import WITHIN, Keep, tip_pose, tip_row
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose, Vector
from evenroad.poses.cartesian_path import Moves
from evenroad.poses.pose_goal import AXES, as_axis
from evenroad.robots.robot import Robot

if TYPE_CHECKING:
    from evenroad._native.robot import KeepKind

UP = (0.0, 0.0, 1.0)


def _chord(angle: float) -> float:
    """Return the length of the chord between two directions at an angle."""
    return 2.0 * math.sin(0.5 * angle)


@dataclass(frozen=True)
class KeepUpright(Keep):
    """An axis of a link stays upright, for instance to carry a glass.

    Parameters
    ----------
    within : float
        Largest tilt, > 0, up to pi [rad].
    axis : sequence of 3 floats, "x", "-x", ..., or None
        The axis in the frame of the tip; None: the coordinate axis, of six, that is most upright at the start.
    tip : str
        The link of the tip; default: that of the goal poses, or the last one.

    Raises
    ------
    InvalidValue
        If a number is out of range, or the axis is none.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepUpright(0.1, "-z").axis
    (0.0, 0.0, -1.0)
    """

    within: float
    axis: Vector | str | None = None
    tip: str = ""
    unit: ClassVar[str] = "rad"
    deviation: ClassVar[str] = "tilt_rad"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("the tolerance of upright", self.within, at_most=math.pi))
        if self.axis is not None:
            set_fields(self, axis=as_axis("the axis of upright", self.axis))

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        tip, axis = self.tip or tip, self.axis
        if axis is None:
            every = [as_axis("axis", sign + name) for name in AXES for sign in ("", "-")]
            up = np.array(tip_row(robot, tip, q)[6:9])
            axis = max(every, key=lambda each: float(up @ np.array(each)))
        return replace(self, axis=axis, tip=tip)

    @property
    def limit(self) -> float:
        return _chord(self.within)

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        rows = np.zeros((3, 13))
        for k in range(3):
            rows[k, 3 * k : 3 * k + 3] = self.axis
        rows[:, 12] = UP
        return "linear", rows.ravel()

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return moves[0].swing

    def off(self, lengths: Floats) -> Floats:
        return 2.0 * np.arcsin(np.minimum(0.5 * lengths, 1.0))

    def words(self, off: float) -> str:
        every = (sign + name for name in AXES for sign in ("", "-"))
        numbers = f"({', '.join(f'{each:.3g}' for each in self.axis or ())})"
        axis = next((name for name in every if as_axis("axis", name) == self.axis), numbers)
        return f"axis {axis} of {self.tip!r} is tilted by {off:.4g} rad, more than {self.within:.4g}"


@dataclass(frozen=True)
class KeepOrientation(Keep):
    """A link keeps its rotation.

    Parameters
    ----------
    within : float
        Largest angle, > 0, up to pi [rad].
    rotation : sequence of 9 floats, optional
        The rows of its rotation in the frame of the root; default: that at the start.
    tip : str
        The link; default: that of the goal poses, or the last one.

    Raises
    ------
    InvalidValue
        If a number is out of range, or it is no rotation.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepOrientation(0.01).within
    0.01
    """

    within: float = 1e-3
    rotation: tuple[float, ...] | None = None
    tip: str = ""
    unit: ClassVar[str] = "rad"
    deviation: ClassVar[str] = "turn_rad"
    kept: ClassVar[str] = "its orientation"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("the tolerance of an orientation", self.within, at_most=math.pi))
        if self.rotation is not None:
            set_fields(self, rotation=Pose(rotation=self.rotation).rotation)

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        tip = self.tip or tip
        return replace(self, rotation=self.rotation or tip_row(robot, tip, q)[:9], tip=tip)

    @property
    def limit(self) -> float:
        return math.sqrt(2.0) * _chord(self.within)

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        rows = np.eye(9, 13)
        rows[:, 12] = self.rotation
        return "linear", rows.ravel()

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return math.sqrt(2.0) * moves[0].swing

    def off(self, lengths: Floats) -> Floats:
        return 2.0 * np.arcsin(np.minimum(lengths / math.sqrt(8.0), 1.0))


@dataclass(frozen=True)
class KeepInPlane(Keep):
    """The origin of a link stays in a plane.

    Parameters
    ----------
    normal : sequence of 3 floats, or "x", "y", "z"
        Normal of the plane in the frame of the root.
    through : sequence of 3 floats, optional
        A point of it [m]; default: the link's origin at the start.
    within : float
        Largest distance, > 0 [m].
    tip : str
        The link; default: that of the goal poses, or the last one.

    Raises
    ------
    InvalidValue
        If a number is out of range, or the normal has no direction.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepInPlane("z", through=(0, 0, 0.5)).normal
    (0.0, 0.0, 1.0)
    """

    normal: Vector | str
    through: Vector | None = None
    within: float = WITHIN
    tip: str = ""
    deviation: ClassVar[str] = "plane_m"
    kept: ClassVar[str] = "its plane"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("within", self.within), normal=as_axis("normal", self.normal))
        if self.through is not None:
            set_fields(self, through=as_row("through", self.through, 3))

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        tip = self.tip or tip
        return replace(self, through=self.through or tip_pose(robot, tip, q).xyz, tip=tip)

    @property
    def across(self) -> Floats:
        """Directions in which it must not move, (m, 3)."""
        return np.array(self.normal, dtype=np.float64)[np.newaxis]

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        across = self.across
        rows = np.zeros((len(across), 13))
        rows[:, 9:12], rows[:, 12] = across, across @ np.array(self.through)
        return "linear", rows.ravel()

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return moves[0].push


@dataclass(frozen=True)
class KeepOnLine(KeepInPlane):
    """The origin of a link stays on a line.

    Parameters
    ----------
    normal : sequence of 3 floats, or "x", "y", "z"
        Direction of the line in the frame of the root.
    through, within, tip
        As for :class:`KeepInPlane`.

    Raises
    ------
    InvalidValue
        As there.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepOnLine("x").within
    0.0001
    """

    deviation: ClassVar[str] = "off_line_m"
    kept: ClassVar[str] = "its line"

    @property
    def across(self) -> Floats:
        along = np.array(self.normal, dtype=np.float64)
        return np.eye(3) - np.outer(along, along)


@dataclass(frozen=True)
class KeepInBox(Keep):
    """The origin of a link stays in a box.

    Parameters
    ----------
    low, high : sequences of 3 floats
        Corners of the box in the frame of the root [m].
    within : float
        Largest distance from it, > 0 [m].
    tip : str
        The link; default: that of the goal poses, or the last one.

    Raises
    ------
    InvalidValue
        If low is not <= high, or a number is out of range.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.KeepInBox((0, -0.5, 0.2), (0.6, 0.5, 0.8)).high
    (0.6, 0.5, 0.8)
    """

    low: Vector
    high: Vector
    within: float = WITHIN
    tip: str = ""
    deviation: ClassVar[str] = "box_m"
    kept: ClassVar[str] = "its box"

    def __post_init__(self) -> None:
        set_fields(self, within=require_positive("within", self.within))
        set_fields(self, low=as_row("low", self.low, 3), high=as_row("high", self.high, 3))
        if not all(a <= b for a, b in zip(self.low, self.high, strict=True)):
            raise InvalidValue(f"a box must have low <= high, got {shown(self.low)} and {shown(self.high)}")

    def bound(self, robot: Robot, q: Floats, tip: str) -> Keep:
        return replace(self, tip=self.tip or tip)

    @property
    def residual(self) -> tuple[KeepKind, Floats]:
        return "box", np.array([*self.low, *self.high])

    def bend(self, moves: Sequence[Moves]) -> Floats:
        return moves[0].push
