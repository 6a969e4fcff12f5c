"""Distances of all pairs from two batches: what a search for neighbours asks of metrics that are not flat."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.space.protocol import Space


def all_distances(
    space: Space, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the distance of every row of `a`, (n, dim), from every row of `b`, (m, dim), as (n, m).

    By the space's own ``all_distances(a, b)`` if it has one, which is a matter of speed alone: it gives what
    ``distance`` gives, up to rounding.

    Raises
    ------
    InvalidValue
        As the space's ``distance``.
    """
    own = getattr(space, "all_distances", None)
    if own is not None:
        return own(a, b)
    pairs = np.repeat(a, len(b), axis=0), np.tile(b, (len(a), 1))
    return space.distance(*pairs).reshape(len(a), len(b))
