"""What may be done to a set without changing what it was made for, and doing it: all else is refused."""

from __future__ import annotations

from evenroad._rng import RngLike
from evenroad.errors import InvalidValue, shown
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry, randomise
from evenroad.points.samplers import SAMPLERS
from evenroad_studies.training.objective import parse_objective


def symmetries_of(origin: Origin) -> frozenset[Symmetry]:
    """Return what keeps the quality of a set with this origin: the symmetries of every term of its objective.

    A set without an objective has those of its sampler.  Of other sets (``given``) nothing is known: none.  An
    objective that does not parse is an InvalidValue.
    """
    if not origin.objective:
        return SAMPLERS[origin.family]().symmetries if origin.family in SAMPLERS else frozenset()
    return parse_objective(origin.objective).symmetries


def move(points: PointSet, symmetry: Symmetry, *, rng: RngLike = 0) -> PointSet:
    """Return the points under one random move of this kind: see :func:`~evenroad.points.randomise.randomise`.

    Raises InvalidValue if this would change what the set was made for; the text names it and what is legal.
    """
    origin, kept = points.origin, symmetries_of(points.origin)
    if symmetry in kept:
        return randomise(points, {symmetry}, rng=rng)
    allowed = ", ".join(each for each in Symmetry if each in kept) or "nothing"
    if origin.objective:
        terms = parse_objective(origin.objective).terms
        spoilt = dict.fromkeys(term.name for term in terms if symmetry not in term.symmetries)
        why = f"{symmetry} change {' and '.join(spoilt)}, which this {origin.family} set was made for"
    elif origin.family in SAMPLERS:
        why = f"{symmetry} would spoil what {origin.family} points are good at"
    else:
        family = shown(origin.family)
        why = f"nothing is known about what a {family} set is good at, so {symmetry} may spoil it"
    raise InvalidValue(f"{why}; legal for it: {allowed}")
