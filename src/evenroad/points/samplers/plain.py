"""Baseline samplers: independent points, a grid, Halton's and Sobol's sequences."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import ALL_SYMMETRIES, Symmetry
from evenroad.points.sobol import scrambled_sobol, table_of_scipy

SOBOL_LENGTH, SOBOL_DIMENSIONS = 2**30, 21201
"""Number of distinct points of SciPy's Sobol engine at its default 30 bits, and of axes with direction numbers."""


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

    With `allow_fewer`, an n that is no k^d gives the largest grid of at most n points; else it is refused.
    """

    allow_fewer: bool = False
    name = "sukharev"
    about = "the grid of k^d cell centres; always the same set"
    any_n = False
    # Symmetries of the cube; a shift would move the cells off the faces.
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
                f" {k**d} and {(k + 1) ** d} (or allow_fewer)"
            )
        # The digits of the row number in base k are the row's cell; for k = 1 all are 0, whatever d.
        weight = k ** np.arange(d - 1, -1, -1, dtype=np.int64) if k > 1 else np.ones(d, dtype=np.int64)
        digits = np.arange(k**d)[:, np.newaxis] // weight % k
        return PointSet((digits + 0.5) / k, Origin(family=self.name, method="grid"))


def _floor_root(n: int, d: int) -> int:
    """Return the largest integer k with k**d <= n < 2**31: the float root is off by far less than one half."""
    nearest: int = round(n ** (1.0 / d))
    return nearest - int(nearest**d > n)


@dataclass(frozen=True)
class _Sequence:
    scramble: bool = True
    start: int = 0
    name = ""
    any_n = True
    # These sequences are known for their star discrepancy, which depends on the corner at the origin.
    symmetries = frozenset({Symmetry.PERMUTATION})

    def __post_init__(self) -> None:
        require_count("start", self.start, at_least=0)

    def _set(self, points: Floats, rng: RngLike) -> PointSet:
        method, seed = ("scrambled", seed_of(rng)) if self.scramble else ("plain", None)
        return PointSet(points, Origin(family=self.name, method=method, seed=seed, start=self.start))


@dataclass(frozen=True)
class Halton(_Sequence):
    """Halton's sequence in the first d prime bases (Halton 1960), from the index `start` >= 0 on.

    With `scramble`, digits are permuted at random (Owen 2017), from `rng`.  The plain sequence ignores `rng`, and its
    index 0 is the origin of the cube.
    """

    name = "halton"
    about = "Halton, randomly permuted digits, or plain"

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return points start .. start + n - 1 of the sequence, shape (n, d); see :class:`~evenroad.points.Sampler`."""
        # Imported late: it takes half a second.
        from scipy.stats import qmc

        n, d = require_count("n", n), require_count("d", d)
        engine = qmc.Halton(d, scramble=self.scramble, rng=generator(rng))
        if self.start:
            engine.fast_forward(self.start)
        return self._set(engine.random(n), rng)


@dataclass(frozen=True)
class Sobol(_Sequence):
    """Sobol's sequence with the direction numbers of Joe and Kuo (2008); parameters as for :class:`Halton`.

    The scramble is a linear matrix scramble with a digital shift (Matousek 1998).
    """

    name = "sobol"
    about = "Sobol, scrambled, or plain"

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return points start .. start + n - 1 of the sequence, shape (n, d); see :class:`~evenroad.points.Sampler`.

        Raises InvalidValue also if start + n exceeds 2**30, or d the 21201 dimensions of the direction numbers.
        """
        n, d = require_count("n", n), require_count("d", d)
        if self.start + n > SOBOL_LENGTH:
            raise InvalidValue(f"the Sobol sequence ends at index {SOBOL_LENGTH}, asked for {self.start + n}")
        if d > SOBOL_DIMENSIONS:
            raise InvalidValue(f"d must be at most {SOBOL_DIMENSIONS} for Sobol points, got {d}")
        if self.scramble and not self.start and table_of_scipy().is_file():
            # SciPy spawns a generator that it is given.
            return self._set(scrambled_sobol(n, d, generator(rng).spawn(1)[0]), rng)
        from scipy.stats import qmc

        engine = qmc.Sobol(d, scramble=self.scramble, rng=generator(rng))
        if self.start:
            engine.fast_forward(self.start)
            return self._set(engine.random(n), rng)
        # From index 0 SciPy warns unless n is a power of two.
        return self._set(engine.random_base2((n - 1).bit_length())[:n], rng)
