"""The wrap-around L2 discrepancy: boxes on the torus (Hickernell 1998)."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, DistancePairs, ProductTerms


def wrap_around_terms(columns: Array, weights: Array) -> ProductTerms:
    """-(4/3)^d + (1/n^2) sum_ij prod_k (3/2 - t(1 - t)), t = |x_ik - x_jk| (Hickernell 1998, wrap-around).

    The kernel's integral over one argument is 4/3 everywhere, so the linear term is a constant.
    """
    level = 1.0 + weights / 3.0
    nothing = np.zeros_like(columns)
    return ProductTerms(
        constant=float(np.prod(level)),
        linear=np.broadcast_to(level[:, np.newaxis], columns.shape),
        linear_slope=nothing,
        pairs=DistancePairs(
            level=1.0 + weights / 2.0, slope=weights, curvature=weights, own=nothing, own_slope=nothing
        ),
    )


WRAP_AROUND = Measure(
    "wrap_around",
    "wrap-around L2 discrepancy (Hickernell 1998)",
    wrap_around_terms,
    periodic=True,
    reflectable=True,
)
"""Unchanged by shifts modulo 1 and by reflections."""
