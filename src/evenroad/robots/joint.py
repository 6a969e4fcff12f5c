"""Joint: how a link moves on its parent, within which limits; and joints that follow others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from evenroad._call import explains_calls
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.space.joints import SLACK

Kind = Literal["revolute", "continuous", "prismatic", "fixed"]
_ROUNDING = 1e-9
"""Movement of a follower up to which limits stay as they are written [rad or m]."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: ``value = multiplier * other + offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@explains_calls
@dataclass(frozen=True, repr=False)
class Joint:
    """How a link, the `child`, moves on its `parent`, as URDF has it.

    `xyz` [m] and `rotation`, row by row, are the joint's frame in the parent link's frame.  At 0 the child's frame is
    the joint's.  `axis` is a unit vector in the joint's frame; a fixed joint ignores it.  Limits [rad or m] are -inf
    and inf for a continuous joint.  `velocity` [rad/s or m/s], `acceleration`, `deceleration` [rad/s^2 or m/s^2] and
    `jerk` are the largest ones, inf if not given.  `mimic` is the joint that this one follows.  `hard` are limits
    around `lower` and `upper`, if these are soft: paths are planned within the soft ones, but a robot may stand beyond
    them.  `of` is the planar or floating joint of which this one is a coordinate; such joints are held unless named.
    """

    name: str
    kind: Kind
    parent: str
    child: str
    xyz: tuple[float, float, float]
    rotation: tuple[float, ...]
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    lower: float = 0.0
    upper: float = 0.0
    velocity: float = float("inf")
    mimic: Mimic | None = None
    # These decide no check: robots that differ in them alone have one fingerprint.
    acceleration: float = field(default=math.inf, compare=False)
    deceleration: float = field(default=math.inf, compare=False)
    jerk: float = field(default=math.inf, compare=False)
    hard: tuple[float, float] | None = field(default=None, compare=False)
    of: str = field(default="", compare=False)

    @cached_property
    def origin(self) -> Pose:
        """The joint's frame in the parent link's."""
        return Pose(self.xyz, self.rotation)

    @property
    def stops(self) -> tuple[float, float]:
        """The limits beyond which the joint cannot stand: the hard ones, where it has soft ones within."""
        return (self.lower, self.upper) if self.hard is None else self.hard

    @property
    def neutral(self) -> float:
        """0, or the nearest value within limits."""
        return float(min(max(0.0, self.lower), self.upper))

    def __repr__(self) -> str:
        return f"Joint({self.name!r}, {self.kind}, [{self.lower:.6g}, {self.upper:.6g}])"


def require_within(joint: Joint, value: float, what: str, limits: str = "") -> None:
    """Raise InvalidValue unless a joint can stand at a value [rad or m], up to 1e-5; `what` names its source.

    `limits` are the limits in words, where they are not the joint's own.
    """
    if not math.isfinite(value):
        raise InvalidValue(f"{what} puts joint {joint.name!r} at {value!r}; it must be a finite number")
    lower, upper = joint.stops
    if lower - SLACK <= value <= upper + SLACK:
        return
    unit = "m" if joint.kind == "prismatic" else "rad"
    beyond = max(lower - value, value - upper)
    limits = limits or f"its limits [{lower:.6g}, {upper:.6g}]"
    raise InvalidValue(f"{what} puts joint {joint.name!r} at {value:.6g} {unit}, {beyond:.3g} {unit} outside {limits}")


def with_direct_mimics(joints: Sequence[Joint], where: str) -> list[Joint]:
    """Return the joints with every mimic following a joint that is no mimic itself.

    Raises BrokenFile if a mimic follows a fixed joint or one of several coordinates, or mimics follow each other in a
    circle.
    """
    by_name = {joint.name: joint for joint in joints}

    def direct(joint: Joint) -> Joint:
        multiplier, offset, followed, seen = 1.0, 0.0, joint, [joint.name]
        while followed.mimic is not None:
            name = followed.mimic.joint
            if name not in by_name:
                raise BrokenFile(f"joint {followed.name!r} in {where} mimics {name!r}, which has several coordinates")
            if by_name[name].kind == "fixed":
                raise BrokenFile(f"joint {followed.name!r} in {where} mimics {name!r}, which is fixed")
            if name in seen:
                circle = " -> ".join([*seen, name])
                raise BrokenFile(f"joints of {where} mimic each other in a circle: {circle}")
            offset += multiplier * followed.mimic.offset
            multiplier *= followed.mimic.multiplier
            followed = by_name[name]
            seen.append(name)
        return replace(joint, mimic=Mimic(followed.name, multiplier, offset)) if joint.mimic else joint

    return [direct(joint) for joint in joints]


def within_limits_of_mimics(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints with the leaders' limits narrowed to where all of their mimics stay within their own.

    A continuous joint whose mimic has limits becomes a revolute one.  Limits of a mimic that would leave its leader no
    range are taken for a mistake and ignored: a gripper's mirrored finger often has those of the other finger, without
    the sign.  Mimics follow joints that are no mimics (see :func:`with_direct_mimics`).
    """
    narrowed = {joint.name: joint for joint in joints}
    for follower in joints:
        if follower.mimic is None or follower.kind == "fixed":
            continue
        leader = narrowed[follower.mimic.joint]
        low, high = _range_for(follower, follower.mimic, (follower.lower, follower.upper))
        lower = low if low > leader.lower + _ROUNDING else leader.lower
        upper = high if high < leader.upper - _ROUNDING else leader.upper
        if upper - lower <= _ROUNDING:
            continue
        hard = None
        if leader.hard or follower.hard:
            low, high = _range_for(follower, follower.mimic, follower.stops)
            hard = max(low, leader.stops[0]), min(high, leader.stops[1])
        if (lower, upper, hard) != (leader.lower, leader.upper, leader.hard):
            turns = leader.kind == "continuous" and (lower, upper) != (leader.lower, leader.upper)
            kind = "revolute" if turns else leader.kind
            narrowed[leader.name] = replace(leader, kind=kind, lower=lower, upper=upper, hard=hard)
    return [narrowed[joint.name] for joint in joints]


def _range_for(follower: Joint, mimic: Mimic, limits: tuple[float, float]) -> tuple[float, float]:
    """Return the values of the leader that keep a follower within limits; lower above upper if none does."""
    if mimic.multiplier == 0.0:
        stays = limits[0] - _ROUNDING <= mimic.offset <= limits[1] + _ROUNDING
        return (-math.inf, math.inf) if stays else (math.inf, -math.inf)
    extremes = [(limit - mimic.offset) / mimic.multiplier for limit in limits]
    return min(extremes), max(extremes)
