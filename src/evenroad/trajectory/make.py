"""The fastest trajectory along a path within limits, which is also checked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_batch, require_positive
from evenroad._native.trajectory import RoundedPath, bends_of, distances_to, largest_share, rounded
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory.corners import TRIES, TimedStates, drivable, less_at, require_steps, with_rests
from evenroad.trajectory.in_motion import FARTHER, InMotion
from evenroad.trajectory.limits import Limits
from evenroad.trajectory.timed import TooFast, timed_path
from evenroad.trajectory.timing import TimeLaw, fastest, paused, slowed
from evenroad.trajectory.trajectory import STEP as STEP
from evenroad.trajectory.trajectory import Trajectory
from evenroad.world import World

DEVIATION = 0.05
"""Default of the largest deviation at a corner [rad or m]."""

_FINER = 8
"""Number of states per step at which limits are checked."""

_SAME = 1e-9
"""Distance in every joint below which two waypoints are equal [rad or m]."""

_SHARES, _LESS = 8, 0.995
"""Number of times that the used share of a tip's acceleration and of torques is reduced, and an extra factor."""


class Driven(NamedTuple):
    """States of a robot at its steps, (n, dim) each, and distances from its path at fine times, (m,).

    `highest` are the largest shares of its limits.
    """

    positions: Floats
    velocities: Floats
    accelerations: Floats
    off: Floats
    highest: dict[str, float]


def make_trajectory(
    path: npt.ArrayLike | InMotion,
    limits: Limits,
    *,
    world: World | None = None,
    names: Sequence[str] | None = None,
    held: Mapping[str, float] | None = None,
    controller: Sequence[str] = (),
    deviation: float = DEVIATION,
    step: float = STEP,
) -> Trajectory:
    """Return the fastest trajectory along a path with rounded corners.

    Corners become circular arcs (Kunz and Stilman 2012), with the fastest times within velocities and accelerations
    (Pham and Pham 2018).  If jerk is limited, the motion is averaged over the largest ``2 acceleration / jerk``,
    which keeps all limits.  An arc in collision becomes smaller; if a small one still collides, the robot stops.

    Parameters
    ----------
    path : array_like, shape (p, dim), or InMotion
        Waypoints joined by straight motions, and velocities at both ends if the robot is not at rest there.  If all
        waypoints are equal, the trajectory is one state without duration.
    limits : Limits
    world : World, optional
        World that checks the trajectory, by its strict check if it has one.  Default: no check.
    names : sequence of str, optional
        Names of the joints; default ``joint_1``, ...
    held, controller : mapping of str to float, sequence of str, optional
        As for :class:`Trajectory`.
    deviation : float
        Largest distance from the path, >= 0 [rad or m]; 0 stops at every corner.
    step : float
        Time between two states, > 0 [s].

    Returns
    -------
    Trajectory
        Its duration is a whole number of steps; a trajectory in motion has slightly shorter steps.

    Raises
    ------
    InvalidValue
        If there is no waypoint, an argument is out of range, or there would be a million states.
    NotAvailable
        If the trajectory is not free, or violates limits or deviation.  Usually the path itself is not free then.
    """
    deviation = require_positive("deviation", deviation, or_zero=True)
    step = require_positive("step", step)
    moving = path if isinstance(path, InMotion) else InMotion(path)
    given = as_batch("path", moving.path, len(limits.velocity))
    # Only corners remain: further waypoints on a straight motion change nothing.
    waypoints = given[bends_of(given, _SAME)] if len(given) else given
    if len(given) == 0 or (len(waypoints) < 2 and (moving.start is not None or moving.goal is not None)):
        raise InvalidValue("path must lead somewhere: it needs two different waypoints or more")
    joints = tuple(names) if names is not None else tuple(f"joint_{i + 1}" for i in range(waypoints.shape[1]))
    if len(joints) != waypoints.shape[1]:
        raise InvalidValue(f"names must be {waypoints.shape[1]}, one a joint, got {len(joints)}")
    limits.require_positions(waypoints, joints)

    def trajectory(waypoints: Floats, states: TimedStates) -> Trajectory:
        return Trajectory(
            names=joints,
            limits=full,
            waypoints=waypoints,
            held=dict(held or {}),
            controller=tuple(controller),
            **states._asdict(),
        )

    full = limits
    if len(waypoints) < 2:
        return trajectory(np.array([waypoints[0], waypoints[0]]), _standing(world, waypoints[0]))
    limits = limits if limits.jerk is None else limits.symmetric()
    window = 0.0 if limits.jerk is None else float(np.max(2.0 * np.divide(limits.acceleration, limits.jerk)))
    for farther in FARTHER:
        led, speeds = moving.led(waypoints, limits, farther)
        if window > 0.0:
            break
        cuts = np.full(len(led), deviation)
        try:
            return trajectory(led, timed_path(world, led, limits, cuts, step, speeds))
        except TooFast:
            if limits.is_plain or farther == FARTHER[-1]:
                raise
    cuts = np.full(len(waypoints), deviation)
    return trajectory(waypoints, _averaged_path(world, waypoints, limits, cuts, (window, step, deviation)))


def _standing(world: World | None, q: Floats) -> TimedStates:
    """Return the single state of a robot that stays at a configuration, (dim,)."""
    free, proof = drivable(world, np.array([q, q]))
    if not free.all():
        raise NotAvailable("the robot is not proved free where it stands")
    still = np.zeros((1, len(q)))
    return TimedStates(np.zeros(1), q[np.newaxis], still, still, 0.0, 0, {"velocity": 0.0, "acceleration": 0.0}, proof)


def _averaged_path(
    world: World | None, waypoints: Floats, limits: Limits, cuts: Floats, numbers: tuple[float, float, float]
) -> TimedStates:
    """Return states, proof and measures, as `timed_path` does, for a motion averaged over a window.

    `numbers` are the window and the step [s], and the largest distance from the path.
    """
    window, step, deviation = numbers
    for tried in range(TRIES):
        curve = rounded(waypoints, cuts)
        law, fine, driven = _averaged_law(curve, waypoints, limits, window, step)
        free, proof = drivable(world, driven.positions)
        if not free.all() and len(waypoints) == 2:
            # Averages are rounded more than positions. A line that touches an obstacle needs exact positions.
            driven = driven._replace(positions=_on_line(driven.positions, *waypoints))
            free, proof = drivable(world, driven.positions)
        bad = np.concatenate([fine[:-_FINER:_FINER][~free], fine[driven.off > deviation + 1e-6]])
        if len(bad) == 0:
            off = float(np.max(driven.off))
            return TimedStates(fine[::_FINER], *driven[:3], off, len(curve.stops), driven.highest, proof)
        if len(curve.corners) == 0:
            break
        before, after = (law.length_at(bad + later - 0.5 * window) for later in (0.0, step))
        cuts = less_at(cuts, curve.corners, before, after, tried)
    refusal = f"the trajectory is not proved free, or too far from its path, at {bad[0]:.3f} s"
    return with_rests(
        lambda part, own: _averaged_path(world, part, limits, own, numbers), world, waypoints, cuts, refusal
    )


def _on_line(positions: Floats, begin: Floats, end: Floats) -> Floats:
    """Return positions, (n, dim), moved exactly onto the line that they lie on up to rounding."""
    length = float(np.linalg.norm(end - begin))
    along = (end - begin) / length
    onto: Floats = begin + np.clip((positions - begin) @ along, 0.0, length)[:, np.newaxis] * along
    return onto


def _averaged_law(
    curve: RoundedPath, waypoints: Floats, limits: Limits, window: float, step: float
) -> tuple[TimeLaw, Floats, Driven]:
    """Return the fastest law whose average over a window keeps all limits, with fine times and the states there.

    The law keeps limits of a tip and of torques only at its grid.  It is made again with a smaller share of them if
    they are exceeded between grid points.
    """
    share = 1.0
    for _ in range(_SHARES):
        law = paused(fastest(curve, limits, share=share), window)
        law, fine, driven = _on_steps(law, waypoints, limits, window, step)
        if limits.is_plain:
            return law, fine, driven
        moved = law.averages(window, fine)
        further = limits.further_shares(moved.positions, moved.velocities, moved.accelerations)
        if max(further.values(), default=0.0) <= 1.0:
            return law, fine, driven._replace(highest=driven.highest | further)
        share *= _LESS / max(further.values())
    over = ", ".join(f"{100.0 * used:.1f} % of {kind}" for kind, used in further.items())
    raise NotAvailable(f"no times were found that keep all limits: the slowest ones tried need {over}")


def _on_steps(
    law: TimeLaw, waypoints: Floats, limits: Limits, window: float, step: float
) -> tuple[TimeLaw, Floats, Driven]:
    """Return a law that also keeps its limits between grid points, with fine times and the states there.

    It ends on a whole step, after the `window`.
    """
    used = law.largest_shares(limits, _FINER)
    law = slowed(law, max(1.0, used.velocity, math.sqrt(used.acceleration)))
    steps = max(math.ceil((law.duration + window) / step - 1e-9), math.floor(window / step) + 1)
    require_steps(steps, law.duration + window, step)
    while True:
        law = slowed(law, (steps * step - window) / law.duration)
        fine = np.linspace(0.0, law.duration + window, _FINER * steps + 1)
        driven = _averaged(law, waypoints, limits, window, fine)
        if max(driven.highest.values()) <= 1.0:
            return law, fine, driven
        steps += 1


def _averaged(law: TimeLaw, waypoints: Floats, limits: Limits, window: float, fine: Floats) -> Driven:
    """Return the robot's states at fine times, averaged over the `window` before each."""
    moved, most = law.averages(window, fine), limits.of_joints
    positions, velocities, accelerations = moved.positions, moved.velocities, moved.accelerations
    highest = {
        "velocity": largest_share(velocities, most.velocity),
        "acceleration": largest_share(accelerations, most.acceleration),
        "jerk": largest_share(accelerations, fine[1] * np.array(limits.jerk), of_steps=True),
    }
    return Driven(
        np.ascontiguousarray(positions[::_FINER]),
        np.ascontiguousarray(velocities[::_FINER]),
        np.ascontiguousarray(accelerations[::_FINER]),
        distances_to(waypoints, positions),
        highest,
    )
