"""Which corners are cut less: a trajectory is tried, checked as it is driven, and tried again where it is not free."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.errors import InvalidValue
from evenroad.world import World

MOST_STATES = 1_000_000
"""Largest number of states, more than two hours at 125 Hz."""

_HALVINGS = 6
"""Number of times that a blend in collision is halved; then the robot stops at the corner."""
_STOPPINGS = 6
"""Number of times that corners become stops: each moves the times at which states are checked."""
TRIES = _HALVINGS + _STOPPINGS


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
    # `isinstance` would take as long as the fastest times.
    if (validate := getattr(world, "validate", None)) is not None:
        return validate(positions), str(getattr(world, "proof", "resolution"))
    return world.motion_valid(positions[:-1], positions[1:]), str(getattr(world, "proof", "resolution"))


def less_at(cuts: Floats, corners: Floats, lengths: Floats, tried: int) -> Floats:
    """Return `cuts`, (p,), smaller at the corners nearest to the given lengths; after some tries these are stops."""
    if len(corners) == 0:
        return cuts
    near = 1 + np.unique(np.argmin(np.abs(lengths[:, None] - corners), axis=1))
    cuts = cuts.copy()
    cuts[near] = 0.0 if tried >= _HALVINGS - 1 else 0.5 * cuts[near]
    return cuts
