"""Expected cell: a success rate and a number of valid milestones that ours are held against."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from evenroad.errors import UnknownName

FOLDER = Path(__file__).parent
SOURCES = ("paper", "pinned")
"""Names of the data files."""


@dataclass(frozen=True)
class ExpectedCell:
    """One cell of a published or measured table.

    Attributes
    ----------
    problem, sampler, rule, n
        Which of our cells it is held against.
    success : float
        Success rate as given, in percent; NaN where none is given.
    runs : int or None
        Runs behind it; None where the source does not say, and then there is nothing to test.
    v, v_sd : float
        Mean number of milestones and its standard deviation over runs; NaN where not given.
    v_counts : str
        ``all`` valid ones among the n points, or ``early``: those added until there was a path.
    v_add : int
        What the source adds for start and goal.
    note : str
        What a reader must know of this row.
    """

    problem: str
    sampler: str
    rule: str
    n: int
    success: float
    runs: int | None
    v: float
    v_sd: float
    v_counts: str
    v_add: int
    note: str

    @property
    def solved(self) -> int | None:
        """Number of solved runs, where the source lets one tell it."""
        if self.runs is None or math.isnan(self.success):
            return None
        return round(self.success / 100.0 * self.runs)

    @property
    def v_definition(self) -> str:
        """How `v` is counted, in a few characters: ``all + 2``, ``early + 3``."""
        return f"{self.v_counts} + {self.v_add}"


@dataclass(frozen=True)
class ExpectedTable:
    """All expected cells of one source, in the order of its file."""

    name: str
    title: str
    source: str
    about: str
    cells: tuple[ExpectedCell, ...]


@cache
def load_expected(name: str) -> ExpectedTable:
    """Read one of :data:`SOURCES`.

    Raises
    ------
    UnknownName
        If there is no such source.
    """
    if name not in SOURCES:
        raise UnknownName.among("source of expected results", name, SOURCES)
    record = tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
    cells = tuple(cell for row in record["rows"] for cell in _cells_of(row))
    return ExpectedTable(record["name"], record["title"], record["source"], record["about"], cells)


def _cells_of(row: dict[str, Any]) -> list[ExpectedCell]:
    unknown = [math.nan] * len(row["n"])
    columns = (row["n"], row["success"], row.get("v", unknown), row.get("v_sd", unknown))
    return [
        ExpectedCell(
            row["problem"],
            row["sampler"],
            row["rule"],
            n,
            float(success),
            row.get("runs"),
            float(v),
            float(v_sd),
            row["v_counts"],
            row["v_add"],
            row.get("note", ""),
        )
        for n, success, v, v_sd in zip(*columns, strict=True)
    ]
