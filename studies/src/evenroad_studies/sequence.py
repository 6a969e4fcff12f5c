"""A sequence whose every beginning has a lower discrepancy than scrambled Sobol's: their points, moved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.points.anneal import anneal
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry
from evenroad.points.samplers.plain import Sobol
from evenroad_studies.prefixes import SHORTEST, rooted_prefixes, worst_prefix

MEASURE = "hickernell"
TOGETHER = 512
"""Points that are moved together."""

BLOCKS = {1024: 1500, 2048: 800}
"""Ends of the blocks that are moved behind them, all points before held where they are, and steps of annealing."""

STEPS = 8000
STARTS = 64
"""Scrambles of which the best is moved."""

RATE, NOISE = 0.01, 0.3
"""First learning rate, in spacings n^(-1/d), and the noise over it."""

REFERENCES = 16
"""Scrambles of Sobol's sequence that say what is usual."""


@dataclass(frozen=True)
class Sequence:
    """Points `start` >= 0, `start` + 1, ... of scrambled Sobol points that were moved a little.

    The worst ratio of the Hickernell L2 discrepancy of a beginning to that of scrambled Sobol points is made small, for
    all beginnings of 8 points and more at once.  Points from index 2048 on are Sobol's as they are.  The sets of one
    seed begin with those of fewer points.  The first set of a seed takes half a minute, also a small one.
    """

    start: int = 0
    name = "sequence"
    about = "Sobol, scrambled and moved: every beginning of low discrepancy"
    any_n = True
    symmetries = frozenset({Symmetry.PERMUTATION})

    def __post_init__(self) -> None:
        require_count("start", self.start, at_least=0)

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return points start .. start + n - 1, shape (n, d); see :class:`~evenroad.points.Sampler`.

        Limits are those of :class:`Sobol`.
        """
        n, d = require_count("n", n), require_count("d", d)
        key, total = int(generator(rng).integers(2**62)), self.start + n
        length = next((end for end in (TOGETHER, *BLOCKS) if end >= total), max(BLOCKS))
        points = _moved(key, d, length)[self.start : total] if self.start < length else np.empty((0, d))
        if total > length:
            first = max(self.start, length)
            rest = Sobol(start=first).draw(total - first, d, rng=_scramble(key, d)).points
            points = np.concatenate([points, rest])
        method, seed = "Sobol, scrambled and moved", seed_of(rng)
        origin = Origin(family=self.name, method=method, objective=f"prefixes({MEASURE})", seed=seed, start=self.start)
        return PointSet(points, origin)


@lru_cache(maxsize=64)
def usual_prefixes(name: str, n: int, d: int) -> Floats:
    """Return the mean log of the rooted discrepancy of the first 1 .. n scrambled Sobol points, (n,)."""
    sets = [Sobol().draw(n, d, rng=scramble).points for scramble in range(REFERENCES)]
    usual: Floats = np.mean([np.log(np.maximum(rooted_prefixes(each, name), 1e-150)) for each in sets], axis=0)
    usual.setflags(write=False)
    return usual


@dataclass(frozen=True)
class _Behind:
    """The objective of a block of points behind others that are held."""

    held: Floats
    usual: Floats
    periodic = False
    least_points = 1

    def of_columns(self, columns: Floats) -> tuple[float, Floats]:
        fixed = self.held.shape[1]
        value, gradient = worst_prefix(MEASURE, np.hstack([self.held, columns]), self.usual, fixed)
        return value, np.ascontiguousarray(gradient[:, fixed:])


@lru_cache(maxsize=16)
def _moved(key: int, d: int, length: int) -> Floats:
    """Return the moved points of a seed, (length, d), read-only."""
    held = _moved(key, d, length // 2) if length in BLOCKS else np.empty((0, d))
    usual = usual_prefixes(MEASURE, length, d)
    start = np.clip(_sobol(key, d, length)[len(held) :], 1e-7, 1.0 - 1e-7)
    spacing = float(length ** (-1.0 / d))
    made = anneal(
        length - len(held),
        d,
        _Behind(np.ascontiguousarray(held.T), usual),
        steps=BLOCKS.get(length, STEPS),
        rng=np.random.default_rng([key, length]),
        start=start,
        rates=(RATE * spacing, NOISE),
    )
    points = np.concatenate([held, made.points])
    points.setflags(write=False)
    return points


def _sobol(key: int, d: int, n: int) -> Floats:
    """Return the first n points of the scramble of a seed that is moved, (n, d)."""
    return Sobol().draw(n, d, rng=_scramble(key, d)).points


@lru_cache(maxsize=256)
def _scramble(key: int, d: int) -> int:
    """Return the seed of the scramble whose worst beginning is the best of :data:`STARTS`."""
    usual, best = usual_prefixes(MEASURE, TOGETHER, d), (np.inf, 0)
    for scramble in np.random.default_rng(key).integers(2**62, size=STARTS).tolist():
        points = Sobol().draw(TOGETHER, d, rng=scramble).points
        above = np.log(rooted_prefixes(points, MEASURE)) - usual
        best = min(best, (float(above[2 * SHORTEST :].max()), scramble))
    return best[1]
