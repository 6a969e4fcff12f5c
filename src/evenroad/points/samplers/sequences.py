"""Halton's and Sobol's sequences, plain or scrambled, from any start index (engines: scipy.stats.qmc)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.sampler import Symmetry

SOBOL_LENGTH = 2**30
"""How many distinct points SciPy's Sobol engine has at its default 30 bits."""


@dataclass(frozen=True)
class _Sequence:
    scramble: bool = True
    start: int = 0
    name = ""
    any_n = True
    # Known for their star discrepancy, which sees only the corner at the origin.
    symmetries = frozenset({Symmetry.PERMUTATION})

    def __post_init__(self) -> None:
        require_count("start", self.start, at_least=0)

    def _set(self, points: npt.NDArray[Any], rng: RngLike) -> PointSet:
        method, seed = ("scrambled", seed_of(rng)) if self.scramble else ("plain", None)
        return PointSet(points, Origin(family=self.name, method=method, seed=seed, start=self.start))


@dataclass(frozen=True)
class Halton(_Sequence):
    """Halton's sequence in the first d prime bases (Halton 1960).

    Parameters
    ----------
    scramble : bool
        Random digit permutations (Owen 2017) drawn from `rng`; else the plain sequence, which ignores `rng`.
    start : int
        Index of the first point, >= 0.  Index 0 of the plain sequence is the origin of the cube.
    """

    name = "halton"
    about = "Halton, randomly permuted digits, or plain"

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return points start .. start + n - 1 of the sequence, shape (n, d); see :class:`~evenroad.points.Sampler`."""
        # Here, because it takes half a second to import: only those who ask for a sequence pay for it.
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
        from scipy.stats import qmc

        n, d = require_count("n", n), require_count("d", d)
        if self.start + n > SOBOL_LENGTH:
            raise InvalidValue(f"the Sobol sequence ends at index {SOBOL_LENGTH}, asked for {self.start + n}")
        if d > qmc.Sobol.MAXDIM:
            raise InvalidValue(f"d must be at most {qmc.Sobol.MAXDIM} for Sobol points, got {d}")
        engine = qmc.Sobol(d, scramble=self.scramble, rng=generator(rng))
        if self.start:
            engine.fast_forward(self.start)
            return self._set(engine.random(n), rng)
        # From index 0 SciPy warns unless n is a power of two; users of a roadmap choose n freely.
        return self._set(engine.random_base2((n - 1).bit_length())[:n], rng)
