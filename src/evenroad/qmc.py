"""Our families as engines of ``scipy.stats.qmc``: finite sets that are handed out point by point.

>>> from evenroad.qmc import Korobov
>>> Korobov(d=3, n=64, rng=1).random(10).shape
(10, 3)
"""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import numpy as np
from scipy.stats.qmc import QMCEngine

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import Exhausted, InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.points.randomise import randomise
from evenroad.points.samplers import make_sampler


class FamilyEngine(QMCEngine):
    """An engine over one set of a family; a subclass names the ``family``, any name of ``SAMPLERS``.

    The set, ``points``, is drawn from the family and then randomised by every move that keeps its quality
    (:func:`evenroad.points.randomise.randomise`).  ``random`` hands its points out in their order and raises
    Exhausted when fewer are left than asked for.  A set is even as a whole, but its first points alone are
    not, those of a lattice least of all: choose as n what you will use.

    `d` and `n`, >= 1, are dimension and size of the set; NotAvailable is raised if the family has none.  SciPy's
    `optimization` of what ``random`` returns does not keep what the set was made for.  An `rng` of None takes fresh
    entropy, as everywhere in SciPy; a Generator is spawned, and `seed` is SciPy's old name.  Other options are the
    sampler's own, e.g. ``train=True`` of a trained family.
    """

    family: ClassVar[str]

    def __init__(
        self,
        d: int,
        *,
        n: int,
        optimization: Literal["random-cd", "lloyd"] | None = None,
        rng: RngLike | None = None,
        seed: RngLike | None = None,
        **options: Any,
    ) -> None:
        if rng is not None and seed is not None:
            raise InvalidValue("give rng or seed, its old name, but not both")
        given = rng if rng is not None else seed
        d, self.n = require_count("d", d), require_count("n", n)
        random = np.random.default_rng() if given is None else generator(given)
        super().__init__(d=d, optimization=optimization, rng=random)
        # What qmc_quad builds its further engines from.
        self._init_quad = {"d": d, "n": n, "optimization": optimization, **options}
        sampler = make_sampler(self.family, **options)
        drawn = sampler.draw(self.n, d, rng=self.rng)
        self.points: PointSet = randomise(drawn, sampler.symmetries, rng=self.rng)

    def fast_forward(self, n: object) -> FamilyEngine:
        """Skip the next n points; raises as :meth:`random` does."""
        self.num_generated = self._end_of_next(n)
        return self

    def _random(self, n: object = 1, *, workers: object = 1) -> Floats:
        """Return the next n points, (n, d), which SciPy's ``random`` counts; raises Exhausted if fewer are left."""
        return self.points.points[self.num_generated : self._end_of_next(n)].copy()

    def _end_of_next(self, n: object) -> int:
        """Return the index after the next n points, or raise Exhausted where there are not that many."""
        count, left = require_count("n", n, at_least=0), self.n - self.num_generated
        if count > left:
            text = f"asked for {count} more points, but {left} of the {self.n} are left: a set has an end; "
            raise Exhausted(text + "make an engine with a larger n, or reset() to start again")
        return self.num_generated + count


class Even(FamilyEngine):
    """Sets of the default family: the Korobov lattices, by the name that follows the default."""

    family = "even"


class Hickernell(FamilyEngine):
    """Sets annealed for the Hickernell L2 discrepancy."""

    family = "hickernell"


class Korobov(FamilyEngine):
    """Rank-1 lattices of smallest periodic Riesz energy, any n and d."""

    family = "korobov"


class Lattice(FamilyEngine):
    """A_d* lattices, rotated and shifted at random, d <= 12."""

    family = "lattice"
