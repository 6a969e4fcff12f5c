"""The report's numbers as CSV, one file a kind, full precision."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from evenroad.research.report.analysis import Analysis
from evenroad.research.report.cells import Cell

PAPER_ADDS = 3
"""The paper's |V| is the valid milestones when the planner stopped, plus 3."""
STOPS_EARLY = "stock"
"""The search that stops when the paper's planner does."""


def csv_files(analysis: Analysis) -> dict[str, bytes]:
    """Return the files by their names: of cells and comparisons always, others where there is something to say."""
    files = {"cells.csv": _cells(analysis), "comparisons.csv": _comparisons(analysis)}
    if analysis.verdicts:
        files["expected.csv"] = _expected(analysis)
    if analysis.pooled:
        files["fair.csv"] = _fair(analysis)
    return files


def _cells(analysis: Analysis) -> bytes:
    """Return every cell; only the search that stops as early as the paper's planner has its count of milestones."""
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
        counted = (*_names(cell), cell.runs, cell.solved, cell.rate, *cell.interval, *units)
        rows.append((*counted, *means, cell.failures, needed.estimate, needed.low, needed.high))
    return _csv(header, rows)


def _comparisons(analysis: Analysis) -> bytes:
    header = (
        "problem sampler n rule search reference pairs only_sampler only_reference difference low high interval test p"
        " p_corrected"
    )
    rows = []
    for each in analysis.comparisons:
        counts = (each.reference, each.pairs, each.only_cell, each.only_reference, each.difference)
        tested = (*each.interval, each.test, each.p, each.p_corrected)
        rows.append((*_names(each.cell), *counts, *tested))
    return _csv(header, rows)


def _expected(analysis: Analysis) -> bytes:
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


def _fair(analysis: Analysis) -> bytes:
    header = (
        "pooled_by group sampler worlds pairs sets success uniform_success difference low high interval p"
        " p_corrected"
    )
    rows = []
    for grouping, found in analysis.pooled.items():
        for each in found:
            counts = (grouping, each.group, each.sampler, each.instances, each.pairs, each.sets)
            rates = (each.rate, each.reference_rate, each.difference, *each.interval)
            rows.append((*counts, *rates, each.p, each.p_corrected))
    return _csv(header, rows)


def _names(cell: Cell) -> tuple[object, ...]:
    return cell.setting.problem, cell.sampler, cell.n, cell.setting.rule, cell.setting.search


def _csv(header: str, rows: Iterable[Sequence[object]]) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header.split())
    # NaN means that there is no number, which CSV writes as nothing.
    writer.writerows(["" if value is None or value != value else value for value in row] for row in rows)
    return text.getvalue().encode()
