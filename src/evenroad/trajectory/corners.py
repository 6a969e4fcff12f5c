"""Which corners are cut less: a trajectory is tried, checked as it is driven, and tried again where it is not free."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.world import World

MOST_STATES = 1_000_000
"""Largest number of states, more than two hours at 125 Hz."""

_HALVINGS = 6
"""Number of times that a blend in collision is halved; then the robot stops at the corner."""
_STOPPINGS = 6
"""Number of times that corners become stops: each moves the times at which states are checked."""
TRIES = _HALVINGS + _STOPPINGS

_STATES = ("positions", "velocities", "accelerations")


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
    """Return `cuts`, (p,), smaller where motions from state to state are not free; after some tries these are stops.

    They are smaller at the corner nearest to the length at which such a motion begins or, where that is a stop already,
    at which it ends.
    """
    if len(corners) == 0:
        return cuts
    first, last = (1 + np.argmin(np.abs(lengths[:, None] - corners), axis=1) for lengths in (before, after))
    near = np.unique(np.where(cuts[first] > 0.0, first, last))
    cuts = cuts.copy()
    cuts[near] = 0.0 if tried >= _HALVINGS - 1 else 0.5 * cuts[near]
    return cuts


def with_rests(
    make: Callable[[Floats, Floats], dict[str, Any]], world: World | None, waypoints: Floats, cuts: Floats, refusal: str
) -> dict[str, Any]:
    """Return what `make` does of waypoints and cuts, made for each part of a path between two stops on its own.

    So a state lies at each stop, where else the motion from the state before to that after it cuts the corner.  Stops
    are the corners whose `cuts`, (p,), are 0.  Raises NotAvailable, with the text of the refusal, where this is not
    free, either.
    """
    stops = [0, *(1 + np.flatnonzero(cuts[1:-1] == 0.0)).tolist(), len(cuts) - 1]
    if len(stops) == 2:
        raise NotAvailable(refusal)
    try:
        parts = [make(waypoints[i : j + 1], cuts[i : j + 1]) for i, j in pairwise(stops)]
    except NotAvailable as error:
        raise NotAvailable(refusal) from error
    joined = {name: np.concatenate([each[name][k > 0 :] for k, each in enumerate(parts)]) for name in _STATES}
    lasts = np.cumsum([len(each["times"]) - 1 for each in parts])
    joined["positions"][[0, *lasts]] = waypoints[stops]
    free, proof = drivable(world, joined["positions"])
    if not free.all():
        raise NotAvailable(refusal)
    return joined | {
        "times": parts[0]["times"][1] * np.arange(len(joined["positions"])),
        "deviation": max(each["deviation"] for each in parts),
        "stops": sum(each["stops"] for each in parts) + len(parts) - 1,
        "highest": {name: max(each["highest"][name] for each in parts) for name in parts[0]["highest"]},
        "proof": proof,
    }
