"""Reading an objective from text: ``hickernell``, ``log(average_squared) + 10*log(riesz)``.

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
from dataclasses import replace

from evenroad.errors import InvalidValue, UnknownName, shown
from evenroad.points.measures import MEASURES
from evenroad.points.optimise.objective import ENERGIES, Objective, Term

ALIASES = {"asd": "average_squared", "centered": "centred", "wraparound": "wrap_around"}
"""Other spellings that are understood."""

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>\S))"
)


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
    while reader.next_text:
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
    """The tokens of a text, one ahead, with their columns."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = [
            (match.lastgroup or "", match.group(match.lastgroup or 0), match.start(match.lastgroup or 0) + 1)
            for match in _TOKEN.finditer(text.rstrip())
        ]
        self.position = 0

    @property
    def next_kind(self) -> str:
        return self.tokens[self.position][0] if self.position < len(self.tokens) else "end"

    @property
    def next_text(self) -> str:
        return self.tokens[self.position][1] if self.position < len(self.tokens) else ""

    @property
    def column(self) -> int:
        return self.tokens[self.position][2] if self.position < len(self.tokens) else len(self.text) + 1

    def take(self, wanted: str, expected: str) -> str:
        """Return the next token if its text or kind is `wanted`, else raise InvalidValue."""
        if wanted not in (self.next_text, self.next_kind):
            raise self.error(expected)
        taken = self.next_text
        self.position += 1
        return taken

    def error(self, expected: str) -> InvalidValue:
        found = f"found {shown(self.next_text)}" if self.next_text else "the text ends"
        return InvalidValue(
            f"objective {shown(self.text)}, column {self.column}: expected {expected}, {found}"
        )


def _read_term(reader: _Reader) -> Term:
    weight = 1.0
    if reader.next_kind == "number":
        column = reader.column
        weight = float(reader.take("number", "a number"))
        if not 0.0 < weight < math.inf:
            raise InvalidValue(
                f"objective {shown(reader.text)}, column {column}: a weight must be finite and > 0, got {weight!r}"
            )
        reader.take("*", "'*' after the weight")
    if reader.next_text == "log":
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
