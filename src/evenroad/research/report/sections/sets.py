"""Spread over the sets of a family, one table a question."""

from __future__ import annotations

from evenroad.research.report.analysis import Analysis
from evenroad.research.report.runs import Question
from evenroad.research.report.tables import Entry, Table
from evenroad.research.report.text import percent
from evenroad.research.statistics import spread_over_sets


def spread_table(analysis: Analysis, question: Question, name: str) -> Table | None:
    """Return success per set of the families that draw from a pool; None where no set was drawn twice."""
    rows = []
    for cell in analysis.cells_of(question):
        if len(cell.sets) < 2 or cell.sets.runs.max() < 2:
            continue
        spread = spread_over_sets(cell.sets.solved, cell.sets.runs)
        shares = (spread.mean, spread.lowest, spread.highest, spread.sd, spread.sd_by_chance)
        rows.append(
            (
                Entry(cell.sampler),
                Entry(str(cell.n)),
                Entry(str(spread.sets)),
                Entry(str(cell.runs)),
                *(Entry(percent(share)) for share in shares),
            )
        )
    if not rows:
        return None
    return Table(
        name=name,
        title=f"{question}: success of single sets [%]",
        header=("family", "N", "sets", "runs", "mean", "lowest", "highest", "sd", "sd by chance"),
        rows=tuple(rows),
        notes=(
            "sd by chance is what sets that are all alike would show with so few runs each; a larger sd says that some"
            " sets suit this problem better than others.",
        ),
    )
