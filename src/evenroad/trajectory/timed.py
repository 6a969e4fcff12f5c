"""Trajectories without limits of jerk; each try is one call of compiled code."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.trajectory import timed
from evenroad.errors import NotAvailable
from evenroad.trajectory.corners import MOST_STATES, TRIES, TimedStates, drivable, less_at, require_steps, with_rests
from evenroad.trajectory.limits import Limits, named_shares
from evenroad.world import World


class TooFast(NotAvailable):
    """A velocity at the start or the goal is too fast for the path."""


def timed_path(
    world: World | None,
    waypoints: Floats,
    limits: Limits,
    cuts: Floats,
    step: float,
    speeds: tuple[float, float] = (0.0, 0.0),
) -> TimedStates:
    """Return states, proof and measures of the fastest trajectory, with corners within `cuts`, (p,), or less.

    It has these speeds along the path at start and goal.  Errors are those of
    :func:`evenroad.trajectory.make_trajectory`.
    """
    within = limits.along(*speeds, 1.0)
    for tried in range(TRIES):
        made = timed(waypoints, cuts, limits.of_joints, within, step, MOST_STATES)
        cuts = made.deviations
        shares = {"velocity": made.highest.velocity, "acceleration": made.highest.acceleration}
        shares |= named_shares(made.further)
        if made.outcome == "too long":
            require_steps(MOST_STATES + 1, made.duration, step)
        if made.outcome != "made":
            raise _refused(made.outcome, waypoints, limits, shares, "start" if made.is_slower_at_start else "goal")
        free, proof = drivable(world, made.positions)
        if free.all():
            lasts = made.duration / len(free) if any(speeds) else step
            times: Floats = lasts * np.arange(len(free) + 1, dtype=np.float64)
            states = made.positions, made.velocities, made.accelerations
            return TimedStates(times, *states, made.deviation, made.stops, shares, proof)
        if len(made.corners) == 0:
            break
        cuts = less_at(cuts, made.corners, made.lengths[:-1][~free], made.lengths[1:][~free], tried)
    refusal = f"the trajectory is not proved free at {made.duration * np.argmin(free) / len(free):.3f} s"
    if any(speeds):
        raise NotAvailable(refusal)
    return with_rests(lambda part, own: timed_path(world, part, limits, own, step), world, waypoints, cuts, refusal)


def _refused(outcome: str, waypoints: Floats, limits: Limits, shares: dict[str, float], end: str) -> NotAvailable:
    """Return the error of a trajectory that was not made: it uses these shares of limits, or is too fast at an end."""
    if outcome == "too heavy":
        shares_between = np.linspace(0.0, 1.0, 60)[:, np.newaxis]
        return limits.too_heavy(np.concatenate([a + shares_between * (b - a) for a, b in pairwise(waypoints)]))
    if outcome == "too fast":
        text = f"the velocity at the {end} is too fast for the path: within the limits the robot cannot stop on it"
        return TooFast(text)
    over = ", ".join(f"{100.0 * share:.1f} % of {kind}" for kind, share in shares.items())
    return NotAvailable(f"no times were found that keep all limits: the slowest ones tried need {over}")
