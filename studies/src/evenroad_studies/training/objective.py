"""Objective: what annealing and training make small, a weighted sum of measures, energies or their logs.

As text it is ``hickernell`` or ``log(average_squared) + 10*log(riesz)``:

    expression := term { "+" term }
    term       := [ number "*" ] ( name | "log(" name ")" | "prefixes(" name ")" )

A discrepancy D falls with n and an energy is an inverse length, so the weight of a plain sum of the two would
mean something else for every n and d: at d = 2, n = 128, D is 0.005 and the rooted energy 1.5.  In the sum of
their logs a weight is a ratio of relative changes, whatever the units.  So where an energy stands without ``log``
beside other terms, all terms are taken in the log: ``hickernell+10*riesz`` is short for
``log(hickernell) + 10*log(riesz)``, that is log D + 10 log(E)/s with s = 2d, and its ``str`` says so.

``prefixes(hickernell)`` is how far the beginnings of the set are above scrambled Sobol's: nearly the largest log of a
ratio, over all beginnings, each of n points with weight 1/n.  It is for sets that are used from their first point on.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.points.anneal import require_points_for
from evenroad.points.measures import MEASURES
from evenroad.points.measures.separation import log_riesz_of_columns
from evenroad.points.pointset import as_unit_points
from evenroad.points.randomise import ALL_SYMMETRIES, Symmetry
from evenroad_studies.prefixes import PREFIXED, worst_prefix
from evenroad_studies.sequence import usual_prefixes

ENERGIES = {"riesz": ALL_SYMMETRIES, "riesz_open": ALL_SYMMETRIES - {Symmetry.SHIFT}}
"""Riesz energies with s = 2d, rooted, on the torus and in the open cube; and what leaves each as it is."""

SMALLEST_ROOT = 1e-160
"""What a discrepancy that rounds to 0 counts as inside a log."""

ALIASES = {"asd": "average_squared", "centered": "centred", "wraparound": "wrap_around"}
"""Other spellings that are understood."""

_TOKEN = re.compile(r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>\S))")


@dataclass(frozen=True)
class Term:
    """One term: ``weight * name``, ``weight * log(name)`` or ``weight * prefixes(name)``.

    `name` is one of ``MEASURES``, meaning its rooted value, or of ``ENERGIES``, else UnknownName; `weight` a finite
    number > 0, else InvalidValue.
    """

    name: str
    weight: float = 1.0
    logarithm: bool = False
    prefixes: bool = False

    def __post_init__(self) -> None:
        if self.name not in MEASURES and self.name not in ENERGIES:
            raise UnknownName.among("term", self.name, [*MEASURES, *ENERGIES])
        if self.prefixes and self.name not in PREFIXED:
            raise InvalidValue(f"prefixes(...) takes {' or '.join(PREFIXED)}, got {shown(self.name)}")
        require_positive("weight", self.weight)

    @property
    def symmetries(self) -> frozenset[Symmetry]:
        """What leaves it as it is.  Coordinates have equal weights, so their order never matters."""
        if self.name in ENERGIES:
            return ENERGIES[self.name]
        measure = MEASURES[self.name]
        lost = {Symmetry.REFLECTION: not measure.reflectable, Symmetry.SHIFT: not measure.periodic}
        return ALL_SYMMETRIES - {symmetry for symmetry, is_lost in lost.items() if is_lost}

    def of_columns(self, columns: Floats) -> tuple[float, Floats]:
        """Return the unweighted term and its gradient, (d, n), at points of shape (d, n)."""
        if self.prefixes:
            usual = usual_prefixes(self.name, columns.shape[1], len(columns))
            return worst_prefix(self.name, columns, usual)
        if self.name in ENERGIES:
            s = 2 * len(columns)
            value, gradient = log_riesz_of_columns(columns, s, self.name == "riesz", want_gradient=True)
            value, gradient = value / s, gradient / s
            return (value, gradient) if self.logarithm else (math.exp(value), math.exp(value) * gradient)
        value, gradient = MEASURES[self.name].of_columns(columns)
        if not self.logarithm:
            return value, gradient
        value = max(value, SMALLEST_ROOT)
        return math.log(value), gradient / value

    def __str__(self) -> str:
        inner = f"log({self.name})" if self.logarithm else self.name
        if self.prefixes:
            inner = f"prefixes({self.name})"
        if self.weight == 1.0:
            return inner
        factor = int(self.weight) if self.weight.is_integer() and self.weight < 1e15 else self.weight
        return f"{factor}*{inner}"


@dataclass(frozen=True)
class Objective:
    """A sum of terms, to be made small; ``str`` gives the expression that parses to it again."""

    terms: tuple[Term, ...]

    @property
    def symmetries(self) -> frozenset[Symmetry]:
        """What leaves every term as it is."""
        return frozenset.intersection(*(term.symmetries for term in self.terms))

    @property
    def periodic(self) -> bool:
        """Whether a shift modulo 1 of all points changes nothing."""
        return Symmetry.SHIFT in self.symmetries

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
        require_points_for(self, len(coordinates))
        value, gradient = self.of_columns(np.ascontiguousarray(coordinates.T))
        return value, np.ascontiguousarray(gradient.T)

    def of_columns(self, columns: Floats) -> tuple[float, Floats]:
        """Return the objective and its gradient, (d, n), at checked points of shape (d, n)."""
        total, total_gradient = 0.0, np.zeros_like(columns)
        for term in self.terms:
            value, gradient = term.of_columns(columns)
            total += term.weight * value
            total_gradient += term.weight * gradient
        return total, total_gradient

    def __str__(self) -> str:
        return " + ".join(map(str, self.terms))


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
    terms = [reader.take_term()]
    while reader.word:
        reader.take("+", "'+' or the end")
        terms.append(reader.take_term())
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
        self._place = f"objective {shown(self.text)}, column {self.column}"

    def take(self, wanted: str, expected: str) -> str:
        """Return the next token if its text or kind is `wanted`, else raise InvalidValue."""
        if wanted not in (self.word, self.kind):
            found = f"found {shown(self.word)}" if self.word else "the text ends"
            raise InvalidValue(f"{self._place}: expected {expected}, {found}")
        taken = self.word
        self._advance()
        return taken

    def take_term(self) -> Term:
        """Return the term that begins at the next token."""
        weight = 1.0
        if self.kind == "number":
            weight = float(self.word)
            if not 0.0 < weight < math.inf:
                raise InvalidValue(f"{self._place}: a weight must be finite and > 0, got {weight!r}")
            self._advance()
            self.take("*", "'*' after the weight")
        function = self.word
        if function not in ("log", "prefixes"):
            return Term(self._take_name(), weight)
        self._advance()
        self.take("(", f"'(' after {function}")
        name = self._take_name()
        self.take(")", "')'")
        return Term(name, weight, logarithm=True, prefixes=function == "prefixes")

    def _take_name(self) -> str:
        known, name = known_names(), ALIASES.get(self.word, self.word)
        if self.kind == "name" and name not in known:
            raise UnknownName(f"{self._place}: {UnknownName.among('name', self.word, known)}")
        self.take("name", f"a name ({', '.join(known)})")
        return name
