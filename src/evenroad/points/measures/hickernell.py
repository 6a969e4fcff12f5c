"""Hickernell's modified L2 discrepancy: the star discrepancies of all projections together."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, MaximumPairs, ProductTerms


def hickernell_terms(columns: Array, weights: Array) -> ProductTerms:
    """Sum the squared L2 star discrepancies of all 2^d - 1 projections in closed form (Joe 1997).

    (4/3)^d - (2/n) sum_i prod_k (3 - x_ik^2)/2 + (1/n^2) sum_ij prod_k (2 - max(x_ik, x_jk)); a projection
    onto some coordinates is weighted by the product of their weights.
    """
    gamma = weights[:, np.newaxis]
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 3.0)),
        linear=1.0 + gamma * (1.0 - columns * columns) / 2.0,
        linear_slope=-gamma * columns,
        pairs=MaximumPairs(ceiling=1.0 + weights, slope=weights),
    )


HICKERNELL = Measure(
    "hickernell", "Hickernell L2 discrepancy, all projections (Hickernell 1998; Joe 1997)", hickernell_terms
)
"""D_H of the MPMC papers: a small value is even in every projection."""
