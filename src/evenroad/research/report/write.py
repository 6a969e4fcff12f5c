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
from evenroad.research.bench.rows import FAILURES, Rows
from evenroad.research.bench.store import Session, read_rows, read_sessions
from evenroad.research.bench.task import PROTOCOL
from evenroad.research.report.analysis import Analysis, analyse
from evenroad.research.report.csv_files import csv_files
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
    return ", ".join((*parts, f"scipy {session.scipy}", f"numba {session.numba}"))
