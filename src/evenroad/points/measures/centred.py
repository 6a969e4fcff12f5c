"""The centred L2 discrepancy: boxes anchored at the nearest corner (Hickernell 1998)."""

from __future__ import annotations

import numpy as np

from evenroad.points.measures.measure import Measure
from evenroad.points.measures.terms import Array, DistancePairs, ProductTerms


def centred_terms(columns: Array, weights: Array) -> ProductTerms:
    """Hickernell (1998), with z = x - 1/2.

    (13/12)^d - (2/n) sum_i prod_k (1 + |z_ik|/2 - z_ik^2/2)
    + (1/n^2) sum_ij prod_k (1 + |z_ik|/2 + |z_jk|/2 - |x_ik - x_jk|/2).
    """
    gamma = weights[:, np.newaxis]
    centred = columns - 0.5
    side = np.sign(centred)
    return ProductTerms(
        constant=float(np.prod(1.0 + weights / 12.0)),
        linear=1.0 + gamma * (np.abs(centred) - centred * centred) / 2.0,
        linear_slope=gamma * (side / 2.0 - centred),
        pairs=DistancePairs(
            level=np.ones_like(weights),
            slope=weights / 2.0,
            curvature=np.zeros_like(weights),
            own=gamma * np.abs(centred) / 2.0,
            own_slope=gamma * side / 2.0,
        ),
    )


CENTRED = Measure("centred", "centred L2 discrepancy (Hickernell 1998)", centred_terms, reflectable=True)
"""Unchanged by the reflection of any coordinate."""
