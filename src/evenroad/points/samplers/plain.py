"""Independent uniform points and Sukharev's grid: what every other sampler is compared with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import NotAvailable
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.sampler import ALL_SYMMETRIES, Symmetry


@dataclass(frozen=True)
class Uniform:
    """Independent points, uniform on the cube (PCG64)."""

    name = "uniform"
    about = "independent points"
    any_n = True
    symmetries = ALL_SYMMETRIES

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n independent points, shape (n, d); see :class:`~evenroad.points.Sampler`."""
        n, d = require_count("n", n), require_count("d", d)
        origin = Origin(family=self.name, method="independent", seed=seed_of(rng))
        return PointSet(generator(rng).random((n, d)), origin)


@dataclass(frozen=True)
class Sukharev:
    """The grid of smallest l_inf dispersion among k^d points (Sukharev 1971).

    With `allow_fewer` an n that is no k^d gives the largest grid with at most n points, instead of being refused.
    """

    allow_fewer: bool = False
    name = "sukharev"
    about = "the grid of k^d cell centres; always the same set"
    any_n = False
    # Those of the cube; a shift would move its cells off the faces.
    symmetries = frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION})

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return the k^d cell centres ((i + 1/2) / k per axis), first axis slowest; `rng` is not used.

        Raises NotAvailable if n is no k^d and `allow_fewer` is off; the text names the two nearest.
        """
        n, d = require_count("n", n), require_count("d", d)
        k = _floor_root(n, d)
        if k**d != n and not self.allow_fewer:
            raise NotAvailable(
                f"a Sukharev grid in d={d} has k^{d} points: n={n} is none, the nearest are"
                f" {k**d} and {(k + 1) ** d} (or allow fewer)"
            )
        # The digits of the row number in base k are the row's cell; for k = 1 all are 0, whatever d.
        place = k ** np.arange(d - 1, -1, -1, dtype=np.int64) if k > 1 else np.ones(d, dtype=np.int64)
        digits = np.arange(k**d)[:, np.newaxis] // place % k
        return PointSet((digits + 0.5) / k, Origin(family=self.name, method="grid"))


def _floor_root(n: int, d: int) -> int:
    """Return the largest integer k with k**d <= n, without trusting the float root."""
    low, high = 1, 1 << (n.bit_length() // d + 1)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if middle**d <= n else (low, middle)
    return low
