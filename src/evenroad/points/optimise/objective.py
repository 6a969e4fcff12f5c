"""Objective: what annealing and training make small, a weighted sum of measures, energies or their logs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad._checks import require_positive
from evenroad.errors import InvalidValue, UnknownName
from evenroad.points.measures import MEASURES
from evenroad.points.measures.measure import rooted_of_columns
from evenroad.points.measures.riesz import log_riesz_of_columns
from evenroad.points.measures.terms import Array
from evenroad.points.pointset import as_unit_points

ENERGIES = ("riesz", "riesz_open")
"""Riesz energies with s = 2d, rooted: on the torus, and in the open cube."""

SMALLEST_ROOT = 1e-160
"""What a discrepancy that rounds to 0 counts as inside a log."""


@dataclass(frozen=True)
class Term:
    """One term: ``weight * name`` or ``weight * log(name)``.

    Attributes
    ----------
    name : str
        A name of ``MEASURES``, meaning its rooted value, or of ``ENERGIES``.
    weight : float
        Positive factor.
    logarithm : bool
        Whether the natural log is taken.

    Raises
    ------
    UnknownName
        For another name.
    InvalidValue
        For a weight that is not a finite number > 0.
    """

    name: str
    weight: float = 1.0
    logarithm: bool = False

    def __post_init__(self) -> None:
        if self.name not in MEASURES and self.name not in ENERGIES:
            raise UnknownName.among("term", self.name, [*MEASURES, *ENERGIES])
        require_positive("weight", self.weight)

    def __str__(self) -> str:
        inner = f"log({self.name})" if self.logarithm else self.name
        if self.weight == 1.0:
            return inner
        factor = int(self.weight) if self.weight.is_integer() and self.weight < 1e15 else self.weight
        return f"{factor}*{inner}"


@dataclass(frozen=True)
class Objective:
    """A sum of terms, to be made small; ``str`` gives the expression that parses to it again.

    Attributes
    ----------
    terms : tuple of Term
        At least one.
    """

    terms: tuple[Term, ...]

    @property
    def periodic(self) -> bool:
        """Whether a shift modulo 1 of all points changes nothing."""
        return all(
            term.name == "riesz" or (term.name in MEASURES and MEASURES[term.name].periodic)
            for term in self.terms
        )

    @property
    def least_points(self) -> int:
        """Fewest points that it is defined for: 2 with an energy, else 1."""
        return 2 if any(term.name in ENERGIES for term in self.terms) else 1

    def value(self, points: object) -> float:
        """Return the objective at `points`, (n, d) in [0, 1); InvalidValue for too few or bad points."""
        return self.with_gradient(points)[0]

    def with_gradient(self, points: object) -> tuple[float, Array]:
        """Return the objective and its gradient, shape (n, d), at `points`; errors as :meth:`value`."""
        coordinates = as_unit_points(points)
        require_points_for(self, coordinates.shape[0])
        value, gradient = objective_of_columns(self, np.ascontiguousarray(coordinates.T))
        return value, np.ascontiguousarray(gradient.T)

    def __str__(self) -> str:
        return " + ".join(map(str, self.terms))


def require_points_for(objective: Objective, n: int) -> None:
    """Raise InvalidValue unless `n` points are enough for every term."""
    if n < objective.least_points:
        raise InvalidValue(
            f"the objective '{objective}' needs at least {objective.least_points} points, got {n}"
        )


def objective_of_columns(objective: Objective, columns: Array) -> tuple[float, Array]:
    """Return the objective and its gradient, shape (d, n), at checked points of shape (d, n)."""
    total, total_gradient = 0.0, np.zeros_like(columns)
    for term in objective.terms:
        value, gradient = _term_of_columns(term, columns)
        gradient *= term.weight
        total += term.weight * value
        total_gradient += gradient
    return total, total_gradient


def _term_of_columns(term: Term, columns: Array) -> tuple[float, Array]:
    d = columns.shape[0]
    if term.name in ENERGIES:
        s = 2 * d
        log_energy, log_gradient = log_riesz_of_columns(columns, s, term.name == "riesz", want_gradient=True)
        log_root = log_energy / s
        log_gradient /= s
        if term.logarithm:
            return log_root, log_gradient
        root = math.exp(log_root)
        return root, root * log_gradient
    root, gradient = rooted_of_columns(MEASURES[term.name], columns, np.ones(d))
    if not term.logarithm:
        return root, gradient
    root = max(root, SMALLEST_ROOT)
    return math.log(root), gradient / root
