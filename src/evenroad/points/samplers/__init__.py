"""Samplers behind one interface, and the list of them by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from inspect import signature
from typing import Protocol

from evenroad._call import explains_calls
from evenroad._hints import unknown_keyword
from evenroad._rng import RngLike
from evenroad.errors import UnknownName
from evenroad.points.bank import TRAINED_FAMILIES, Trained
from evenroad.points.bank.star import Star as Star
from evenroad.points.pointset import PointSet, below_one
from evenroad.points.randomise import Symmetry
from evenroad.points.samplers.even import Even as Even
from evenroad.points.samplers.growing import Growing as Growing
from evenroad.points.samplers.korobov import Korobov as Korobov
from evenroad.points.samplers.lattice import Cover as Cover
from evenroad.points.samplers.lattice import Lattice as Lattice
from evenroad.points.samplers.plain import Halton as Halton
from evenroad.points.samplers.plain import Sobol as Sobol
from evenroad.points.samplers.plain import Sukharev as Sukharev
from evenroad.points.samplers.plain import Uniform as Uniform


class Sampler(Protocol):
    """Draws sets of n points in d dimensions; the same arguments give the same bits on one kind of processor."""

    @property
    def name(self) -> str:
        """Name of the sampler."""

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n >= 1 points of [0, 1)^d, d >= 1, with their origin; a Generator is spawned.

        Raises InvalidValue for another n, d or rng, or beyond the sampler's limits; NotAvailable if it has no such set.
        """


class NamedSampler(Sampler, Protocol):
    """A sampler of the list, which describes itself."""

    @property
    def about(self) -> str:
        """Description in one line."""

    @property
    def any_n(self) -> bool:
        """Whether it has a set of every n."""

    @property
    def symmetries(self) -> frozenset[Symmetry]:
        """Transformations that keep the quality of its sets."""


SAMPLERS: dict[str, Callable[..., NamedSampler]] = {
    each.name: each for each in (Even, Growing, Korobov, Lattice, Cover, Halton, Sobol, Star, Sukharev, Uniform)
} | {family: partial(Trained, family) for family in TRAINED_FAMILIES}
"""Name -> constructor of a sampler from its options."""

ALIASES = {"random": "uniform"}
"""Other names of samplers."""


def make_sampler(name: str, **options: object) -> NamedSampler:
    """Return the sampler of this name, one of :data:`SAMPLERS`, with its options; UnknownName for an unknown one."""
    known = ALIASES.get(name, name) if isinstance(name, str) else None
    if known not in SAMPLERS:
        raise UnknownName.among("sampler", name, SAMPLERS)
    taken = {*signature(SAMPLERS[known]).parameters, "rng"}
    for option in options:
        if option not in taken:
            raise unknown_keyword(f"option of sampler {name!r}", option, taken)
    return SAMPLERS[known](**options)


@explains_calls
def draw(name: str, n: int, d: int, *, rng: RngLike = 0, **options: object) -> PointSet:
    """Draw a set of points in the unit cube.

    Parameters
    ----------
    name : str
        A sampler: ``even``, ``sobol``, ``halton``, ``uniform`` (also ``random``), ...; `evenroad points` lists them.
    n, d : int
        Number of points and dimension, >= 1.
    rng : int, SeedSequence or Generator
        Equal numbers give equal points; a Generator is spawned.
    **options
        Options of the sampler, such as ``scramble=False`` of ``sobol``.

    Returns
    -------
    PointSet

    Raises
    ------
    UnknownName
        For an unknown sampler or option.
    InvalidValue
        If `n`, `d` or `rng` is of another kind.
    NotAvailable
        If the sampler has no set of this size.

    Examples
    --------
    >>> import evenroad as er
    >>> er.draw("even", 512, 6, rng=0).points.shape
    (512, 6)
    """
    drawn = make_sampler(name, **options).draw(n, d, rng=rng)
    points = below_one(drawn.points)
    return drawn if points is drawn.points else PointSet(points, drawn.origin)
