"""Steps of a task, as values."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad.constraints.differential_drive import DifferentialDrive
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Pose
from evenroad.poses.cartesian_line import CartesianLine
from evenroad.poses.constraint import Constraint, part_of
from evenroad.poses.pose_goal import PoseGoal
from evenroad.task.gripper import OfFingers

DEPTH, REACH = 0.005, 0.1
"""Defaults of the depth of an object in its support, and of the distance at which a gripper attaches it [m]."""


@explains_calls
@dataclass(frozen=True)
class MoveTo:
    """A motion to a goal.

    Parameters
    ----------
    goal : configuration, Pose, PoseGoal, str, or a sequence of such
        A goal, or several, of :func:`evenroad.plan`.  Among several, the task chooses one that allows its later steps.
    approach, retreat : float
        Lengths of straight lines of the tip to the goal and from the start, >= 0 [m].
    away : sequence of 3 floats, "x", "-x", ..., or "up"
        Direction of the lines, see :class:`evenroad.CartesianLine`.
    constraints : Constraint, optional
        Other constraints, such as :class:`evenroad.constraints.KeepUpright`.

    Raises
    ------
    InvalidValue
        If a length is not such a number, or the constraints include a line.

    Examples
    --------
    >>> from evenroad.task import MoveTo
    >>> MoveTo("home", retreat=0.1).retreat
    0.1
    """

    goal: Any
    approach: float = 0.0
    retreat: float = 0.0
    away: Any = "-z"
    constraints: Constraint | None = None

    def __post_init__(self) -> None:
        for name in ("approach", "retreat"):
            set_fields(self, **{name: require_positive(name, getattr(self, name), or_zero=True)})
        if part_of(self.constraints, CartesianLine) is not None:
            raise InvalidValue("the lines of MoveTo are its approach and retreat, not constraints")
        if part_of(self.constraints, DifferentialDrive) is not None and (self.approach or self.retreat):
            raise InvalidValue("a base that cannot go sideways goes without approach and retreat")

    def line(self, tip: str) -> CartesianLine:
        """Return the straight lines of a tip, if there are any."""
        return CartesianLine(self.approach, self.retreat, self.away, tip)


@explains_calls
@dataclass(frozen=True)
class MoveLinear:
    """A motion along a straight line of the tip, with a constant rate of rotation.

    Parameters
    ----------
    pose : Pose or PoseGoal
        Last pose of the tip, complete: without a free axis or tolerances.
    speed : float, optional
        Largest speed of the tip, > 0 [m/s].  Default: what the joints allow.

    Raises
    ------
    InvalidValue
        If it is no such pose or number.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.task import MoveLinear
    >>> MoveLinear(er.Pose((0.5, 0, 0.4)), speed=0.1).speed
    0.1
    """

    pose: Pose | PoseGoal
    speed: float | None = None

    def __post_init__(self) -> None:
        _require_poses(self, (self.pose,))


@explains_calls
@dataclass(frozen=True)
class MoveAlong:
    """A motion of the tip along a polyline or a spline, from its current pose through others.

    Parameters
    ----------
    poses : sequence of Pose or PoseGoal
        One or more complete poses of one tip.
    blend : float
        Distance from each inner pose at which the tip may leave its line to round the corner, >= 0 [m].  It is never
        farther from the pose than that.  With 0 it stops at corners.
    spline : bool
        Whether the tip passes through the poses on a smooth curve, without a stop.
    speed : float, optional
        Largest speed of the tip, > 0 [m/s].  Default: what the joints allow.

    Raises
    ------
    InvalidValue
        If there is no pose, one is incomplete, a number is invalid, or a spline has a blend.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.task import MoveAlong
    >>> len(MoveAlong([er.Pose((0.5, y, 0.4)) for y in (0.1, 0.2)], blend=0.02).poses)
    2
    """

    poses: tuple[Pose | PoseGoal, ...]
    blend: float = 0.0
    spline: bool = False
    speed: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.poses, Sequence) or isinstance(self.poses, str) or not self.poses:
            raise InvalidValue(f"poses of MoveAlong must be one pose or more, got {shown(self.poses)}")
        set_fields(self, poses=tuple(self.poses), blend=require_positive("blend", self.blend, or_zero=True))
        _require_poses(self, self.poses)
        if self.spline and self.blend:
            raise InvalidValue("a spline passes through its poses: blend goes without it")


@explains_calls
@dataclass(frozen=True)
class MoveCircular:
    """A motion of the tip along a circular arc, from its current pose through another to a third.

    Parameters
    ----------
    via, to : Pose or PoseGoal
        Complete poses of one tip; the three positions must not be on a line.
    speed : float, optional
        Largest speed of the tip, > 0 [m/s].  Default: what the joints allow.

    Raises
    ------
    InvalidValue
        If it is no such pose or number.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.task import MoveCircular
    >>> MoveCircular(er.Pose((0.5, 0.1, 0.4)), er.Pose((0.6, 0, 0.4))).to.xyz
    (0.6, 0.0, 0.4)
    """

    via: Pose | PoseGoal
    to: Pose | PoseGoal
    speed: float | None = None

    def __post_init__(self) -> None:
        _require_poses(self, (self.via, self.to))


@explains_calls
@dataclass(frozen=True)
class Attach:
    """The gripper takes an obstacle, which then moves with a link.

    If the obstacle touches others, such as its support, it may touch them up to `depth` on the straight line at the
    beginning of the next motion.

    Parameters
    ----------
    object : str
        Name of the obstacle.
    link : str
        The link that carries it; default: the last one, or where fingers branch from a hand, the hand.
    touches : sequence of str, optional
        Links that may touch it on the lines to it, and while it is held.  Default: all links that no planned joint
        moves relative to `link`, such as fingers.
    depth : float
        Largest depth in bodies that it may touch, >= 0 [m].  The object, smaller by this on every side, must be free.
    reach : float
        Largest distance from the links that may touch it, >= 0 [m].

    Raises
    ------
    InvalidValue
        If a name is no text, or a length is not such a number.

    Examples
    --------
    >>> from evenroad.task import Attach
    >>> Attach("can").object
    'can'
    """

    object: str
    link: str = ""
    touches: tuple[str, ...] | None = None
    depth: float = DEPTH
    reach: float = REACH

    def __post_init__(self) -> None:
        _require_names(self, "object", "link")
        for name in ("depth", "reach"):
            set_fields(self, **{name: require_positive(name, getattr(self, name), or_zero=True)})
        if self.touches is not None:
            set_fields(self, touches=_names(self, "touches"))


@explains_calls
@dataclass(frozen=True)
class Detach:
    """The gripper releases an object, which becomes an obstacle at its current pose.

    Parameters
    ----------
    object : str
        Name of the held object.
    onto : sequence of str
        Obstacles that it may touch on the line to its pose, such as the table, up to the `depth` of its Attach.

    Raises
    ------
    InvalidValue
        If a name is no text.

    Examples
    --------
    >>> from evenroad.task import Detach
    >>> Detach("can", onto="table").onto
    ('table',)
    """

    object: str
    onto: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _require_names(self, "object")
        set_fields(self, onto=_names(self, "onto"))


@explains_calls
@dataclass(frozen=True)
class Wait:
    """The arm does not move for a time.

    Parameters
    ----------
    seconds : float
        >= 0 [s].

    Raises
    ------
    InvalidValue
        If it is no such number.

    Examples
    --------
    >>> from evenroad.task import Wait
    >>> Wait(0.5)
    Wait(seconds=0.5)
    """

    seconds: float

    def __post_init__(self) -> None:
        set_fields(self, seconds=require_positive("seconds", self.seconds, or_zero=True))


AlongCurve = MoveLinear | MoveAlong | MoveCircular
Move = MoveTo | AlongCurve | OfFingers
Step = Move | Attach | Detach | Wait


def _require_poses(step: AlongCurve, poses: Sequence[object]) -> None:
    """Refuse incomplete poses, poses of several tips, and an invalid speed."""
    kind = type(step).__name__
    for pose in poses:
        if not isinstance(pose, Pose | PoseGoal):
            raise InvalidValue(f"a pose of {kind} must be a Pose or PoseGoal, got {shown(pose)}")
        if isinstance(pose, PoseGoal) and not pose.is_exact:
            raise InvalidValue(f"a pose of {kind} must be whole, without a free axis or tolerances, got {shown(pose)}")
    if len({(pose.tip, pose.frame) if isinstance(pose, PoseGoal) else ("", "") for pose in poses}) > 1:
        raise InvalidValue(f"the poses of {kind} must be of one tip in one frame")
    if step.speed is not None:
        set_fields(step, speed=require_positive("speed", step.speed))


def _require_names(step: Attach | Detach, *names: str) -> None:
    for name in names:
        if not isinstance(getattr(step, name), str):
            text = f"{name} of {type(step).__name__} must be a name"
            raise InvalidValue(f"{text}, got {shown(getattr(step, name))}")


def _names(step: Attach | Detach, name: str) -> tuple[str, ...]:
    """Return the names in a field of a step."""
    given = getattr(step, name)
    listed = (given,) if isinstance(given, str) else given
    if not isinstance(listed, Collection) or not all(isinstance(each, str) for each in listed):
        raise InvalidValue(f"{name} of {type(step).__name__} must be names, got {shown(given)}")
    return tuple(listed)
