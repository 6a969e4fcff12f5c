"""The symmetric L2 discrepancy: unions of boxes at opposite corners (Hickernell 1998)."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, DistancePairs, ProductTerms


def symmetric_terms(columns: Array, weights: Array) -> ProductTerms:
    """(4/3)^d - (2/n) sum_i prod_k (1 + 2x - 2x^2) + (2^d/n^2) sum_ij prod_k (1 - |x_ik - x_jk|).

    Hickernell (1998), symmetric discrepancy; without weights it is 4^d times the average-squared one.
    """
    gamma = weights[:, np.newaxis]
    nothing = np.zeros_like(columns)
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 3.0)),
        linear=1.0 + gamma * 2.0 * columns * (1.0 - columns),
        linear_slope=gamma * (2.0 - 4.0 * columns),
        pairs=DistancePairs(
            level=1.0 + weights,
            slope=2.0 * weights,
            curvature=np.zeros_like(weights),
            own=nothing,
            own_slope=nothing,
        ),
    )


SYMMETRIC = Measure(
    "symmetric", "symmetric L2 discrepancy (Hickernell 1998)", symmetric_terms, reflectable=True
)
"""Unchanged by the reflection of any coordinate."""
