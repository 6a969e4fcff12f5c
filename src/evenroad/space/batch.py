"""Readers of arguments: batches of configurations, and rows of parameters; InvalidValue names the fault."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_batch as as_batch
from evenroad._checks import as_row
from evenroad.errors import InvalidValue


def as_batch_pair(a: object, b: object, dim: int) -> tuple[Floats, Floats]:
    """Return the endpoints of a batch of motions, both checked by `as_batch`, of one length."""
    first, second = as_batch("a", a, dim), as_batch("b", b, dim)
    if len(first) != len(second):
        raise InvalidValue(f"a and b must have the same length, got {len(first)} and {len(second)}")
    return first, second


def as_cube_batch(u: object, cube_dim: int) -> Floats:
    """Return `u` checked by `as_batch` and to lie in the closed unit cube."""
    unit = as_batch("u", u, cube_dim)
    outside = (unit < 0.0) | (unit > 1.0)
    if outside.any():
        i, k = np.argwhere(outside)[0]
        raise InvalidValue(f"u must lie in [0, 1]: entry [{i}, {k}] is {float(unit[i, k])!r}")
    return unit


def as_fractions(t: object, n: int) -> Floats:
    """Return the fractions `t` of `n` motions, a scalar or (n,) in [0, 1], as a column (n, 1)."""
    try:
        fraction = np.asarray(t, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidValue(f"t must be numbers in [0, 1]: {error}") from None
    if fraction.shape not in ((), (n,)):
        raise InvalidValue(f"t must be a scalar or have shape ({n},), got {fraction.shape}")
    if not ((fraction >= 0.0) & (fraction <= 1.0)).all():
        raise InvalidValue("t must lie in [0, 1]")
    return np.broadcast_to(fraction, (n,))[:, np.newaxis]


def as_bounds(low: Sequence[float], high: Sequence[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return `low` and `high` as rows of one length with ``low < high`` on every axis."""
    lows = as_row("low", low)
    highs = as_row("high", high, len(lows))
    for k, (least, most) in enumerate(zip(lows, highs, strict=True)):
        if not (least < most and math.isfinite(most - least)):
            raise InvalidValue(f"low must be less than high on every axis; axis {k} has {least!r}, {most!r}")
    return lows, highs


def as_weights(weights: Sequence[float] | None, length: int) -> tuple[float, ...]:
    """Return `weights` as `length` floats > 0; None stands for ones."""
    row = (1.0,) * length if weights is None else as_row("weights", weights, length)
    if min(row) <= 0.0:
        raise InvalidValue(f"weights must be > 0, got {weights!r}")
    return row
