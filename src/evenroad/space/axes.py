"""Reading a space's parameters: rows of numbers, one an axis, with errors that name the value."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evenroad._checks import as_row as as_row
from evenroad.errors import InvalidValue


def as_bounds(low: Sequence[float], high: Sequence[float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return `low` and `high` as rows of one length with ``low < high`` on every axis.

    Raises
    ------
    InvalidValue
        Naming the first axis whose bounds are not such.
    """
    lows = as_row("low", low)
    highs = as_row("high", high, len(lows))
    for k, (least, most) in enumerate(zip(lows, highs, strict=True)):
        if not (least < most and math.isfinite(most - least)):
            raise InvalidValue(f"low must be less than high on every axis; axis {k} has {least!r}, {most!r}")
    return lows, highs


def as_weights(weights: Sequence[float] | None, length: int) -> tuple[float, ...]:
    """Return `weights` as `length` floats > 0; None stands for ones.

    Raises
    ------
    InvalidValue
        If they are not `length` finite numbers > 0.
    """
    row = (1.0,) * length if weights is None else as_row("weights", weights, length)
    if min(row) <= 0.0:
        raise InvalidValue(f"weights must be > 0, got {weights!r}")
    return row
