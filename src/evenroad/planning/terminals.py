"""Terminals of paths: each begins at the exact numbers of its start, and ends at its goal up to whole turns."""

from __future__ import annotations

import math

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.space import Space
from evenroad.space.path import continued
from evenroad.space.protocol import period_of
from evenroad.world import World

SAME = 1e-9
"""Largest difference between the first numbers of a path and those of the start, for numbers of 1."""
NEAR = 1e-6
"""Distance up to which the end of a path counts as the goal, for numbers of 1. It allows only for rounding."""


def as_start_and_goals(start: object, goal: object, space: Space) -> tuple[Floats, Floats]:
    """Return start, (dim,), and goals, (g, dim), from one start and one or more goals.

    Raises InvalidValue if they do not have the dimension of the space, or are not finite.
    """
    dim = space.dim
    first, goals = _finite(start), _finite(goal)
    if first.shape != (dim,):
        raise InvalidValue(f"start must be {dim} finite numbers, got {start!r}")
    if goals.shape != (dim,) and (goals.ndim != 2 or goals.shape[1] != dim or not len(goals)):
        several = f"or an array (g, {dim}) of g >= 1 goals"
        raise InvalidValue(f"goal must be {dim} finite numbers, {several}, got {goal!r}")
    return first, goals.reshape(-1, dim)


def _finite(value: object) -> Floats:
    """Return a copy as floats; for anything but finite numbers, an array of a shape that is refused."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty((0, 0))
    # The sum of squares is usually finite, and faster to test.
    if math.isfinite(np.vdot(array, array)) or np.isfinite(array).all():
        return array
    return np.empty((0, 0))


def turns(space: Space) -> bool:
    """Return whether a coordinate may repeat."""
    flat = getattr(space, "flat", None)
    return flat is None or flat.wraps


def joins(path: Floats, raw: Floats | None, start: Floats, goal: Floats) -> bool:
    """Return whether a path and its `raw` one lead from the exact numbers of the start to those of the goal."""
    first, last = start.tolist(), goal.tolist()
    if path[0].tolist() != first or path[-1].tolist() != last:
        return False
    return raw is None or raw is path or (raw[0].tolist() == first and raw[-1].tolist() == last)


def from_start_to_goal(space: Space, path: Floats, start: Floats, goal: Floats) -> Floats:
    """Return a path, (p, dim), from the exact numbers of its start to its goal, both (dim,).

    Coordinates that repeat continue from those of the start, so the path may end whole periods away from the goal.
    Raises AssertionError for a path that leads elsewhere.
    """
    on = continued(path, space, start) if turns(space) else path
    if not joins(on, None, start, goal):
        _require_near("start", max(_gap(space, on[0], start), _gap_in_numbers(space, on[0], start)), SAME, start)
        _require_near("end", _gap(space, on[-1], goal), NEAR, goal)
        is_there = np.abs(on[-1] - goal) <= SAME * np.maximum(1.0, np.abs(goal))
        on = np.concatenate([start[np.newaxis], on[1:-1], np.where(is_there, goal, on[-1])[np.newaxis]])
    if on is not path:
        on.setflags(write=False)
    return on


def turns_at_end(world: World, path: Floats, goal: Floats) -> str:
    """Return in words which coordinates of a path's end are whole periods from the goal; an empty text if none."""
    period = period_of(world.space)
    if period is None or not (away := np.rint((path[-1] - goal) / period)).any():
        return ""
    own = getattr(getattr(world, "robot", None), "group", None) or getattr(world.space, "names", None)
    names = own or [f"coordinate {k}" for k in range(len(goal))]
    said = ", ".join(f"{names[k]} ends at {path[-1][k]:.6g}" for k in np.flatnonzero(away))
    return f"; {said}, whole turns from the goal"


def _gap(space: Space, configuration: Floats, wanted: Floats) -> float:
    if not np.isfinite(configuration).all():
        return math.inf
    return float(space.distance(configuration[np.newaxis], wanted[np.newaxis])[0])


def _gap_in_numbers(space: Space, configuration: Floats, wanted: Floats) -> float:
    """Return the largest difference of repeating coordinates; a distance would ignore their turns."""
    period = period_of(space)
    return 0.0 if period is None else float(np.abs(configuration - wanted).max(where=np.isfinite(period), initial=0.0))


def _require_near(name: str, away: float, near: float, wanted: Floats) -> None:
    if not away <= near * max(1.0, float(np.abs(wanted).max())):
        raise AssertionError(
            f"the path that was found does not {name} at its query, but {away:.3g} away:"
            " this is a fault of evenroad's, please report it"
        )
