"""Trajectories from rest to rest within velocities and accelerations: each try is one compiled call."""

from __future__ import annotations

from typing import Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.trajectory import timed
from evenroad.errors import NotAvailable
from evenroad.trajectory.corners import MOST_STATES, TRIES, drivable, less_at, require_steps
from evenroad.trajectory.limits import Limits
from evenroad.world import World

_ANY_SPEED = 1e300
"""Square of a speed that nothing reaches."""


def driven_at_rest(world: World | None, waypoints: Floats, limits: Limits, cuts: Floats, step: float) -> dict[str, Any]:
    """Return states, proof and measures of the fastest trajectory, with corners within `cuts`, (p,), or less.

    Raises as :func:`evenroad.trajectory.make_trajectory`.
    """
    highest = _ANY_SPEED if limits.along_path is None else limits.along_path**2
    most = np.array(limits.velocity), np.array(limits.acceleration), highest
    for tried in range(TRIES):
        *states, lengths, corners, stops, duration, deviation, used = timed(waypoints, cuts, most, (step, MOST_STATES))
        positions, velocities, accelerations = states
        if len(positions) == 0:
            require_steps(MOST_STATES + 1, duration, step)
        free, proof = drivable(world, positions)
        if free.all():
            return {
                "times": step * np.arange(len(positions)),
                "positions": positions,
                "velocities": velocities,
                "accelerations": accelerations,
                "deviation": deviation,
                "stops": stops,
                "highest": {"velocity": used[0], "acceleration": used[1]},
                "proof": proof,
            }
        cuts = less_at(cuts, corners, lengths[:-1][~free], tried)
    raise NotAvailable(f"the trajectory is not proved free at {step * int(np.argmin(free)):.3f} s")
