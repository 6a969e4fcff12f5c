"""The mixture L2 discrepancy, between centred and wrap-around (Zhou, Fang and Ning 2013)."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, DistancePairs, ProductTerms


def mixture_terms(columns: Array, weights: Array) -> ProductTerms:
    """Zhou, Fang and Ning (2013), with z = x - 1/2.

    (19/12)^d - (2/n) sum_i prod_k (5/3 - |z_ik|/4 - z_ik^2/4)
    + (1/n^2) sum_ij prod_k (15/8 - |z_ik|/4 - |z_jk|/4 - 3 |x_ik - x_jk|/4 + (x_ik - x_jk)^2/2).
    """
    gamma = weights[:, np.newaxis]
    centred = columns - 0.5
    side = np.sign(centred)
    return ProductTerms(
        constant=float(np.prod(1.0 + weights * 7.0 / 12.0)),
        linear=1.0 + gamma * (2.0 / 3.0 - (np.abs(centred) + centred * centred) / 4.0),
        linear_slope=-gamma * (side / 4.0 + centred / 2.0),
        pairs=DistancePairs(
            level=1.0 + weights * 7.0 / 8.0,
            slope=weights * 3.0 / 4.0,
            curvature=weights / 2.0,
            own=-gamma * np.abs(centred) / 4.0,
            own_slope=-gamma * side / 4.0,
        ),
    )


MIXTURE = Measure(
    "mixture", "mixture L2 discrepancy (Zhou, Fang and Ning 2013)", mixture_terms, reflectable=True
)
"""Unchanged by the reflection of any coordinate."""
