"""Joints that follow others: whom in the end, and how far those may go for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from evenroad.errors import BrokenFile
from evenroad.robot.joint import Joint, Mimic

_ROUNDING = 1e-9
"""Limits that a follower would move by less than this stay as they are written [rad or m]."""


def with_direct_mimics(joints: Sequence[Joint], path: Path) -> list[Joint]:
    """Return the joints with every mimic following, directly, a joint that follows none.

    Raises
    ------
    BrokenFile
        If a mimic follows a fixed joint, or mimics follow each other in a circle.
    """
    by_name = {joint.name: joint for joint in joints}

    def direct(joint: Joint) -> Joint:
        multiplier, offset, followed, seen = 1.0, 0.0, joint, [joint.name]
        while followed.mimic is not None:
            name = followed.mimic.joint
            if by_name[name].kind == "fixed":
                raise BrokenFile(f"joint {followed.name!r} in {path} mimics {name!r}, which is fixed")
            if name in seen:
                raise BrokenFile(
                    f"joints of {path} mimic each other in a circle: {' -> '.join([*seen, name])}"
                )
            offset += multiplier * followed.mimic.offset
            multiplier *= followed.mimic.multiplier
            followed = by_name[name]
            seen.append(name)
        return replace(joint, mimic=Mimic(followed.name, multiplier, offset)) if joint.mimic else joint

    return [direct(joint) for joint in joints]


def within_limits_of_mimics(joints: Sequence[Joint]) -> list[Joint]:
    """Return the joints with the leaders' limits narrowed to where all of their mimics stay within their own.

    A continuous joint whose mimic has limits becomes a revolute one: it cannot turn on.  Limits of a mimic that would
    leave its leader no way to go are taken for a slip and not heeded: a gripper's mirrored finger often has
    those of the other finger, without the sign.

    Parameters
    ----------
    joints : sequence of Joint
        Mimics follow joints that follow none (see :func:`with_direct_mimics`).
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
    ends = [(limit - mimic.offset) / mimic.multiplier for limit in (follower.lower, follower.upper)]
    return min(ends), max(ends)
