"""Paths: waypoints, (p, dim), joined by the shortest interpolation of their space."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.space.protocol import Space, period_of

ROUNDING = 1e-9
"""Largest rounding of a number that was shifted by whole periods [rad]."""
HALF = 0.5 - 1e-9
"""Share of a period from which a step may go in either direction."""


def motion_lengths(path: Floats, space: Space) -> Floats:
    """Return the length of each motion of a path in the metric of the space, (p - 1,)."""
    return space.distance(path[:-1], path[1:])


def path_length(path: Floats, space: Space) -> float:
    """Return the length of a path in the metric of the space; 0 for one waypoint."""
    return float(np.add.reduce(space.distance(path[:-1], path[1:])))


def continued(path: Floats, space: Space, start: Floats) -> Floats:
    """Return a path, (p, dim), with coordinates that continue from `start`, (dim,), without jumps of a period.

    The path begins at `start`, up to whole periods.  Each waypoint is moved by whole periods to the end of the motion
    from the one before.  Half a period can be moved in both directions, and a waypoint in the middle decides in which.
    Coordinates without a period do not change.
    """
    period = _finite_period(space)
    if period is None:
        return path
    steps = np.diff(path, axis=0)
    halves = np.flatnonzero((np.abs(steps - _whole(steps, period)) >= HALF * period).any(axis=1))
    if len(halves):
        path = np.insert(path, halves + 1, space.interpolate(path[halves], path[halves + 1], 0.5), axis=0)
    return _gone_on(path, period, start)


def _gone_on(path: Floats, period: Floats, start: Floats) -> Floats:
    """Return a path, (p, dim), without jumps of a period, beginning at the numbers of `start`."""
    turns = np.rint(np.diff(path, axis=0, prepend=start[np.newaxis]) / period)
    if not turns.any():
        return path
    shifts = np.cumsum(turns, axis=0)
    on = np.where(shifts == 0.0, path, path - shifts * np.where(np.isfinite(period), period, 0.0))
    # Shifted numbers are rounded.
    on[0] = np.where((turns[0] != 0.0) & (np.abs(on[0] - start) <= ROUNDING), start, on[0])
    return on


def _finite_period(space: Space) -> Floats | None:
    """Return the period of a space, (dim,), if one of its coordinates repeats; else None."""
    flat = getattr(space, "flat", None)
    if flat is not None and not flat.wraps:
        return None
    period = period_of(space)
    return None if period is None or not np.isfinite(period).any() else period


def _whole(steps: Floats, period: Floats) -> Floats:
    """Return the whole periods that are nearest to steps, (n, dim)."""
    return np.where(np.isfinite(period), period, 0.0) * np.rint(steps / period)


def _between(a: Floats, b: Floats, space: Space, share: Floats) -> Floats:
    """Return the states at shares of motions, (n, dim), with coordinates that continue from `a`."""
    states, period = space.interpolate(a, b, share), _finite_period(space)
    if period is None:
        return states
    along = a + share[:, np.newaxis] * (b - a - _whole(b - a, period))
    return states + _whole(along - states, period)


def subdivide(path: Floats, space: Space, segments: npt.NDArray[np.integer]) -> tuple[Floats, Ints]:
    """Divide each motion of a path, (p, dim), p >= 1, into equal segments, numbers (p - 1,), >= 1.

    Returns the states between segments, (1 + sum(segments), dim), which include the exact waypoints, and the rows of
    the waypoints, (p,).
    """
    own = np.concatenate([[0], np.cumsum(segments)]).astype(np.int64)
    motion = np.repeat(np.arange(len(path) - 1), segments)
    states = np.empty((own[-1] + 1, path.shape[1]))
    share = (np.arange(own[-1]) - own[motion] + 1) / segments[motion]
    states[1:] = space.interpolate(path[motion], path[motion + 1], share)
    states[own] = path
    return states, own


def resample(path: Floats, space: Space, step: float) -> tuple[Floats, Ints]:
    """Return states along a path, (s, dim), at most `step` apart, and the motion of each, (s,).

    Each motion has ``max(1, ceil(length / step))`` equal segments.  Waypoints are among the states, and belong to the
    motion that ends there.  Raises InvalidValue if `step` is not a finite number > 0.
    """
    step = require_positive("step", step)
    segments = np.maximum(np.ceil(motion_lengths(path, space) / step), 1.0).astype(np.int64)
    states, _ = subdivide(path, space, segments)
    if (period := _finite_period(space)) is not None:
        states = _gone_on(states, period, path[0])
    return states, np.concatenate([[0], np.repeat(np.arange(len(path) - 1), segments)]).astype(np.int64)


def configuration_at(path: Floats, space: Space, t: npt.ArrayLike) -> Floats:
    """Return the configurations after shares `t` of a path's length, (n,) in [0, 1], as (n, dim).

    Raises InvalidValue if a share lies outside [0, 1].
    """
    shares = np.atleast_1d(np.asarray(t, dtype=np.float64))
    if not ((shares >= 0.0) & (shares <= 1.0)).all():
        raise InvalidValue(f"t must lie in [0, 1], got {t!r}")
    if len(path) == 1:
        return np.repeat(path, len(shares), axis=0)
    travelled = np.concatenate([[0.0], np.cumsum(motion_lengths(path, space))])
    along = shares * travelled[-1]
    motion = np.clip(np.searchsorted(travelled, along, side="right") - 1, 0, len(path) - 2)
    length = travelled[motion + 1] - travelled[motion]
    within = np.divide(along - travelled[motion], length, out=np.zeros_like(along), where=length > 0.0)
    return _between(path[motion], path[motion + 1], space, np.clip(within, 0.0, 1.0))
