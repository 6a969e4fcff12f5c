"""Checks of plain arguments, with errors that name the value."""

from __future__ import annotations

import math

import numpy as np

from evenroad.errors import InvalidValue, shown

LARGEST_COUNT = 2**31 - 1
"""Nodes of a roadmap are numbered by int32: nothing that is counted here can sensibly be larger."""


def require_count(name: str, value: object, at_least: int = 1) -> int:
    """Return `value` as an int >= `at_least`, or raise InvalidValue naming it (`n`, `d`, `k`, ...)."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < at_least:
        raise InvalidValue(f"{name} must be an integer >= {at_least}, got {shown(value)}")
    if value > LARGEST_COUNT:
        raise InvalidValue(
            f"{name} must be at most {LARGEST_COUNT}, got an integer of {math.floor(math.log10(value)) + 1} digits"
        )
    return int(value)


def require_positive(name: str, value: object, *, or_zero: bool = False) -> float:
    """Return `value` as a finite float > 0 (or >= 0), or raise InvalidValue naming it."""
    allowed = "a finite number >= 0" if or_zero else "a finite number > 0"
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        raise InvalidValue(f"{name} must be {allowed}, got {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number) or number < 0 or (number == 0 and not or_zero):
        raise InvalidValue(f"{name} must be {allowed}, got {shown(value)}")
    return number
