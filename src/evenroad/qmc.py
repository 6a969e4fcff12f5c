"""Our samplers as engines of ``scipy.stats.qmc``: sequences, and finite sets point by point.

>>> from evenroad.qmc import Growing, Korobov
>>> Growing(d=3, rng=1).random(10).shape
(10, 3)
>>> Korobov(d=3, n=64, rng=1).random(10).shape
(10, 3)

``evenroad.qmc`` can replace ``scipy.stats.qmc``: it has SciPy's engines, measures and `scale`, too.  Threads may share
an engine: it returns each point once, in order.
"""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from scipy.stats.qmc import Halton as Halton
from scipy.stats.qmc import LatinHypercube as LatinHypercube
from scipy.stats.qmc import MultinomialQMC as MultinomialQMC
from scipy.stats.qmc import MultivariateNormalQMC as MultivariateNormalQMC
from scipy.stats.qmc import PoissonDisk as PoissonDisk
from scipy.stats.qmc import QMCEngine as QMCEngine
from scipy.stats.qmc import Sobol as Sobol
from scipy.stats.qmc import discrepancy as discrepancy
from scipy.stats.qmc import geometric_discrepancy as geometric_discrepancy
from scipy.stats.qmc import scale as scale
from scipy.stats.qmc import update_discrepancy as update_discrepancy

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad._shared import OwnLock
from evenroad.errors import Exhausted, InvalidValue
from evenroad.points.pointset import PointSet, below_one
from evenroad.points.randomise import randomise
from evenroad.points.samplers import make_sampler
from evenroad.points.samplers.growing import LONGEST


def _started(given: RngLike | None, old: RngLike | None) -> np.random.Generator:
    """Return the generator of an engine; `old` is `seed`, SciPy's old keyword."""
    if given is not None and old is not None:
        raise InvalidValue("give rng or seed, its old name, but not both")
    rng = given if given is not None else old
    return np.random.default_rng() if rng is None else generator(rng)


class _SharedEngine(QMCEngine):  # type: ignore[misc]
    """An engine that returns each point once, in any thread."""

    _lock: OwnLock

    def __repr__(self) -> str:
        return f"{type(self).__name__}(d={self.d}, num_generated={self.num_generated})"

    def random(self, n: object = 1, *, workers: object = 1) -> Floats:
        """Return the next points.

        Parameters
        ----------
        n : int
            Number of points, >= 0.
        workers : int
            SciPy's; not used.

        Returns
        -------
        ndarray, shape (n, d)

        Raises
        ------
        Exhausted
            If fewer are left.

        Examples
        --------
        >>> import evenroad as er
        >>> er.qmc.Even(d=2, n=16, rng=0).random(4).shape
        (4, 2)
        """
        with self._lock:
            return np.asarray(super().random(n, workers=workers))

    def reset(self) -> Self:
        """Start again."""
        with self._lock:
            super().reset()
        return self

    def fast_forward(self, n: object) -> Self:
        """Skip points.

        Parameters
        ----------
        n : int
            Number of points, >= 0.

        Returns
        -------
        QMCEngine

        Raises
        ------
        Exhausted
            If fewer are left.

        Examples
        --------
        >>> import evenroad as er
        >>> er.qmc.Growing(d=2, rng=0).fast_forward(4)
        Growing(d=2, num_generated=4)
        """
        with self._lock:
            self.num_generated += self._count(n)
            return self

    def _count(self, n: object) -> int:
        """Return the number of points, or raise Exhausted if fewer are left."""
        raise NotImplementedError


@explains_calls
class SequenceEngine(_SharedEngine):
    """An engine over a sequence; a subclass names the ``family``, a sampler that takes ``start``.

    Points are those of ``draw(family, n, d, rng=rng, start=num_generated)``, up to 2**30.

    Parameters
    ----------
    d : int
        Dimension, >= 1.
    optimization : {"random-cd", "lloyd"}, optional
        SciPy's optimisation of the points that ``random`` returns.
    rng : int, SeedSequence or Generator, optional
        None: fresh entropy, as in SciPy; a Generator is spawned.
    seed
        SciPy's old name of `rng`.

    Raises
    ------
    InvalidValue
        If `d` or `rng` is of another kind.

    Examples
    --------
    >>> import evenroad as er
    >>> er.qmc.Growing(d=3, rng=1).random(10).shape
    (10, 3)
    """

    family: ClassVar[str]

    def __init__(
        self,
        d: int,
        *,
        optimization: Literal["random-cd", "lloyd"] | None = None,
        rng: RngLike | None = None,
        seed: RngLike | None = None,
    ) -> None:
        d = require_count("d", d)
        given = rng if rng is not None else seed
        random = _started(rng, seed)
        self._lock = OwnLock()
        super().__init__(d=d, optimization=optimization, rng=random)
        self._init_quad = {"d": d, "optimization": optimization}
        # The same for every call; an int stays, so that the points are those of `draw`.
        is_seed = given is not None and not isinstance(given, np.random.Generator | np.random.RandomState)
        self._drawn_with: RngLike = given if is_seed else int(self.rng.integers(2**62))  # type: ignore[assignment]

    def _random(self, n: object = 1, *, workers: object = 1) -> Floats:
        """Return the next n points, (n, d), which SciPy's ``random`` counts; raises Exhausted past the end."""
        count = self._count(n)
        if count == 0:
            return np.empty((0, self.d))
        sampler = make_sampler(self.family, start=self.num_generated)
        return below_one(sampler.draw(count, self.d, rng=self._drawn_with).points).copy()

    def _count(self, n: object) -> int:
        count = require_count("n", n, at_least=0)
        if self.num_generated + count > LONGEST:
            left = LONGEST - self.num_generated
            raise Exhausted(f"asked for {count} more points, but the sequence ends {left} points on")
        return count


@explains_calls
class FamilyEngine(_SharedEngine):
    """An engine over one set of points; a subclass names the ``family``, any sampler.

    The set, ``points``, is drawn and randomised.  It is even as a whole, but its first points alone are not: choose the
    `n` that you will use, or a :class:`Growing` sequence.

    Parameters
    ----------
    d, n : int
        Dimension and size of the set, >= 1.
    optimization, rng, seed
        As of :class:`SequenceEngine`; `optimization` changes the set.
    **options
        Options of the sampler.

    Raises
    ------
    NotAvailable
        If the family has no such set.
    InvalidValue, UnknownName
        For a wrong value, or an unknown option.

    Examples
    --------
    >>> import evenroad as er
    >>> er.qmc.Even(d=2, n=64, rng=0).random(64).shape
    (64, 2)
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
        **options: object,
    ) -> None:
        d, self.n = require_count("d", d), require_count("n", n)
        random = _started(rng, seed)
        self._lock = OwnLock()
        super().__init__(d=d, optimization=optimization, rng=random)
        # Arguments of further engines of qmc_quad.
        self._init_quad = {"d": d, "n": n, "optimization": optimization, **options}
        sampler = make_sampler(self.family, **options)
        drawn = sampler.draw(self.n, d, rng=self.rng)
        drawn = PointSet(below_one(drawn.points), drawn.origin)
        self.points: PointSet = randomise(drawn, sampler.symmetries, rng=self.rng)

    def _random(self, n: object = 1, *, workers: object = 1) -> Floats:
        """Return the next n points, (n, d), which SciPy's ``random`` counts; raises Exhausted if fewer are left."""
        return self.points.points[self.num_generated :][: self._count(n)].copy()

    def _count(self, n: object) -> int:
        count, left = require_count("n", n, at_least=0), self.n - self.num_generated
        if count > left:
            text = f"asked for {count} more points, but {left} of the {self.n} are left: a set has an end; "
            raise Exhausted(text + "make an engine with a larger n, or reset() to start again")
        return count


class Growing(SequenceEngine):
    """An extensible lattice: every beginning is well spread.  Any d, 2**30 points."""

    family = "growing"


class Even(FamilyEngine):
    """Sets for roadmaps: lattices of any n and d, whose points are far apart.

    For integrals and designs of experiments take :class:`Hickernell`, or SciPy's :class:`Sobol` beyond its bank.  There
    the errors of `Even` are up to 20 times larger: ``studies/docs/other-uses.md`` has the ratios.
    """

    family = "even"


class Hickernell(FamilyEngine):
    """Sets annealed for the Hickernell L2 discrepancy: for integrals and designs of experiments."""

    family = "hickernell"


class Korobov(FamilyEngine):
    """Rank-1 lattices of smallest periodic Riesz energy, any n and d; for roadmaps, as :class:`Even`."""

    family = "korobov"


class Lattice(FamilyEngine):
    """A_d* lattices, rotated and shifted at random, d <= 12."""

    family = "lattice"
