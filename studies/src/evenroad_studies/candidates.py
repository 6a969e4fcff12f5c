"""Sets that could be the default: what evenroad draws, and what it does not, each by its name.

``centroidal``: points in the centroids of their Voronoi cells, by Lloyd's steps over random samples.  ``holes``: the
same with the cells' far samples weighted, so that the largest hole shrinks (Lloyd for the 8th moment instead of the
second).  ``farthest``: greedy farthest points of a random pool, on the torus.  ``poisson``: what is left of five times
as many random points when the most crowded go one by one, on the torus (Yuksel 2015).  ``projected``: a trained set of
ten dimensions on its best axes.  ``rank one``: a rank-1 lattice with good projections, its axes in random order, which
with A_d* was `even` from four dimensions on.  ``ordered``: the first points of a trained set of 1024 in greedy order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, partial

import numpy as np
from scipy.spatial import cKDTree

from evenroad._arrays import Floats, Ints
from evenroad.points import draw, greedy_order, project
from evenroad.points.pointset import PointSet
from evenroad.points.randomise import Symmetry, randomise
from evenroad.points.samplers.korobov import shifted_lattice
from evenroad.points.samplers.rank_one import rank_one_vector

POOL = 8
"""Sets of a slow candidate; from world to world their axes are mirrored and in another order."""

SAMPLES, STEPS = 16, 20
"""Random samples for each point in a step of Lloyd's, and steps."""

Draw = Callable[[int, int, int], Floats]
"""From n, d and the number of a world to points (n, d)."""


def voronoi(power: float, n: int, d: int, seed: int) -> Floats:
    """Return points that make the mean power of the distance from the nearest point small, (n, d)."""
    rng = np.random.default_rng([seed, n, d])
    points = draw("sobol", n, d, rng=rng).points.copy()
    for _ in range(STEPS):
        samples = rng.random((SAMPLES * n, d))
        gaps, own = cKDTree(points).query(samples) if d <= 6 else _nearest(samples, points)
        weights = gaps ** (power - 2.0)
        total = np.bincount(own, weights, minlength=n)
        for k in range(d):
            moved = np.bincount(own, weights * samples[:, k], minlength=n)
            points[:, k] = np.where(total > 0.0, moved / np.maximum(total, 1e-300), points[:, k])
    return points


def _nearest(samples: Floats, points: Floats) -> tuple[Floats, Ints]:
    """Return the distances from the nearest points and their numbers: in many dimensions faster than a tree."""
    own = np.empty(len(samples), dtype=np.int64)
    half, transposed = 0.5 * (points**2).sum(axis=1).astype(np.float32), points.T.astype(np.float32)
    for first in range(0, len(samples), 512):
        some = slice(first, first + 512)
        own[some] = (half - samples[some].astype(np.float32) @ transposed).argmin(axis=1)
    return np.sqrt(((samples - points[own]) ** 2).sum(axis=1)), own


def farthest(n: int, d: int, seed: int) -> Floats:
    """Return greedy farthest points of a pool of 16 n, on the torus, (n, d)."""
    rng = np.random.default_rng([seed, n, d])
    pool = rng.random((16 * n, d))
    chosen, gaps = [0], np.full(len(pool), np.inf)
    while True:
        step = np.abs(pool - pool[chosen[-1]])
        step = np.minimum(step, 1.0 - step)
        gaps = np.minimum(gaps, (step * step).sum(axis=1))
        if len(chosen) == n:
            return np.asarray(pool[chosen])
        chosen.append(int(gaps.argmax()))


def poisson(n: int, d: int, seed: int) -> Floats:
    """Return the least crowded n of 5 n random points, on the torus, (n, d)."""
    rng = np.random.default_rng([seed, n, d])
    pool = rng.random((5 * n, d))
    squared = np.zeros((len(pool), len(pool)))
    for k in range(d):
        step = np.abs(pool[:, k, np.newaxis] - pool[:, k])
        squared += np.minimum(step, 1.0 - step) ** 2
    np.fill_diagonal(squared, np.inf)
    # Twice the mean distance of the nearest of n points: whatever is beyond does not crowd.
    reach = 2.0 * np.sqrt(squared.min(axis=1)).mean() * 5.0 ** (1.0 / d)
    crowd = np.maximum(1.0 - np.sqrt(squared) / reach, 0.0) ** 8
    load, kept = crowd.sum(axis=1), np.ones(len(pool), dtype=bool)
    for _ in range(len(pool) - n):
        worst = int(np.where(kept, load, -1.0).argmax())
        kept[worst] = False
        load -= crowd[worst]
    return np.asarray(pool[kept])


@lru_cache(maxsize=512)
def _kept(make: Draw, n: int, d: int, number: int) -> PointSet:
    return PointSet(make(n, d, number))


def _pooled(make: Draw, n: int, d: int, world: int) -> Floats:
    symmetries = {Symmetry.PERMUTATION, Symmetry.REFLECTION}
    return randomise(_kept(make, n, d, world % POOL), symmetries, rng=world).points


def _drawn(name: str, n: int, d: int, world: int) -> Floats:
    return draw(name, n, d, rng=world).points


def _from_bank(name: str, n: int, d: int, world: int) -> Floats:
    return randomise(draw(name, n, d, rng=world % POOL), {Symmetry.PERMUTATION}, rng=world).points


def inset(share: float, make: Draw, n: int, d: int, world: int) -> Floats:
    """Return points drawn in to the middle by a share."""
    return 0.5 + share * (make(n, d, world) - 0.5)


def projected(n: int, d: int, seed: int) -> Floats:
    """Return the projection of a trained set of ten dimensions, (n, d), d <= 10."""
    return project(draw("hickernell", n, 10, rng=seed), d).points


def ordered(n: int, d: int, seed: int) -> Floats:
    """Return the first points of a trained set of 1024 in greedy order, (n, d)."""
    return greedy_order(draw("hickernell", 1024, d, rng=seed)).points[:n].copy()


def rank_one(n: int, d: int, world: int) -> Floats:
    """Return a rank-1 lattice with good projections, shifted, its axes in random order, (n, d)."""
    random = np.random.default_rng([world, n, d])
    vector = random.permutation(np.array(rank_one_vector(n, d)))
    return shifted_lattice(n, vector.tolist(), random.random(d))


_SLOW: Mapping[str, Draw] = {
    "centroidal": partial(voronoi, 2.0),
    "holes": partial(voronoi, 8.0),
    "farthest": farthest,
    "poisson": poisson,
    "lattice": partial(_drawn, "lattice"),
    "projected": projected,
    "ordered": ordered,
}
CANDIDATES: dict[str, Draw] = {
    **{name: partial(_drawn, name) for name in ("even", "korobov", "sobol", "halton", "growing", "uniform")},
    "rank one": rank_one,
    **{name: partial(_from_bank, name) for name in ("hickernell", "mpmc")},
    **{name: partial(_pooled, make) for name, make in _SLOW.items()},
}
"""Name -> how the set of a world is drawn."""
CANDIDATES |= {
    f"{name} {share:g}": partial(inset, share, CANDIDATES[name])
    for name in ("korobov", "lattice", "sobol", "hickernell", "rank one")
    for share in (0.97, 0.95, 0.94, 0.9, 0.85)
}
