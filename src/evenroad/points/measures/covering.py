"""Certified bounds of the dispersion, in any dimension, over any box, by branch and bound.

A cell of the box has a centre c and half sides h.  Its farthest corner from a point x is at the distance
sqrt(sum_k (|c_k - x_k| + h_k)^2).  The least of these over all x is an upper bound for the cell.  A cell is halved if
its bound exceeds the largest distance of any centre by more than some share.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from evenroad._checks import require_positive
from evenroad._native.points import bound_dispersion
from evenroad.errors import InvalidValue
from evenroad.points.pointset import as_unit_points

SHARES = (1.0, 0.5, 0.25, 0.12, 0.06, 0.03, 0.01, 1e-3, 1e-6)
"""Shares by which the bound may exceed the dispersion, one per pass; each pass starts from the previous result.

With the last one the bound serves as the dispersion.
"""

WORK = 3e9
"""Default limit on the coordinates examined: some seconds."""

ROUNDING = 1e-12
"""Share by which the bound and the box are enlarged: a thousand times the rounding of halving and adding."""


class DispersionBounds(NamedTuple):
    """Bounds of the dispersion: `lower` is the distance of some position from all points, `upper` is proved."""

    lower: float
    upper: float


def dispersion_bounds(
    points: object, *, sides: object = None, wrapping: object = None, work: float = WORK
) -> DispersionBounds:
    """Return certified bounds of the l2-dispersion of points, (n, d) in [0, 1), over the whole cube, or a box.

    Parameters
    ----------
    points : array_like or PointSet, shape (n, d)
        n >= 1.
    sides : array_like, shape (d,), optional
        Sides of the box to which the cube is scaled, > 0 and finite; default: 1.
    wrapping : array_like of bools, shape (d,), optional
        Axes that wrap; default: none.
    work : float
        Limit on the coordinates examined, > 0; default: some seconds.  For a thousand points the bounds then agree to
        five digits up to d = 7, and to about one per cent in d = 10.

    Raises
    ------
    InvalidValue
        If there is no point, or an argument is not of that kind.
    """
    unit = as_unit_points(points)
    n, d = unit.shape
    if n == 0:
        raise InvalidValue(f"dispersion needs at least one point, got an array of shape (0, {d})")
    lengths = np.ones(d) if sides is None else np.array(sides, dtype=np.float64)
    wraps = np.zeros(d, dtype=np.bool_) if wrapping is None else np.array(wrapping, dtype=np.bool_)
    if lengths.shape != (d,) or not (np.isfinite(lengths) & (lengths > 0.0)).all():
        raise InvalidValue(f"sides must be {d} finite numbers > 0, got {sides!r}")
    if wraps.shape != (d,):
        raise InvalidValue(f"wrapping must be {d} bools, got {wrapping!r}")
    left = require_positive("work", work)
    scaled = np.unique(unit, axis=0) * lengths
    period = np.where(wraps, lengths, np.inf)
    lower, upper = 0.0, float(np.linalg.norm(np.where(wraps, 0.5 * lengths, lengths)))
    for share in SHARES:
        found = bound_dispersion(scaled, period, lengths, lower, share, left)
        lower, upper, left = found.lower, min(upper, found.upper), left - found.work
        if left <= 0.0 or upper == 0.0:
            break
    extent = float(np.linalg.norm(lengths))
    return DispersionBounds(max(lower - ROUNDING * extent, 0.0), upper * (1.0 + ROUNDING) + ROUNDING * extent)
