"""The average-squared discrepancy: L2 star discrepancies from each of the 2^d corners, averaged."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, DistancePairs, ProductTerms


def average_squared_terms(columns: Array, weights: Array) -> ProductTerms:
    """Mean of the squared L2 star discrepancy over all 2^d corners taken as the origin, in closed form.

    3^-d - (2/n) sum_i prod_k (1 + 2 x_ik - 2 x_ik^2)/4 + (1/n^2) sum_ij prod_k (1 - |x_ik - x_jk|)/2:
    Warnock's formula averaged over x and 1 - x in every coordinate (Clement, Kirk, Owen and Rusch 2025).
    """
    d = columns.shape[0]
    nothing = np.zeros_like(columns)
    return ProductTerms(
        constant=3.0**-d,
        linear=(1.0 + 2.0 * columns * (1.0 - columns)) / 4.0,
        linear_slope=0.5 - columns,
        pairs=DistancePairs(
            level=np.full(d, 0.5),
            slope=np.full(d, 0.5),
            curvature=np.zeros(d),
            own=nothing,
            own_slope=nothing,
        ),
    )


AVERAGE_SQUARED = Measure(
    "average_squared",
    "average-squared L2 discrepancy over all corners",
    average_squared_terms,
    weighted=False,
    reflectable=True,
)
"""The star discrepancy without its favour for the origin."""
