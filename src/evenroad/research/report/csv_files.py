"""The report's numbers as CSV, one file a kind, full precision."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from evenroad.research.report.analysis import Analysis
from evenroad.research.report.cells import Cell
from evenroad.research.statistics import Interval

PAPER_ADDS = 3
"""The paper's |V| is the valid milestones when the planner stopped, plus 3."""
STOPS_EARLY = "stock"
"""The search that stops when the paper's planner does."""


def cells_csv(analysis: Analysis) -> bytes:
    """Return every cell.

    `mean_paper_v` is the number of milestones as the paper counts them; only the search that stops as early as the
    paper's planner has it.  `unit` names what is independent, `units` counts them, and `sets` the sets of a pool.
    """
    header = (
        "problem sampler n rule search runs solved success low high interval unit units sets mean_valid sd_valid"
        " mean_paper_v sd_paper_v mean_edges_checked mean_seconds failures samples_for_90 samples_for_90_low"
        " samples_for_90_high"
    )
    rows = []
    for cell in analysis.cells:
        needed = analysis.needed[cell.setting, cell.sampler]
        early = cell.setting.search == STOPS_EARLY
        paper_v = (cell.mean_early + PAPER_ADDS, cell.sd_early) if early else ("", "")
        units = (cell.units.kind, len(cell.units), len(cell.sets))
        means = (cell.mean_valid, cell.sd_valid, *paper_v, cell.mean_edges, cell.mean_seconds)
        counted = (*_names(cell), cell.runs, cell.solved, cell.rate, *_fields(cell.interval), *units)
        rows.append((*counted, *means, cell.failures, needed.estimate, needed.low, needed.high))
    return _csv(header, rows)


def comparisons_csv(analysis: Analysis) -> bytes:
    """Return every paired comparison."""
    header = (
        "problem sampler n rule search reference pairs only_sampler only_reference difference low high interval test p"
        " p_corrected"
    )
    rows = []
    for each in analysis.comparisons:
        counts = (each.reference, each.pairs, each.only_cell, each.only_reference, each.difference)
        tested = (*_fields(each.interval), each.test, each.p, each.p_corrected)
        rows.append((*_names(each.cell), *counts, *tested))
    return _csv(header, rows)


def expected_csv(analysis: Analysis) -> bytes:
    """Return every expected cell with ours and the verdict."""
    header = (
        "source problem sampler n rule expected_runs expected_solved expected_success our_runs our_solved our_success p"
        " p_corrected verdict v_counts v_add expected_v our_v"
    )
    rows = []
    for name, (_, verdicts) in analysis.verdicts.items():
        for each in verdicts:
            theirs, ours = each.expected, each.ours
            names = (name, theirs.problem, theirs.sampler, theirs.n, theirs.rule)
            counted = ("", "", "") if ours is None else (ours.runs, ours.solved, ours.rate)
            counts = (theirs.runs, theirs.solved, theirs.success / 100.0, *counted)
            v = (theirs.v_counts, theirs.v_add, theirs.v, each.our_v)
            rows.append((*names, *counts, each.p, each.p_corrected, each.word, *v))
    return _csv(header, rows)


def fair_csv(analysis: Analysis) -> bytes:
    """Return the pooled fair suite."""
    header = (
        "pooled_by group sampler worlds pairs sets success uniform_success difference low high interval p"
        " p_corrected"
    )
    rows = []
    for grouping, found in analysis.pooled.items():
        for each in found:
            counts = (grouping, each.group, each.sampler, each.instances, each.pairs, each.sets)
            rates = (each.rate, each.reference_rate, each.difference, *_fields(each.interval))
            rows.append((*counts, *rates, each.p, each.p_corrected))
    return _csv(header, rows)


def _names(cell: Cell) -> tuple[object, ...]:
    return cell.setting.problem, cell.sampler, cell.n, cell.setting.rule, cell.setting.search


def _fields(interval: Interval) -> tuple[object, ...]:
    return interval.low, interval.high, interval.kind


def _csv(header: str, rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header.split())
    # NaN means that there is no number, which CSV writes as nothing.
    writer.writerows(["" if value is None or value != value else value for value in row] for row in rows)
    return text.getvalue().encode()
