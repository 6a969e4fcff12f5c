"""Repeated tries of a trajectory: each is checked as driven, and corners that are not free are cut less."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.world import World

MOST_STATES = 1_000_000
"""Largest number of states: more than two hours at 125 Hz."""

_HALVINGS = 6
"""Number of times that a blend in collision is halved before the robot stops at the corner."""
_STOPPINGS = 6
"""Number of times that corners become stops. Each stop shifts the times at which states are checked."""
TRIES = _HALVINGS + _STOPPINGS


class TimedStates(NamedTuple):
    """States of a robot at even times, with the proof of its motions and the measures of a :class:`Trajectory`."""

    times: Floats
    positions: Floats
    velocities: Floats
    accelerations: Floats
    deviation: float
    stops: int
    highest: dict[str, float]
    proof: str


def require_steps(steps: int, duration: float, step: float) -> None:
    """Raise InvalidValue for too many steps."""
    if steps > MOST_STATES:
        raise InvalidValue(
            f"the trajectory would take {duration:.4g} s in steps of {step:g} s, more than {MOST_STATES} of them:"
            " take longer steps, or move faster"
        )


def drivable(world: World | None, positions: Floats) -> tuple[Bools, str]:
    """Return which motions from state to state are free, (n - 1,), and the proof."""
    if world is None:
        return np.ones(len(positions) - 1, dtype=bool), "unchecked"
    proof = str(getattr(world, "proof", "resolution"))
    # `isinstance` would take as long as the fastest times.
    for name in ("validate", "driven_free"):
        if (check := getattr(world, name, None)) is not None:
            return check(positions), proof
    return world.motion_valid(positions[:-1], positions[1:]), proof


def less_at(cuts: Floats, corners: Floats, before: Floats, after: Floats, tried: int) -> Floats:
    """Return `cuts`, (p,), made smaller at motions that are not free; after some tries the robot stops there.

    The smaller cut is at the corner nearest to the beginning of such a motion or, if that is a stop already, to its
    end.
    """
    if len(corners) == 0:
        return cuts
    first, last = (1 + np.argmin(np.abs(lengths[:, None] - corners), axis=1) for lengths in (before, after))
    near = np.unique(np.where(cuts[first] > 0.0, first, last))
    cuts = cuts.copy()
    cuts[near] = 0.0 if tried >= _HALVINGS - 1 else 0.5 * cuts[near]
    return cuts


def with_rests(
    make: Callable[[Floats, Floats], TimedStates], world: World | None, waypoints: Floats, cuts: Floats, refusal: str
) -> TimedStates:
    """Return the states that `make` gives for waypoints and cuts, called separately for each part between two stops.

    A state then lies at each stop; otherwise the motion between the states around it would cut the corner.  Stops are
    the corners whose `cuts`, (p,), are 0.  Raises NotAvailable, with the text of the refusal, if this is not free
    either.
    """
    stops = [0, *(1 + np.flatnonzero(cuts[1:-1] == 0.0)).tolist(), len(cuts) - 1]
    if len(stops) == 2:
        raise NotAvailable(refusal)
    try:
        parts = [make(waypoints[i : j + 1], cuts[i : j + 1]) for i, j in pairwise(stops)]
    except NotAvailable as error:
        raise NotAvailable(refusal) from error
    positions, velocities, accelerations = (
        np.concatenate([rows[k > 0 :] for k, rows in enumerate(of_parts)])
        for of_parts in zip(*(part[1:4] for part in parts), strict=True)
    )
    positions[[0, *np.cumsum([len(part.times) - 1 for part in parts])]] = waypoints[stops]
    free, proof = drivable(world, positions)
    if not free.all():
        raise NotAvailable(refusal)
    return TimedStates(
        parts[0].times[1] * np.arange(len(positions), dtype=np.float64),
        positions,
        velocities,
        accelerations,
        max(part.deviation for part in parts),
        sum(part.stops for part in parts) + len(parts) - 1,
        {name: max(part.highest[name] for part in parts) for name in parts[0].highest},
        proof,
    )
