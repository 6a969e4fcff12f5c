"""The trajectory of a plan in any world."""

from __future__ import annotations

import os
from inspect import signature
from typing import Any

from evenroad._arrays import Floats
from evenroad._checks import require_known, require_positive
from evenroad.errors import InvalidValue, shown
from evenroad.robot import ArmWorld
from evenroad.trajectory.arm import arm_trajectory
from evenroad.trajectory.limits import SECONDS_TO_FULL_SPEED, Limits, limits_of
from evenroad.trajectory.trajectory import Trajectory, make_trajectory
from evenroad.world import World


def trajectory_of(
    world: World,
    path: Floats,
    limits: Limits | str | os.PathLike[str] | None,
    *,
    speed: float,
    **options: Any,
) -> Trajectory:
    """See :meth:`PlanResult.trajectory`."""
    known = {*signature(arm_trajectory).parameters} - {"world", "path"}
    for key in options:
        require_known("keyword of trajectory:", key, known)
    if isinstance(world, ArmWorld):
        if isinstance(limits, str | os.PathLike):
            limits = limits_of(world.robot, limits)
        return arm_trajectory(world, path, limits, speed=speed, **options)
    if limits is None:
        fastest = require_positive("speed", speed)
        each = (fastest,) * path.shape[1]
        at_speed = Limits(each, tuple(v / SECONDS_TO_FULL_SPEED for v in each), along_path=fastest)
    elif isinstance(limits, Limits):
        at_speed = limits.at_speed(speed)
    else:
        raise InvalidValue(
            f"limits must be Limits(velocity=..., acceleration=...) where there is no robot, got {shown(limits)}"
        )
    return make_trajectory(path, at_speed, world=world, **options)
