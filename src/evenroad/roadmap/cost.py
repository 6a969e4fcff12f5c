"""What an edge costs: its length, or more."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad.errors import InvalidValue
from evenroad.space import Space

EdgeCost: TypeAlias = Callable[[Floats, Floats], Floats]
"""Costs of the motions between the rows of two (m, dim) arrays, (m,); the same both ways, >= their lengths."""

BOUND = 1.0 - 1e-9
"""Costs are at least this share of the length: room for the rounding of a cost that should be the length."""


def edge_costs(space: Space, q: Floats, edges: Ints32, cost: EdgeCost | None = None) -> Floats:
    """Return what the edges between rows of `q` cost, (m,): by default their lengths.

    InvalidValue for a `cost` of another shape, not finite or below the length: the metric then is no bound.
    """
    a, b = q[edges[:, 0]], q[edges[:, 1]]
    lengths = space.distance(a, b)
    if cost is None:
        return lengths
    costs = np.asarray(cost(a, b), dtype=np.float64)
    if costs.shape != lengths.shape:
        raise InvalidValue(f"the edge cost must return shape {lengths.shape}, got {costs.shape}")
    bad = ~(np.isfinite(costs) & (costs >= lengths * BOUND))
    if bad.any():
        i = int(np.flatnonzero(bad)[0])
        raise InvalidValue(
            f"the edge cost must be finite and at least the length: the motion from {a[i].tolist()} to"
            f" {b[i].tolist()} has length {lengths[i]:.6g} and cost {costs[i]:.6g}"
        )
    return costs
