"""Joint: how a link moves on its parent, within which limits; and joints that follow others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from evenroad.errors import BrokenFile, InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.space.joints import SLACK

Kind = Literal["revolute", "continuous", "prismatic", "fixed"]
LOOSE = ("x", "y", "z", "theta", "yaw", "pitch", "roll")
"""Coordinates of planar and floating joints, called ``base/x``: held, unless they are named."""
_ROUNDING = 1e-9
"""Movement of a follower up to which limits stay as they are written [rad or m]."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: ``value = multiplier * other + offset``."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, repr=False)
class Joint:
    """How a link, the `child`, moves on its `parent`, as URDF has it.

    `xyz` [m] and `rotation`, row by row, are the joint's frame in the parent link's; the child's is the joint's at 0.
    `axis` is a unit vector in the joint's frame, of no meaning where fixed.  Limits [rad or m] are -inf and inf for
    a continuous joint, the largest speed, `velocity` [rad/s or m/s], is inf where not given; `mimic` is the joint that
    this one follows.
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

    @cached_property
    def origin(self) -> Pose:
        """The joint's frame in the parent link's."""
        return Pose(self.xyz, self.rotation)

    @property
    def loose(self) -> bool:
        """Whether it is a coordinate of a planar or a floating joint: its name alone says so of other joints, too."""
        owner, _, name = self.name.rpartition("/")
        before, _, last = self.parent.rpartition("/")
        follows = before == owner and last in LOOSE
        return bool(owner) and name in LOOSE and (self.child == self.name or follows)

    @property
    def neutral(self) -> float:
        """0, or the nearest value within limits."""
        return float(min(max(0.0, self.lower), self.upper))

    def __repr__(self) -> str:
        return f"Joint({self.name!r}, {self.kind}, [{self.lower:.6g}, {self.upper:.6g}])"


def require_within(joint: Joint, value: float, what: str, limits: str = "") -> None:
    """Raise InvalidValue unless a joint can have a value [rad or m], up to 1e-5; `what` names the source of the value.

    `limits` are the limits in words, where they are not the joint's own.
    """
    if not math.isfinite(value):
        raise InvalidValue(f"{what} puts joint {joint.name!r} at {value!r}; it must be a finite number")
    if joint.lower - SLACK <= value <= joint.upper + SLACK:
        return
    unit = "m" if joint.kind == "prismatic" else "rad"
    beyond = max(joint.lower - value, value - joint.upper)
    limits = limits or f"its limits [{joint.lower:.6g}, {joint.upper:.6g}]"
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
        low, high = _range_for(follower, follower.mimic)
        lower = low if low > leader.lower + _ROUNDING else leader.lower
        upper = high if high < leader.upper - _ROUNDING else leader.upper
        if upper - lower <= _ROUNDING:
            continue
        if (lower, upper) != (leader.lower, leader.upper):
            kind = "revolute" if leader.kind == "continuous" else leader.kind
            narrowed[leader.name] = replace(leader, kind=kind, lower=lower, upper=upper)
    return [narrowed[joint.name] for joint in joints]


def _range_for(follower: Joint, mimic: Mimic) -> tuple[float, float]:
    """Return the values of the leader that keep a follower within its limits; lower above upper if none does."""
    if mimic.multiplier == 0.0:
        stays = follower.lower - _ROUNDING <= mimic.offset <= follower.upper + _ROUNDING
        return (-math.inf, math.inf) if stays else (math.inf, -math.inf)
    extremes = [(limit - mimic.offset) / mimic.multiplier for limit in (follower.lower, follower.upper)]
    return min(extremes), max(extremes)
