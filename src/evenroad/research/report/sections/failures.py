"""The table of runs that gave no answer."""

from __future__ import annotations

from evenroad.research.report.failures import Failure
from evenroad.research.report.tables import Entry, Table

SHOWN = 40


def failure_table(found: tuple[Failure, ...]) -> Table:
    """Return the failures that are alike counted together; the rest beyond 40 kinds as a number."""
    rows = tuple(
        (
            Entry(each.problem),
            Entry(each.sampler),
            Entry(each.rule),
            Entry(each.status),
            Entry(each.message or "–"),
            Entry(str(each.runs)),
        )
        for each in found[:SHOWN]
    )
    rest = found[SHOWN:]
    left_out = (f"{len(rest)} more kinds, {sum(each.runs for each in rest)} runs.",) if rest else ()
    return Table(
        name="failures-by-kind",
        title="Runs that gave no answer",
        header=("problem", "sampler", "rule", "status", "last line of the error", "runs"),
        rows=rows,
        labels=5,
        notes=("They are counted as runs that were not solved.", *left_out),
    )
