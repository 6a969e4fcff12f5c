"""Configurations and motions as the kernels take them: within bounds, wrapped, endpoints in a fixed order."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import inlined, quick_inlined
from evenroad.space.joints import SLACK

Floats = npt.NDArray[np.float64]


@quick_inlined
def enter(q: Floats, bounds: Floats, into: Floats) -> bool:
    """Write `q` with its wrapping coordinates in their ranges and return whether the others are within theirs, up to
    `SLACK`.

    `bounds`, (3, dim), are low, high and period of each coordinate; a period of inf where it does not wrap.
    """
    inside = True
    for k in range(len(q)):
        value, low, high, period = q[k], bounds[0, k], bounds[1, k], bounds[2, k]
        if period == np.inf:
            inside &= low - SLACK <= value <= high + SLACK
        else:
            value = wrapped(value, low, high, period)
        into[k] = value
    return inside


@inlined
def wrapped(value: float, low: float, high: float, period: float) -> float:
    """Return a coordinate that repeats after `period` in its range, [low, high)."""
    if not low <= value < high:
        value = low + (value - low) % period
        if value >= high:
            value = low
    return value


@quick_inlined
def span(start: Floats, end: Floats, bounds: Floats, resolution: float, direction: Floats) -> int:
    """Put the ends in dictionary order, write the short way between them and return its number of segments.

    States are rounded: without a fixed order a motion and its reverse could be judged differently.  The ends are as
    `enter` writes them, no segment is longer than the resolution in the Euclidean metric.
    """
    exchange = False
    for k in range(len(start)):
        if start[k] != end[k]:
            exchange = start[k] > end[k]
            break
    squared = 0.0
    for k in range(len(start)):
        if exchange:
            start[k], end[k] = end[k], start[k]
        direction[k] = end[k] - start[k]
        period = bounds[2, k]
        if period != np.inf:
            # As FlatMetric: one half is rounded to zero, so that opposite places keep the sign.
            direction[k] -= period * np.rint(direction[k] / period)
        squared += direction[k] * direction[k]
    return math.ceil(math.sqrt(squared) / resolution)
