"""The trajectory of a plan, in whatever world it was made."""

from __future__ import annotations

import os
from typing import Any

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.robot import ArmWorld
from evenroad.trajectory.arm import arm_trajectory
from evenroad.trajectory.limits import Limits, limits_of
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
    """Return what :meth:`PlanResult.trajectory` does."""
    if isinstance(world, ArmWorld):
        if isinstance(limits, str | os.PathLike):
            limits = limits_of(world.robot, limits)
        return arm_trajectory(world, path, limits, speed=speed, **options)
    if not isinstance(limits, Limits):
        raise InvalidValue(
            "limits must be given where there is no robot that has them: Limits(velocity=..., acceleration=...)"
        )
    return make_trajectory(path, limits.at_speed(speed), world=world, **options)
