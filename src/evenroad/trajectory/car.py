"""The trajectory of a car along its path: proved free, with blends where the steering is limited, and its times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad.driving.car_space import CarSpace
from evenroad.driving.car_world import CarWorld
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory.blends import Blended, clothoids_free, nearer, with_blends
from evenroad.trajectory.car_states import CarTrajectory, jumps_of
from evenroad.trajectory.clothoid import starts_of
from evenroad.trajectory.corners import require_steps
from evenroad.trajectory.drive_limits import DriveLimits
from evenroad.trajectory.make import DEVIATION, STEP


def car_trajectory(
    world: CarWorld,
    start: Floats,
    pieces: Floats,
    limits: DriveLimits,
    *,
    deviation: float = DEVIATION,
    step: float = STEP,
) -> CarTrajectory:
    """Return the fastest trajectory of a car along pieces, proved free as it is driven.

    Where the steering is limited, a turn between straight drives becomes two clothoids, or each jump of the curvature
    between a straight drive and a turn does.  If they are not proved free they become shorter, and at last the car
    stops to steer, as it does at every jump between two turns.  At the start its wheels are turned already.

    Parameters
    ----------
    world : CarWorld
        Of a robot that is not holonomic.
    start : ndarray, shape (3,)
    pieces : ndarray, shape (k, 2)
        Curvatures and signed lengths, as :attr:`PlanResult.pieces`.
    limits : DriveLimits
    deviation : float
        Largest distance from the path, >= 0; with 0 a car whose steering is limited stops wherever the curvature jumps.
    step : float
        Largest time between two states, > 0 [s].

    Returns
    -------
    CarTrajectory

    Raises
    ------
    InvalidValue
        If the path leads nowhere, an argument is out of range, or there would be a million states.
    NotAvailable
        If the pieces are not free in the world.
    """
    deviation, step = require_positive("deviation", deviation, or_zero=True), require_positive("step", step)
    if len(pieces) == 0:
        raise InvalidValue("path must lead somewhere: its start is its goal")
    if not are_free(world, start, pieces):
        raise NotAvailable("the path is not proved free as its pieces are driven")
    limits = _on_the_spot(limits, world) if np.isinf(pieces[:, 0]).any() else limits
    made = Blended(np.column_stack([pieces[:, 0], pieces]), 0, 0.0)
    if limits.curvature_rate is not None:
        made = with_blends(world, start, made.pieces, limits, deviation)
    jump, stops = jumps_of(made.pieces)
    trajectory = CarTrajectory(
        start=np.array(start, dtype=np.float64),
        pieces=made.pieces,
        limits=limits,
        step=step,
        deviation=made.deviation,
        blends=made.blends,
        stops=0 if limits.curvature_rate is None else int(np.count_nonzero((jump > 0.0) & ~stops)),
        proof="certified" if made.blends else world.proof,
    )
    require_steps(int(min(trajectory.duration / step, 1e9)), trajectory.duration, step)
    return trajectory


def are_free(world: CarWorld, start: Floats, pieces: Floats, driven: CarTrajectory | None = None) -> bool:
    """Return whether a car is proved free along pieces, (k, 2), from a pose, and along the blends of a trajectory."""
    assert isinstance(world.space, CarSpace), "a holonomic robot has no pieces"
    # On the spot, an angle counts a length in the space.
    lengths = pieces[:, 1] * np.where(np.isinf(pieces[:, 0]), world.space.spot, 1.0)
    rows = np.column_stack([np.sign(pieces[:, 0]), lengths])
    if not world.vehicle.pieces_free(world.space.steering, start, rows):
        return False
    if driven is None or not driven.blends:
        return True
    near, starts = nearer(world), starts_of(driven.start, driven.pieces)
    blends = np.flatnonzero(driven.pieces[:, 0] != driven.pieces[:, 1])
    return all(clothoids_free(near, starts[i], driven.pieces[i : i + 1]) for i in blends)


def _on_the_spot(limits: DriveLimits, world: CarWorld) -> DriveLimits:
    """Return limits with those of turns on the spot: by default the farthest corner keeps those of driving."""
    if limits.curvature_rate is not None:
        raise InvalidValue("curvature_rate is of a car that steers, and this robot turns on the spot")
    reach = world.footprint.reach
    return replace(
        limits,
        angular_speed=limits.angular_speed or limits.speed / reach,
        angular_acceleration=limits.angular_acceleration or limits.push / reach,
    )
