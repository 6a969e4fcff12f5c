"""The report's numbers as CSV, one file a kind, full precision."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from evenroad.research.report.analysis import Analysis

PAPER_ADDS = 3
"""The paper's |V| is the valid milestones when the planner stopped, plus 3."""
STOPS_EARLY = "stock"
"""The search that stops when the paper's planner does."""


def cells_csv(analysis: Analysis) -> bytes:
    """Return every cell.

    `mean_paper_v` is the number of milestones as the paper counts them, of the search that stops early as its planner
    does; `unit` is what is independent, `units` how many of them and `sets` how many sets of a pool there were.
    """
    header = (
        "problem sampler n rule search runs solved success low high interval unit units sets mean_valid sd_valid"
        " mean_paper_v sd_paper_v mean_edges_checked mean_seconds failures samples_for_90 samples_for_90_low"
        " samples_for_90_high"
    )
    rows = []
    for cell in analysis.cells:
        question, needed = cell.question, analysis.needed[cell.question, cell.sampler]
        paper_v = (
            (cell.mean_early + PAPER_ADDS, cell.sd_early) if question.search == STOPS_EARLY else ("", "")
        )
        rows.append(
            (
                *(question.problem, cell.sampler, cell.n, question.rule, question.search),
                *(
                    cell.runs,
                    cell.solved,
                    cell.rate,
                    cell.interval.low,
                    cell.interval.high,
                    cell.interval.kind,
                ),
                *(cell.units.kind, len(cell.units), len(cell.sets)),
                *(cell.mean_valid, cell.sd_valid, *paper_v),
                *(cell.mean_edges, cell.mean_seconds, cell.failures),
                *(needed.estimate, needed.low, needed.high),
            )
        )
    return _csv(header.split(), rows)


def comparisons_csv(analysis: Analysis) -> bytes:
    """Return every paired comparison."""
    header = (
        "problem sampler n rule search reference pairs only_sampler only_reference difference low high interval test p"
        " p_corrected"
    )
    rows = []
    for each in analysis.comparisons:
        question = each.cell.question
        rows.append(
            (
                *(question.problem, each.cell.sampler, each.cell.n, question.rule, question.search),
                *(each.reference, each.pairs, each.only_cell, each.only_reference, each.difference),
                *(
                    each.interval.low,
                    each.interval.high,
                    each.interval.kind,
                    each.test,
                    each.p,
                    each.p_corrected,
                ),
            )
        )
    return _csv(header.split(), rows)


def expected_csv(analysis: Analysis) -> bytes:
    """Return every expected cell with ours and the verdict."""
    header = (
        "source problem sampler n rule expected_runs expected_solved expected_success our_runs our_solved our_success p"
        " p_corrected verdict v_counts v_add expected_v our_v"
    )
    rows = []
    for name, (_, verdicts) in analysis.verdicts.items():
        for each in verdicts:
            expected, ours = each.expected, each.ours
            counted = ("", "", "") if ours is None else (ours.runs, ours.solved, ours.rate)
            rows.append(
                (
                    *(name, expected.problem, expected.sampler, expected.n, expected.rule),
                    *(expected.runs, expected.solved, expected.success / 100.0, *counted),
                    *(each.p, each.p_corrected, each.word),
                    *(expected.v_counts, expected.v_add, expected.v, each.our_v),
                )
            )
    return _csv(header.split(), rows)


def fair_csv(analysis: Analysis) -> bytes:
    """Return the pooled fair suite."""
    header = (
        "pooled_by group sampler worlds pairs sets success uniform_success difference low high interval p"
        " p_corrected"
    )
    rows = [
        (
            *(grouping, each.group, each.sampler, each.instances, each.pairs, each.sets),
            *(
                each.rate,
                each.reference_rate,
                each.rate - each.reference_rate,
                each.interval.low,
                each.interval.high,
            ),
            *(each.interval.kind, each.p, each.p_corrected),
        )
        for grouping, found in analysis.pooled.items()
        for each in found
    ]
    return _csv(header.split(), rows)


def _csv(header: Sequence[str], rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    # NaN is "nothing to say", which CSV writes as nothing.
    writer.writerows(["" if value is None or value != value else value for value in row] for row in rows)
    return text.getvalue().encode()
