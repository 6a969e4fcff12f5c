"""The trajectory of what moves as a point, such as a disk, whose speed and acceleration are limited as a whole."""

from __future__ import annotations

import math

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.trajectory import RoundedPath, TimeLaw, bends_of, distances_to, rounded, states
from evenroad.errors import InvalidValue
from evenroad.trajectory.corners import TRIES, TimedStates, drivable, less_at, require_steps, with_rests
from evenroad.trajectory.speed_law import Segments, fastest_law
from evenroad.world import World

_ACROSS, _ALONG = 0.8, 0.6
"""Shares of the acceleration that are used across and along an arc; together they are the whole, as 3, 4 and 5."""
_SAME = 1e-9
"""Distance in every coordinate below which two waypoints are one."""


def point_states(
    world: World | None, path: Floats, most: tuple[float, float], *, deviation: float, step: float
) -> TimedStates:
    """Return the fastest motion along a path, (p, dim), within the speed and the acceleration of `most`.

    Corners become arcs, smaller ones where these are not free, and stops at last, as in
    :func:`evenroad.trajectory.make_trajectory`.  Within an arc the acceleration is at most the whole, but less than
    it where the speed is below its limit there.
    """
    waypoints = path[bends_of(path, _SAME)]
    if len(waypoints) < 2:
        raise InvalidValue("path must lead somewhere: it needs two different waypoints or more")
    return _states(world, waypoints, np.full(len(waypoints), deviation), most, step)


def _states(
    world: World | None, waypoints: Floats, cuts: Floats, most: tuple[float, float], step: float
) -> TimedStates:
    """Return the states with corners that are at most that much cut, (p,)."""
    for tried in range(TRIES):
        curve = rounded(waypoints, cuts)
        law = _law(curve, most, step)
        times = step * np.arange(round(law.times[-1] / step) + 1, dtype=np.float64)
        moved = states(curve, law, np.minimum(times, law.times[-1]))
        free, proof = drivable(world, moved.positions)
        if free.all():
            shares = {
                "velocity": float(law.speeds.max()) / most[0],
                "acceleration": float(np.linalg.norm(moved.accelerations, axis=1).max()) / most[1],
            }
            off = float(distances_to(waypoints, moved.positions).max())
            return TimedStates(
                times, moved.positions, moved.velocities, moved.accelerations, off, len(curve.stops), shares, proof
            )
        if len(curve.corners) == 0:
            break
        lengths = np.interp(times, law.times, law.lengths)
        cuts = less_at(cuts, curve.corners, lengths[:-1][~free], lengths[1:][~free], tried)
    refusal = f"the trajectory is not proved free at {times[np.argmin(free)]:.3f} s"
    return with_rests(lambda part, own: _states(world, part, own, most, step), world, waypoints, cuts, refusal)


def _law(curve: RoundedPath, most: tuple[float, float], step: float) -> TimeLaw:
    """Return the fastest law along a path that takes a whole number of steps."""
    speed, acceleration = most
    is_arc = curve.bend > 0.0
    bend = np.where(is_arc, curve.bend, 1.0)
    count = len(bend)
    law = fastest_law(
        Segments(
            np.arange(count),
            np.zeros(count),
            np.diff(curve.starts),
            np.where(is_arc, np.minimum(speed, np.sqrt(_ACROSS * acceleration / bend)), speed),
            np.where(is_arc, _ALONG * acceleration, acceleration),
            np.where(np.isin(curve.starts[:-1], curve.stops), 0.0, math.nan),
        )
    )
    require_steps(int(min(law.times[-1] / step, 1e9)), law.times[-1], step)
    slower = math.ceil(law.times[-1] / step * (1.0 - _SAME)) * step / law.times[-1]
    lengths = np.append(curve.starts[law.piece] + law.begin, curve.length)
    return TimeLaw(slower * law.times, lengths, np.append(law.speed, 0.0) / slower, law.push / slower**2)
