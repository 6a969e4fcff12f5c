"""Samplers of a benchmark: by name, which set run number i of a cell gets."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np

from evenroad._checks import require_known
from evenroad._rng import RngLike
from evenroad.errors import NotAvailable, UnknownName
from evenroad.points import PointSet, draw, make_sampler
from evenroad.points.bank import Bank
from evenroad.points.randomise import Symmetry, randomise
from evenroad.points.samplers import Halton, Sobol
from evenroad.points.samplers.lattice import MAX_D
from evenroad.roadmap import Rule
from evenroad.roadmap.points_of import even_points
from evenroad.space import Space

PERMUTED_FROM = 5
"""From this dimension on, a set whose coordinates are permuted anew counts as another set; below, there are too few
orders of the coordinates."""
STRETCH = 32
"""Runs of a block protocol whose points are generated together."""
Drawn = tuple[PointSet, str]
Use = tuple[Space, Rule]
"""The space and the rule that a set is for: what `even` is depends on them."""


class RunSampler(NamedTuple):
    """How the set of a run is drawn, from points of the sampler `family`.

    `draw` goes from (family, n, d, run, rng, use) to the set and its `set_id`; `why_not` from (family, n, d) to why
    there is no such set, one sentence, "" if there is one; `protocol` is what lists say of the draw, beside what the
    sampler says of itself.
    """

    family: str
    draw: Callable[[str, int, int, int, np.random.Generator, Use | None], Drawn]
    why_not: Callable[[str, int, int], str]
    protocol: str = ""

    @property
    def about(self) -> str:
        """One line for lists and tables."""
        return "; ".join(filter(None, (make_sampler(self.family).about, self.protocol)))


def draw_set(name: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None = None) -> Drawn:
    """Draw the set of one run, (n, d), and say which one of its pool it is, as `set_id` of an outcome.

    `rng` is spawned; block protocols go by the number `run`, from 0, instead.  `use` is what the set is for, unless it
    gives only some coordinates of a space.  Raises NotAvailable if there is no such set: nothing is ever trained for a
    benchmark.
    """
    reason = why_not(name, n, d)
    if reason:
        raise NotAvailable(reason)
    sampler = SAMPLERS[name]
    return sampler.draw(sampler.family, n, d, run, rng, use)


def why_not(name: str, n: int, d: int) -> str:
    """Return why a sampler has no set of n points in d dimensions, or "" if it has; UnknownName as `draw_set`."""
    require_known("sampler", name, SAMPLERS)
    return SAMPLERS[name].why_not(SAMPLERS[name].family, n, d)


def _fresh(family: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None) -> Drawn:
    return draw(family, n, d, rng=rng), ""


def _block(family: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None) -> Drawn:
    stretch = _stretch(family, n, d, run // STRETCH)
    first = run % STRETCH * n
    block = PointSet(stretch.points[first : first + n], stretch.origin)
    return block.with_origin(start=stretch.origin.start + first), ""


@lru_cache(maxsize=4)
def _stretch(family: str, n: int, d: int, number: int) -> PointSet:
    """Return the blocks of many runs at once: SciPy's Halton engine generates all the points that it skips."""
    sequence = Halton if family == "halton" else Sobol
    return sequence(scramble=False, start=number * STRETCH * n + 1).draw(STRETCH * n, d)


def _grid(family: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None) -> Drawn:
    return draw(family, n, d), "grid"


def _from_pool(family: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None) -> Drawn:
    choice, order = rng.spawn(2)
    points = draw(family, n, d, rng=choice)
    if d >= PERMUTED_FROM:
        points = randomise(points, {Symmetry.PERMUTATION}, rng=order)
    return points, str(points.origin.replica)


def _even(family: str, n: int, d: int, run: int, rng: np.random.Generator, use: Use | None) -> Drawn:
    # Of two spawned generators the first, as from a pool: so rows of an `even` that was one keep their bits.
    choice = rng.spawn(2)[0]
    points = _even_of(family, n, d, choice, use)
    if "scrambled" in points.origin.method:
        # The scramble of Sobol's own row, so that no difference from it is chance.
        points = _even_of(family, n, d, _unspent(choice), use)
    return points, ""


def _even_of(family: str, n: int, d: int, rng: RngLike, use: Use | None) -> PointSet:
    return draw(family, n, d, rng=rng) if use is None else even_points(n, *use, rng=rng)


def _unspent(generator: np.random.Generator) -> np.random.SeedSequence:
    """Return the seeds of a generator as they were before it was spawned."""
    seeds = generator.bit_generator.seed_seq
    assert isinstance(seeds, np.random.SeedSequence)
    return np.random.SeedSequence(seeds.entropy, spawn_key=seeds.spawn_key)


def _always(family: str, n: int, d: int) -> str:
    return ""


def _lattice_exists(family: str, n: int, d: int) -> str:
    return f"the lattice sampler goes up to d = {MAX_D}" if d > MAX_D else ""


def _exists(ask: Callable[[str, int, int], object], family: str, n: int, d: int) -> str:
    try:
        ask(family, n, d)
    except (NotAvailable, UnknownName) as error:
        return str(error).removesuffix(" (or allow_fewer)")
    return ""


_grid_exists = partial(_exists, draw)
_pool_exists = partial(_exists, Bank().cell)


_BLOCKS = "plain: run i takes the points i N + 1 .. (i + 1) N"

SAMPLERS: dict[str, RunSampler] = {
    "uniform": RunSampler("uniform", _fresh, _always),
    "halton paper-blocks": RunSampler("halton", _block, _always, _BLOCKS),
    "halton scrambled": RunSampler("halton", _fresh, _always, "permuted anew in each run"),
    "sobol paper-blocks": RunSampler("sobol", _block, _always, _BLOCKS),
    "sobol scrambled": RunSampler("sobol", _fresh, _always, "scrambled anew in each run, from index 0"),
    "lattice": RunSampler("lattice", _fresh, _lattice_exists),
    "sukharev": RunSampler("sukharev", _grid, _grid_exists),
    "mpmc": RunSampler("mpmc", _from_pool, _pool_exists),
    "hickernell": RunSampler("hickernell", _from_pool, _pool_exists),
    "even": RunSampler("even", _even, _always, "what a planner takes for the space and the rule"),
}
"""Name -> how the set of a run is drawn, in the order of tables."""
