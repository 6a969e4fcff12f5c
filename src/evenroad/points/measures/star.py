"""The L2 star discrepancy: boxes anchored at the origin (Warnock 1972)."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, MaximumPairs, ProductTerms


def star_terms(columns: Array, weights: Array) -> ProductTerms:
    """3^-d - (2/n) sum_i prod_k (1 - x_ik^2)/2 + (1/n^2) sum_ij prod_k (1 - max(x_ik, x_jk)).

    Warnock (1972).
    """
    d = columns.shape[0]
    return ProductTerms(
        constant=3.0**-d,
        linear=(1.0 - columns * columns) / 2.0,
        linear_slope=-columns,
        pairs=MaximumPairs(ceiling=np.ones(d), slope=np.ones(d)),
    )


STAR = Measure("star", "L2 star discrepancy (Warnock 1972)", star_terms, weighted=False)
"""Mean square over all boxes [0, y) of (share of the points inside - volume)."""
