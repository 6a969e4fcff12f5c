"""Costs of a roadmap's edges, and the number of links to a start or goal."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from evenroad._arrays import Floats, Ints32
from evenroad._checks import require_count
from evenroad.errors import InvalidValue
from evenroad.space import Space

LINKS = 100
"""Number of milestones that start and goals are linked to by default, besides those of the rule.

From a start in a narrow passage, few of the nearest milestones are visible.  On shelves, 100 links instead of k = 10 to
20 add 20 to 45 points of success with every sampler, for a few checks per query.  Edges between milestones do not
change.
"""

FEW = 256
"""Number of milestones up to which start and goals are linked to all."""


EdgeCost: TypeAlias = Callable[[Floats, Floats], Floats]
"""Costs of the motions between the rows of two (m, dim) arrays, (m,); equal in both directions, >= their lengths."""
BOUND = 1.0 - 1e-9
"""Smallest ratio of a cost to the length. It allows for the rounding of a cost that equals the length."""


def links_among(milestones: int, links: int | None) -> int:
    """Return the number of milestones that start and goals are linked to besides those of the rule."""
    if links is None:
        return 0
    return milestones if milestones <= FEW else min(links, milestones)


def require_links(links: int | None) -> None:
    """Raise InvalidValue unless this is a number of links, or None."""
    if links is not None:
        require_count("links", links)


def edge_costs(space: Space, q: Floats, edges: Ints32, cost: EdgeCost | None = None) -> Floats:
    """Return the costs of the edges between rows of `q`, (m,): by default their lengths.

    Raises InvalidValue for a `cost` of another shape, or one that is not finite or below the length, since the metric
    would then be no bound.
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
