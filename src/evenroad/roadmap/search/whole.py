"""Lengths as whole numbers, so that sums do not depend on their order and ties are really ties.

With floats, two paths over the same lengths can differ in the last bit by the order of their edges, and which one
is shortest then depends on which edges were searched.  Whole lengths make the shortest path, with ties to the
lower node, one well-defined path: a lazy search and a full one must find the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

MOST = 1 << 61
"""What bounds are cut to: the sum of one and any path is still a 64-bit integer."""

_NEXT_TO_ZERO = 1e-280
"""A quantum of a shorter length would lose its digits, or be 0."""


@dataclass(frozen=True)
class Ruler:
    """Measures lengths in quanta of such a size that every path fits into 61 bits.

    The quantum is ``longest / 2^bits`` with up to 52 bits: as fine as floats are for the longest edge while a
    graph has fewer than 512 nodes, a bit coarser with each doubling (2^-41 of it at a million).
    """

    quantum: float

    @classmethod
    def of(cls, longest: float, nodes: int) -> Ruler:
        """Return the ruler for paths of up to `nodes` edges, none above `longest`."""
        bits = min(52, 61 - max(nodes, 1).bit_length())
        # Nothing but zero lengths, or what is next to it: any quantum does.
        return cls(longest / 2.0**bits if longest > _NEXT_TO_ZERO else 1.0)

    def weights(self, lengths: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """Return lengths rounded up, at least 1, so that no cycle is free."""
        return np.maximum(np.ceil(lengths / self.quantum), 1.0).astype(np.int64)

    def bounds(self, distances: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """Return lower bounds, rounded down by a little more than the rounding of a distance."""
        within = np.minimum(distances, self.quantum * MOST)
        least = np.floor(within / self.quantum * (1.0 - 2.0**-45)) - 2.0
        return np.clip(least, 0.0, float(MOST)).astype(np.int64)
