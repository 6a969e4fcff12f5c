"""Objective: what annealing and training make small, a weighted sum of measures, energies or their logs.

As text it is ``hickernell`` or ``log(average_squared) + 10*log(riesz)``:

    expression := term { "+" term }
    term       := [ number "*" ] ( name | "log(" name ")" )

A discrepancy D falls with n and an energy is an inverse length, so the weight of a plain sum of the two would
mean something else for every n and d: at d = 2, n = 128, D is .005 and the rooted energy 1.5.  In the sum of
their logs a weight is a ratio of relative changes, whatever the units.  So where an energy stands without ``log``
beside other terms, all terms are taken in the log: ``hickernell+10*riesz`` is short for
``log(hickernell) + 10*log(riesz)``, that is log D + 10 log(E)/s with s = 2d, and its ``str`` says so.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.points.measures import MEASURES
from evenroad.points.measures.measure import rooted_of_columns
from evenroad.points.measures.separation import log_riesz_of_columns
from evenroad.points.pointset import as_unit_points

ENERGIES = ("riesz", "riesz_open")
"""Riesz energies with s = 2d, rooted: on the torus, and in the open cube."""

SMALLEST_ROOT = 1e-160
"""What a discrepancy that rounds to 0 counts as inside a log."""

ALIASES = {"asd": "average_squared", "centered": "centred", "wraparound": "wrap_around"}
"""Other spellings that are understood."""

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>\S))"
)


@dataclass(frozen=True)
class Term:
    """One term: ``weight * name`` or ``weight * log(name)``, weight > 0.

    `name` is one of ``MEASURES``, meaning its rooted value, or of ``ENERGIES``; another is an UnknownName, a weight
    that is not a finite number > 0 an InvalidValue.
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

    def with_gradient(self, points: object) -> tuple[float, Floats]:
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


def objective_of_columns(objective: Objective, columns: Floats) -> tuple[float, Floats]:
    """Return the objective and its gradient, shape (d, n), at checked points of shape (d, n)."""
    total, total_gradient = 0.0, np.zeros_like(columns)
    for term in objective.terms:
        value, gradient = _term_of_columns(term, columns)
        gradient *= term.weight
        total += term.weight * value
        total_gradient += gradient
    return total, total_gradient


def _term_of_columns(term: Term, columns: Floats) -> tuple[float, Floats]:
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


def parse_objective(text: str | Objective) -> Objective:
    """Return the objective that `text` stands for; an Objective is returned as it is.

    Raises
    ------
    InvalidValue
        If the text is no expression; the message names the column (from 1) and what was expected there.
    UnknownName
        If a name is not known; the message names the column and lists the known names.
    """
    if isinstance(text, Objective):
        return text
    if not isinstance(text, str):
        raise InvalidValue(f"an objective is text such as 'hickernell+10*riesz', got {shown(text)}")
    reader = _Reader(text)
    terms = [_read_term(reader)]
    while reader.word:
        reader.take("+", "'+' or the end")
        terms.append(_read_term(reader))
    bare_energy = any(term.name in ENERGIES and not term.logarithm for term in terms)
    if len(terms) > 1 and bare_energy:
        terms = [replace(term, logarithm=True) for term in terms]
    return Objective(tuple(terms))


def known_names() -> list[str]:
    """Return every name that an expression may use, without the aliases."""
    return sorted([*MEASURES, *ENERGIES])


class _Reader:
    """The tokens of a text, one ahead: `kind`, `word` and `column` (from 1) are the next one's."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._tokens = _TOKEN.finditer(text.rstrip())
        self._advance()

    def _advance(self) -> None:
        match = next(self._tokens, None)
        self.kind = (match and match.lastgroup) or "end"
        self.word = match.group(self.kind) if match else ""
        self.column = 1 + (match.start(self.kind) if match else len(self.text))

    def take(self, wanted: str, expected: str) -> str:
        """Return the next token if its text or kind is `wanted`, else raise InvalidValue."""
        if wanted not in (self.word, self.kind):
            found = f"found {shown(self.word)}" if self.word else "the text ends"
            raise InvalidValue(
                f"objective {shown(self.text)}, column {self.column}: expected {expected}, {found}"
            )
        taken = self.word
        self._advance()
        return taken


def _read_term(reader: _Reader) -> Term:
    weight = 1.0
    if reader.kind == "number":
        column = reader.column
        weight = float(reader.take("number", "a number"))
        if not 0.0 < weight < math.inf:
            raise InvalidValue(
                f"objective {shown(reader.text)}, column {column}: a weight must be finite and > 0, got {weight!r}"
            )
        reader.take("*", "'*' after the weight")
    if reader.word == "log":
        reader.take("log", "log")
        reader.take("(", "'(' after log")
        name = _read_name(reader)
        reader.take(")", "')'")
        return Term(name, weight, logarithm=True)
    return Term(_read_name(reader), weight)


def _read_name(reader: _Reader) -> str:
    column = reader.column
    given = reader.take("name", f"a name ({', '.join(known_names())})")
    name = ALIASES.get(given, given)
    if name not in MEASURES and name not in ENERGIES:
        raise UnknownName(
            f"objective {shown(reader.text)}, column {column}: unknown name {shown(given)};"
            f" known: {', '.join(known_names())}"
        )
    return name
