"""Distances between segments in double precision."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def segment_distance(
    first: npt.NDArray[np.float64], second: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the distances of pairs of segments, (n, 2, 3) each, end points in the second axis: (n,).

    Closest points of two segments after C. Ericson, Real-Time Collision Detection (2005), section 5.1.9: the
    parameter on the first is that of the two lines, clamped; that on the second follows, clamped; the first
    follows once more.  A segment may be a point.
    """
    along, other = first[:, 1] - first[:, 0], second[:, 1] - second[:, 0]
    between = first[:, 0] - second[:, 0]
    a, e, b = (np.einsum("ni,ni->n", *pair) for pair in ((along, along), (other, other), (along, other)))
    c, f = np.einsum("ni,ni->n", along, between), np.einsum("ni,ni->n", other, between)
    crossing = a * e - b * b
    # Of parallel segments any first parameter does: the two steps after it find the closest ends.
    s = _clamped(b * f - c * e, np.where(crossing > 1e-12 * a * e, crossing, 0.0))
    t = _clamped(b * s + f, e)
    s = _clamped(b * t - c, a)
    gap = between + s[:, np.newaxis] * along - t[:, np.newaxis] * other
    return np.sqrt(np.einsum("ni,ni->n", gap, gap))


def _clamped(
    numerator: npt.NDArray[np.float64], denominator: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return numerator / denominator within [0, 1]; 0 where the denominator is."""
    safe = np.where(denominator > 0.0, denominator, 1.0)
    return np.where(denominator > 0.0, np.clip(numerator / safe, 0.0, 1.0), 0.0)
