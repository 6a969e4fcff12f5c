"""The trajectory of a plan: of an arm, of a car, and of what moves as a point, by the world that it was planned in."""

from __future__ import annotations

import os
from functools import reduce
from inspect import signature
from itertools import pairwise
from operator import and_
from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_known, require_positive
from evenroad._shared import once
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.constraints.differential_drive import DifferentialDrive, DrivenWorld
from evenroad.driving.car_space import CarSpace
from evenroad.driving.car_world import CarWorld
from evenroad.errors import InvalidValue, shown
from evenroad.flight.flight_space import FlightSpace
from evenroad.flight.flight_trajectory import FlightTrajectory, flight_trajectory
from evenroad.trajectory.arm import arm_trajectory
from evenroad.trajectory.car import car_trajectory
from evenroad.trajectory.car_states import CarTrajectory
from evenroad.trajectory.drive_limits import DriveLimits
from evenroad.trajectory.in_motion import InMotion
from evenroad.trajectory.limits import SECONDS_TO_FULL_SPEED, Limits, limits_of
from evenroad.trajectory.make import DEVIATION, STEP, make_trajectory
from evenroad.trajectory.point import point_states
from evenroad.trajectory.trajectory import ON_MAPS, Trajectory
from evenroad.world import World
from evenroad.world.gridmap import DiskWorld

_VELOCITIES = ("start_velocity", "goal_velocity")
"""Keywords of a plan's trajectory that begins or ends in motion."""


@once
def _known_options() -> set[str]:
    return {*signature(arm_trajectory).parameters} - {"world", "path"} | {*_VELOCITIES, "acceleration"}


def trajectory_of(
    world: World,
    path: Floats,
    limits: Limits | DriveLimits | str | os.PathLike[str] | None,
    *,
    speed: float,
    pieces: Floats | None = None,
    **options: Any,
) -> Trajectory | CarTrajectory | FlightTrajectory:
    """See :meth:`PlanResult.trajectory`; a car drives the `pieces`, or else the shortest curves between waypoints."""
    if isinstance(world, CarWorld) and isinstance(world.space, CarSpace):
        return _of_car(world, world.space, path, pieces, limits, speed=speed, **options)
    if isinstance(world.space, FlightSpace):
        return _of_flight(world, world.space, path, limits, speed=speed, **options)
    for key in options:
        require_known("keyword of trajectory:", key, _known_options())
    moving = InMotion(path, *(options.pop(name, None) for name in _VELOCITIES))
    if isinstance(world, DrivenWorld):
        if moving.start is not None or moving.goal is not None:
            raise InvalidValue("a base that cannot go sideways starts and stops at rest")
        options = {"deviation": 0.0, "constraints": DifferentialDrive()} | options
        world = world.world
    if isinstance(world, KeptWorld):
        # A plan without lines is in a constrained world. Its arm has names and limits, and keeps the constraints.
        options.setdefault("constraints", reduce(and_, world.keeps))
        world = world.world
    if isinstance(world, ArmWorld):
        if "acceleration" in options:
            raise InvalidValue("acceleration is of robots on maps; those of joints are in limits=Limits(...)")
        if isinstance(limits, str | os.PathLike):
            limits = limits_of(world.robot, limits)
        elif isinstance(limits, DriveLimits):
            raise InvalidValue(f"limits of an arm must be Limits, got {shown(limits)}")
        return arm_trajectory(world, moving, limits, speed=speed, **options)
    if isinstance(world, DiskWorld | CarWorld):
        options["names"] = ON_MAPS[: path.shape[1]]
    if limits is None and "acceleration" in options:
        return _of_point(world, moving, require_positive("speed", speed), **options)
    if limits is None:
        fastest = require_positive("speed", speed)
        each = (fastest,) * path.shape[1]
        at_speed = Limits(each, tuple(v / SECONDS_TO_FULL_SPEED for v in each), along_path=fastest)
    elif isinstance(limits, Limits) and "acceleration" not in options:
        at_speed = limits.at_speed(speed)
    else:
        raise InvalidValue(
            "limits must be Limits(velocity=..., acceleration=...) where there is no robot, without acceleration=,"
            f" got {shown(limits)}"
        )
    return make_trajectory(moving, at_speed, world=world, **options)


def _of_point(
    world: World,
    moving: InMotion,
    speed: float,
    *,
    acceleration: float,
    deviation: float = DEVIATION,
    step: float = STEP,
    names: tuple[str, ...] | None = None,
) -> Trajectory:
    """Return the trajectory of what moves as a point, with limits of speed and acceleration as a whole."""
    if moving.start is not None or moving.goal is not None:
        raise InvalidValue("a robot with acceleration= starts and stops at rest; give limits=Limits(...) instead")
    most = speed, require_positive("acceleration", acceleration)
    deviation, step = require_positive("deviation", deviation, or_zero=True), require_positive("step", step)
    waypoints = np.ascontiguousarray(moving.path, dtype=np.float64)
    states = point_states(world, waypoints, most, deviation=deviation, step=step)
    dim = waypoints.shape[1]
    return Trajectory(
        names=names or tuple(f"joint_{i + 1}" for i in range(dim)),
        limits=Limits((most[0],) * dim, (most[1],) * dim, along_path=speed),
        waypoints=waypoints,
        **states._asdict(),
    )


def _of_flight(
    world: World,
    space: FlightSpace,
    path: Floats,
    limits: Limits | DriveLimits | str | os.PathLike[str] | None,
    *,
    speed: float,
    **options: Any,
) -> FlightTrajectory:
    """Return the flight along a path, whose states have velocities already."""
    for key in options:
        require_known("keyword of a flight's trajectory:", key, {"step"})
    if limits is not None or speed != 1.0:
        raise InvalidValue("a flight has its speeds from the world: FlightWorld(scene, speed=..., acceleration=...)")
    return flight_trajectory(world, space.native.pieces_along(path), **options)


def _of_car(
    world: CarWorld,
    space: CarSpace,
    path: Floats,
    pieces: Floats | None,
    limits: Limits | DriveLimits | str | os.PathLike[str] | None,
    **options: Any,
) -> CarTrajectory:
    """Return the trajectory of a car, whose limits are keywords."""
    of_limits = {*DriveLimits.__dataclass_fields__}
    for key in options:
        require_known("keyword of a car's trajectory:", key, of_limits | {"deviation", "step"})
    given = {key: value for key, value in options.items() if key in of_limits}
    if limits is None:
        limits = DriveLimits(**given)
    elif not isinstance(limits, DriveLimits) or {**given, "speed": 1.0} != {"speed": 1.0}:
        raise InvalidValue(f"limits of a car must be DriveLimits, without other limits beside, got {shown(limits)}")
    if pieces is None:
        pieces = np.concatenate([space.pieces(a, b) for a, b in pairwise(path)])
    return car_trajectory(world, path[0], pieces, limits, **{k: v for k, v in options.items() if k not in of_limits})
