"""Many sets from one: random permutations, reflections and shifts that keep what a set is good at.

A transformation that would change what a set was made for is refused.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue, shown
from evenroad.points.measures import MEASURES
from evenroad.points.optimise import parse_objective
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.sampler import ALL_SYMMETRIES, Symmetry
from evenroad.points.samplers import SAMPLERS

LARGEST_COORDINATE = float(np.nextafter(1.0, 0.0))

ENERGY_SYMMETRIES = {
    "riesz": ALL_SYMMETRIES,
    "riesz_open": frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION}),
}
"""Of the energies; a discrepancy says it itself (``Measure.periodic``, ``Measure.reflectable``)."""


def symmetries_of_term(name: str) -> frozenset[Symmetry]:
    """Return what leaves the measure or energy of this name as it is.

    Coordinates have equal weights in an objective, so their order never matters.
    """
    if name in ENERGY_SYMMETRIES:
        return ENERGY_SYMMETRIES[name]
    measure = MEASURES[name]
    kept = {Symmetry.PERMUTATION}
    if measure.reflectable:
        kept.add(Symmetry.REFLECTION)
    if measure.periodic:
        kept.add(Symmetry.SHIFT)
    return frozenset(kept)


def symmetries_of(origin: Origin) -> frozenset[Symmetry]:
    """Return what keeps the quality of a set with this origin: the symmetries of every term of its objective.

    A set without an objective has those of its sampler.  Of other sets (``given``) nothing is known: none.  An
    objective that does not parse is an InvalidValue.
    """
    if not origin.objective:
        return SAMPLERS[origin.family]().symmetries if origin.family in SAMPLERS else frozenset()
    terms = parse_objective(origin.objective).terms
    return frozenset.intersection(*(symmetries_of_term(term.name) for term in terms))


def require_symmetry(origin: Origin, symmetry: Symmetry) -> None:
    """Raise InvalidValue unless `symmetry` keeps the quality of sets with this origin; the text says why not."""
    kept = symmetries_of(origin)
    if symmetry in kept:
        return
    allowed = ", ".join(each for each in Symmetry if each in kept) or "nothing"
    if origin.objective:
        terms = parse_objective(origin.objective).terms
        spoilt = [term.name for term in terms if symmetry not in symmetries_of_term(term.name)]
        why = f"{symmetry} change {' and '.join(dict.fromkeys(spoilt))}, which this {origin.family} set was made for"
    elif origin.family in SAMPLERS:
        why = f"{symmetry} would spoil what {origin.family} points are good at"
    else:
        why = (
            f"nothing is known about what a {shown(origin.family)} set is good at, so {symmetry} may spoil it"
        )
    raise InvalidValue(f"{why}; legal for it: {allowed}")


def permute_coordinates(points: PointSet, *, rng: RngLike = 0) -> PointSet:
    """Return the points with their coordinates in a random order, one order for all points.

    Parameters
    ----------
    points : PointSet
        Its origin says whether this is legal: see :func:`~evenroad.points.randomise.symmetries_of`.
    rng : int, SeedSequence or Generator
        A passed Generator is spawned.

    Returns
    -------
    PointSet
        Its origin's method says which old coordinate each new one is, from 0: ``annealed, permuted 2 0 1``.

    Raises
    ------
    InvalidValue
        If this would change what the set was made for; the text names it and what is legal.
    """
    require_symmetry(points.origin, Symmetry.PERMUTATION)
    return _permuted(points, generator(rng))


def reflect(points: PointSet, *, rng: RngLike = 0) -> PointSet:
    """Return the points with x -> 1 - x in random coordinates, each with probability 1/2, the same for all points.

    A coordinate that would become 1 becomes the largest float below 1: the cube is half open.  Parameters and
    errors as for :func:`permute_coordinates`; the origin's method lists the coordinates: ``reflected 0 3``.
    """
    require_symmetry(points.origin, Symmetry.REFLECTION)
    return _reflected(points, generator(rng))


def shift(points: PointSet, *, rng: RngLike = 0) -> PointSet:
    """Return the points moved by one random vector, modulo 1.

    Parameters and errors as for :func:`permute_coordinates`; the origin's method gives the vector.
    """
    require_symmetry(points.origin, Symmetry.SHIFT)
    return _shifted(points, generator(rng))


def randomise(points: PointSet, *, rng: RngLike = 0) -> PointSet:
    """Return an equally good, other set: permuted, then reflected, then shifted, as far as each is legal.

    A set of which nothing is known (``given``) comes back as it is.
    """
    legal = symmetries_of(points.origin)
    random = generator(rng)
    if Symmetry.PERMUTATION in legal:
        points = _permuted(points, random)
    if Symmetry.REFLECTION in legal:
        points = _reflected(points, random)
    if Symmetry.SHIFT in legal:
        points = _shifted(points, random)
    return points


def _permuted(points: PointSet, random: np.random.Generator) -> PointSet:
    order = random.permutation(points.d)
    if (order == np.arange(points.d)).all():
        return points
    return _moved(points, points.points[:, order], f"permuted {_listed(order)}")


def _reflected(points: PointSet, random: np.random.Generator) -> PointSet:
    flipped = random.random(points.d) < 0.5
    if not flipped.any():
        return points
    mirrored = np.minimum(1.0 - points.points, LARGEST_COORDINATE)
    coordinates = np.where(flipped, mirrored, points.points)
    return _moved(points, coordinates, f"reflected {_listed(np.flatnonzero(flipped))}")


def _shifted(points: PointSet, random: np.random.Generator) -> PointSet:
    vector = random.random(points.d)
    # Both summands are >= 0, so the remainder is exact and below 1.
    return _moved(points, (points.points + vector) % 1.0, f"shifted {_listed(vector)}")


def _moved(points: PointSet, coordinates: npt.NDArray[Any], what: str) -> PointSet:
    return PointSet(coordinates, points.origin).with_origin(method=f"{points.origin.method}, {what}")


def _listed(values: npt.NDArray[Any]) -> str:
    """Return the numbers with all their digits: the set can be made again from its origin."""
    return " ".join(str(value) for value in values.tolist())
