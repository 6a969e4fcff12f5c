"""How numbers are written in tables."""

from __future__ import annotations

import math

from evenroad.research.statistics import Interval


def percent(share: float) -> str:
    """Write a share as a percentage with one digit: ``52.8``."""
    return f"{100 * share:.1f}"


def with_interval(share: float, interval: Interval) -> str:
    """Write a share and its interval: ``52.8 [50, 56]``."""
    return f"{percent(share)} {_ends(interval)}"


def difference(share: float, interval: Interval) -> str:
    """Write a difference in points and its interval: ``+7.5 [2, 13]``."""
    return f"{100 * share:+.1f} {_ends(interval)}"


def number(value: float, digits: int = 1) -> str:
    """Write a number, or a dash where there is none."""
    return "–" if math.isnan(value) else f"{value:.{digits}f}"


def count_range(counts: tuple[int, ...]) -> str:
    """Write the range of some counts: ``400`` or ``64–400``."""
    low, high = min(counts), max(counts)
    return str(low) if low == high else f"{low}–{high}"


def _ends(interval: Interval) -> str:
    return f"[{100 * interval.low:.0f}, {100 * interval.high:.0f}]"
