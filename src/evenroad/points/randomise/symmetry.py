"""Which transformations of the cube leave a measure, and so a set that was made for it, as good as it was."""

from __future__ import annotations

from enum import StrEnum

from evenroad.errors import InvalidValue
from evenroad.points.measures import MEASURES
from evenroad.points.optimise.parse import parse_objective
from evenroad.points.pointset import Origin


class Symmetry(StrEnum):
    """A kind of transformation of the unit cube."""

    PERMUTATION = "permutations of the coordinates"
    REFLECTION = "reflections"
    SHIFT = "shifts modulo 1"


ALL = frozenset(Symmetry)

ENERGY_SYMMETRIES = {
    "riesz": ALL,
    "riesz_open": frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION}),
}
"""Of the energies; a discrepancy says it itself (``Measure.periodic``, ``Measure.reflectable``)."""

CONSTRUCTION_SYMMETRIES = {
    # Independent points are as uniform after any of them.
    "uniform": ALL,
    # Turned at random and cut by the cube: the cube's own symmetries give an equally likely set.  A shift would
    # join the two cut sides, where the lattice does not fit together.
    "lattice": frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION}),
    # The grid has the symmetries of the cube; a shift would move its cells off the faces.
    "sukharev": frozenset({Symmetry.PERMUTATION, Symmetry.REFLECTION}),
    # Known for their star discrepancy, which sees only the origin's corner.
    "halton": frozenset({Symmetry.PERMUTATION}),
    "sobol": frozenset({Symmetry.PERMUTATION}),
}
"""Of the samplers that minimise no objective."""


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

    A set without an objective has those of its construction.  Of other sets (``given``) nothing is known: none.

    Raises
    ------
    InvalidValue
        If the origin's objective does not parse (UnknownName for a measure that is not known).
    """
    if not origin.objective:
        return CONSTRUCTION_SYMMETRIES.get(origin.family, frozenset())
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
    elif origin.family in CONSTRUCTION_SYMMETRIES:
        why = f"{symmetry} would spoil what {origin.family} points are good at"
    else:
        why = f"nothing is known about what a {origin.family!r} set is good at, so {symmetry} may spoil it"
    raise InvalidValue(f"{why}; legal for it: {allowed}")
