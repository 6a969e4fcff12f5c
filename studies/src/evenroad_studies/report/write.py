"""Writing a report: from a store to a folder of files."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad import __version__
from evenroad._checks import require_known
from evenroad._files import atomic_write, remove_abandoned_parts, require_writable_folder
from evenroad.errors import BrokenFile, NotAvailable
from evenroad_studies.bench.rows import FAILURES, Rows
from evenroad_studies.bench.store import Session, read_rows, read_sessions
from evenroad_studies.bench.task import PROTOCOL
from evenroad_studies.report.analysis import Analysis, analyse
from evenroad_studies.report.cells import Cell
from evenroad_studies.report.page import as_page, sections_of
from evenroad_studies.report.tables import as_latex, as_markdown

PAGE = "report.html"


@dataclass(frozen=True)
class Report:
    """A written report: its results, and its files, the page first."""

    analysis: Analysis
    files: tuple[Path, ...]


def write_report(
    store: str | os.PathLike[str], out: str | os.PathLike[str], *, only: Sequence[str] = (), command: str = ""
) -> Report:
    """Write a report of a store into a folder: ``report.html``, PNG figures, CSV, ``tables.md`` and ``tables.tex``.

    A benchmark may be writing the store, which needs rows (NotAvailable), and rows of each problem that is named in
    `only` (UnknownName); by default all count.  The folder is made where there is none (BrokenFile if it cannot be).
    Each file is written atomically, and the same rows and `command`, which the page shows, give the same bytes.
    """
    source, folder = Path(store), Path(out)
    rows = _rows(source, only)
    _make_folder(folder)
    analysis = analyse(rows)
    sections = sections_of(analysis)
    facts = facts_of(source, rows, read_sessions(source), command or f"write_report({source.name!r})")
    tables = [table for section in sections for table in section.tables]
    files = {
        PAGE: as_page("Benchmark report", facts, sections).encode(),
        "tables.md": "\n".join(map(as_markdown, tables)).encode(),
        "tables.tex": "\n".join(map(as_latex, tables)).encode(),
        **csv_files(analysis),
        **{f"{picture.name}.png": picture.png for section in sections for picture in section.pictures},
    }
    for name, content in files.items():
        with atomic_write(folder / name) as file:
            file.write(content)
    return Report(analysis, tuple(folder / name for name in files))


def _rows(store: Path, only: Sequence[str]) -> Rows:
    rows = read_rows(store)
    if not len(rows):
        raise NotAvailable(f"{store} has no rows to report: run a benchmark into it first")
    present = rows.problem.present()
    for name in only:
        require_known(f"problem in {store}:", name, present)
    return rows.where(rows.problem.is_in(only)) if only else rows


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(exist_ok=True)
    except FileNotFoundError as error:
        raise BrokenFile(f"cannot make the folder {folder}: {folder.parent} does not exist") from error
    except OSError as error:
        raise BrokenFile(f"cannot make the folder {folder}: {error.strerror or error}") from error
    require_writable_folder(folder / PAGE)
    remove_abandoned_parts(folder)


def facts_of(store: Path, rows: Rows, sessions: Sequence[Session], command: str) -> list[tuple[str, str]]:
    """Return where the numbers of a report come from, as (term, fact): command, rows, seeds, versions, machines."""
    failed = {status: int(rows.status.is_in([status]).sum()) for status in FAILURES}
    by_status = ", ".join(f"{count} {status}" for status, count in failed.items() if count)
    facts = [
        ("command", command),
        ("store", f"{store.name}: {len(rows)} rows of {', '.join(rows.suite.present())}"),
        ("failures", f"{sum(failed.values())}" + (f" ({by_status})" if by_status else "")),
        ("seeds", ", ".join(str(seed) for seed in np.unique(rows.seed))),
        ("protocol", f"{PROTOCOL}; rows of others are left out"),
        ("report by", f"evenroad {__version__}"),
    ]
    if sessions:
        facts += [
            ("runs by", "; ".join(dict.fromkeys(map(_versions, sessions)))),
            ("machines", "; ".join(dict.fromkeys(session.platform for session in sessions))),
            ("started", f"{sessions[0].started}, last resumed {sessions[-1].started}"),
        ]
    return facts


def _versions(session: Session) -> str:
    parts = (f"evenroad {session.evenroad}", f"Python {session.python}", f"numpy {session.numpy}")
    numba = (f"numba {session.numba}",) if session.numba else ()
    return ", ".join((*parts, f"scipy {session.scipy}", *numba))


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
    return csv_text(header, rows)


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
    return csv_text(header, rows)


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
    return csv_text(header, rows)


def _fair(analysis: Analysis) -> bytes:
    header = (
        "pooled_by group sampler worlds pairs sets success uniform_success difference low high interval p p_corrected"
    )
    rows = []
    for grouping, found in analysis.pooled.items():
        for each in found:
            counts = (grouping, each.group, each.sampler, each.instances, each.pairs, each.sets)
            rates = (each.rate, each.reference_rate, each.difference, *each.interval)
            rows.append((*counts, *rates, each.p, each.p_corrected))
    return csv_text(header, rows)


def _names(cell: Cell) -> tuple[object, ...]:
    return cell.setting.problem, cell.sampler, cell.n, cell.setting.rule, cell.setting.search


def csv_text(header: str, rows: Iterable[Sequence[object]]) -> bytes:
    """Return rows under a header, whose names are between spaces, as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header.split())
    # NaN means that there is no number, which CSV writes as nothing.
    writer.writerows(["" if value is None or value != value else value for value in row] for row in rows)
    return text.getvalue().encode()
