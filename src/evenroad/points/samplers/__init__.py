"""Samplers behind one interface, by name: the one list from which all others come."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.bank import TRAINED_FAMILIES, Trained
from evenroad.points.pointset import PointSet
from evenroad.points.sampler import KnownSampler as KnownSampler
from evenroad.points.sampler import Sampler as Sampler
from evenroad.points.samplers.korobov import Even as Even
from evenroad.points.samplers.korobov import Korobov as Korobov
from evenroad.points.samplers.lattice import Lattice as Lattice
from evenroad.points.samplers.plain import Sukharev as Sukharev
from evenroad.points.samplers.plain import Uniform as Uniform
from evenroad.points.samplers.sequences import Halton as Halton
from evenroad.points.samplers.sequences import Sobol as Sobol

SAMPLERS: dict[str, Callable[..., KnownSampler]] = {
    each.name: each for each in (Even, Korobov, Lattice, Halton, Sobol, Sukharev, Uniform)
} | {family: partial(Trained, family) for family in TRAINED_FAMILIES}
"""Name -> how to make the sampler from its options; without any it says what it is, and what keeps its sets even."""


def make_sampler(name: str, **options: Any) -> KnownSampler:
    """Return the sampler of this name, one of :data:`SAMPLERS`, with its own parameters as options.

    Raises UnknownName, which lists the samplers, if there is none of this name; InvalidValue if it does not take an
    option.
    """
    if not isinstance(name, str) or name not in SAMPLERS:
        raise UnknownName.among("sampler", name, SAMPLERS)
    try:
        return SAMPLERS[name](**options)
    except TypeError as error:
        raise InvalidValue(f"sampler {name!r} does not take these options: {error}") from None


def draw(name: str, n: int, d: int, *, rng: RngLike = 0, **options: Any) -> PointSet:
    """Draw n points in d dimensions from the sampler of this name: ``make_sampler(...).draw(...)``.

    Examples
    --------
    >>> from evenroad.points import draw
    >>> draw("uniform", 3, 2, rng=1).points.shape
    (3, 2)
    """
    return make_sampler(name, **options).draw(n, d, rng=rng)
