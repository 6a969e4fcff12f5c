"""Distances of points and segments, in double precision and plain numpy."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats


def segment_distance(first: Floats, second: Floats) -> Floats:
    """Return the distances of pairs of segments, (n, 2, 3) each, end points in the second axis: (n,).

    After C. Ericson, Real-Time Collision Detection (2005), section 5.1.9: the parameter on the second segment is that
    of the two lines, clamped; that on the first follows, clamped; the second follows once more.  That of the lines
    comes from the parts across the first segment, which keeps its digits where the two are nearly parallel.  A segment
    may be a point.
    """
    along, other = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e, b = _dot(along, along), _dot(other, other), _dot(along, other)
    c, f = _dot(along, between), _dot(other, between)
    safe = np.where(a > 0.0, a, 1.0)
    across = other - (b / safe)[:, np.newaxis] * along
    between_across = between - (c / safe)[:, np.newaxis] * along
    squared = _dot(across, across)
    # Of parallel segments any second parameter does: the two steps after it find the closest ends.
    t = _clamped(_dot(across, between_across), np.where(squared > 1e-30, squared, 0.0))
    s = _clamped(b * t - c, a)
    t = _clamped(b * s + f, e)
    gap = between + s[:, np.newaxis] * along - t[:, np.newaxis] * other
    return np.sqrt(_dot(gap, gap))


def _dot(first: Floats, second: Floats) -> Floats:
    return np.einsum("ni,ni->n", first, second)


def _clamped(numerator: Floats, denominator: Floats) -> Floats:
    """Return numerator / denominator within [0, 1]; 0 where the denominator is."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.where(denominator > 0.0, np.clip(numerator / safe, 0.0, 1.0), 0.0)
