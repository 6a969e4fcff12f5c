"""Writing a report: from a store to a folder of files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad import __version__
from evenroad._checks import require_known
from evenroad._files import atomic_write, remove_abandoned_parts, require_writable_folder
from evenroad.errors import BrokenFile, NotAvailable
from evenroad.research.bench.rows import Rows
from evenroad.research.bench.store import Session, read_rows, read_sessions
from evenroad.research.bench.task import PROTOCOL
from evenroad.research.report.analysis import Analysis, analyse
from evenroad.research.report.csv_files import cells_csv, comparisons_csv, expected_csv, fair_csv
from evenroad.research.report.page import as_page, sections_of
from evenroad.research.report.tables import as_latex, as_markdown

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

    Each file is written atomically, and the same rows give the same bytes.

    Parameters
    ----------
    store : path
        A store of benchmark rows; a benchmark may be writing it.
    out : path
        Folder, made where there is none; its parent must exist.
    only : sequence of str
        Names of problems; all by default.
    command : str
        What to put on the page as the command that wrote it.

    Raises
    ------
    NotAvailable
        If the store has no rows.
    UnknownName
        If it has none of a problem in `only`; the text lists its problems.
    BrokenFile
        If the store cannot be read or the folder not be written.
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
        "cells.csv": cells_csv(analysis),
        "comparisons.csv": comparisons_csv(analysis),
    }
    if analysis.verdicts:
        files["expected.csv"] = expected_csv(analysis)
    if analysis.pooled:
        files["fair.csv"] = fair_csv(analysis)
    files |= {f"{picture.name}.png": picture.png for section in sections for picture in section.pictures}
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
    failed = int((~rows.answered).sum())
    by_status = ", ".join(
        f"{int(rows.status.is_in([status]).sum())} {status}"
        for status in rows.status.present()
        if not bool(rows.answered[rows.status.is_in([status])].any())
    )
    seeds = ", ".join(str(seed) for seed in np.unique(rows.seed))
    facts = [
        ("command", command),
        ("store", f"{store.name}: {len(rows)} rows of {', '.join(rows.suite.present())}"),
        ("failures", f"{failed}" + (f" ({by_status})" if failed else "")),
        ("seeds", seeds),
        ("protocol", f"{PROTOCOL}; rows of others are left out"),
        ("report by", f"evenroad {__version__}"),
    ]
    if sessions:
        facts += [
            ("runs by", "; ".join(dict.fromkeys(_versions(session) for session in sessions))),
            ("machines", "; ".join(dict.fromkeys(session.platform for session in sessions))),
            ("started", f"{sessions[0].started}, last resumed {sessions[-1].started}"),
        ]
    return facts


def _versions(session: Session) -> str:
    parts = (f"evenroad {session.evenroad}", f"Python {session.python}", f"numpy {session.numpy}")
    return ", ".join((*parts, f"scipy {session.scipy}", f"numba {session.numba}"))
