"""Planner Arena: the rows of a store as a database of OMPL's benchmark schema (``ompl_benchmark_statistics.py``).

An experiment is a problem with its N, a planner is a sampler with its connection rule and search.
"""

from __future__ import annotations

import os
import sqlite3
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np

from evenroad._arrays import Ints
from evenroad._files import atomic_write, require_writable_folder
from evenroad.errors import InvalidValue, NotAvailable
from evenroad_studies.bench.rows import Rows
from evenroad_studies.bench.store import Session, read_rows, read_sessions
from evenroad_studies.bench.store_file import sqlite_errors

STATUSES = {
    "start_invalid": (1, "Invalid start"),
    "goal_invalid": (2, "Invalid goal"),
    "timeout": (4, "Timeout"),
    "solved": (6, "Exact solution"),
    "failed": (7, "Crash"),
    "lost": (8, "Worker lost"),
    "not_connected": (9, "Not connected"),
}
"""Ours -> number and text; the numbers are OMPL's where it has such a status."""

TABLES = (Path(__file__).parent / "arena.sql").read_text(encoding="utf-8")


def write_arena(store: str | os.PathLike[str], out: str | os.PathLike[str]) -> int:
    """Write a Planner Arena database of all rows of a store, atomically; return how many runs it has.

    NotAvailable if the store has no rows, InvalidValue if both are the same file.
    """
    target = Path(out)
    require_writable_folder(target)
    rows, sessions = read_rows(store), read_sessions(store)
    if target.exists() and target.samefile(store):
        raise InvalidValue(f"cannot export {store} onto itself: give another file")
    if not len(rows):
        raise NotAvailable(f"{store} has no rows to export")
    # SQLite writes to a path, and only whole files are put in place.
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".evenroad-") as folder:
        made = Path(folder) / "arena.db"
        with sqlite_errors(target):
            _write(made, rows, sessions[-1])
        with atomic_write(target) as file:
            file.write(made.read_bytes())
    return len(rows)


def _write(path: Path, rows: Rows, session: Session) -> None:
    experiment, first_of_experiment = _numbers(rows, "problem", "n", "seed")
    planner, first_of_planner = _numbers(rows, "sampler", "rule", "search")
    with closing(sqlite3.connect(path)) as connection:
        connection.executescript(TABLES)
        connection.executemany("INSERT INTO enums VALUES ('status', ?, ?)", STATUSES.values())
        versions = f"python {session.python}, numpy {session.numpy}"
        for number, row in enumerate(first_of_experiment, 1):
            here = experiment == number
            ran = (float(np.nansum(rows.seconds[here])), int(here.sum()))
            of_session = (f"evenroad {session.evenroad}", session.platform, session.started)
            last = (int(rows.seed[row]), versions, int(rows.n[row]))
            connection.execute(
                "INSERT INTO experiments VALUES (?, ?, ?, 0, 0, ?, ?, ?, '', ?, ?, ?, ?)",
                (number, rows.problem[row], *ran, *of_session, *last),
            )
        for number, row in enumerate(first_of_planner, 1):
            sampler, rule, search = rows.sampler[row], rows.rule[row], rows.search[row]
            connection.execute(
                "INSERT INTO plannerConfigs VALUES (?, ?, ?)",
                (number, f"{sampler}, {rule}, {search}", f"sampler={sampler}; rule={rule}; search={search}"),
            )
        places = ", ".join("?" * 12)
        connection.executemany(f"INSERT INTO runs VALUES ({places})", _runs(rows, experiment, planner))
        connection.commit()


def _numbers(rows: Rows, *names: str) -> tuple[Ints, list[int]]:
    """Return for each row which of the different combinations of these columns it has, from 1, and their first rows."""
    columns = [np.asarray(getattr(getattr(rows, name), "codes", getattr(rows, name))) for name in names]
    _, first, number = np.unique(np.stack(columns, axis=1), axis=0, return_index=True, return_inverse=True)
    return number.ravel() + 1, first.tolist()


def _runs(rows: Rows, experiment: Ints, planner: Ints) -> Iterator[tuple[object, ...]]:
    status = [STATUSES[name][0] for name in rows.status.names]
    columns = (
        range(1, len(rows) + 1),
        experiment.tolist(),
        planner.tolist(),
        # SQLite writes NaN as NULL.
        rows.seconds.tolist(),
        rows.solved.astype(int).tolist(),
        [status[code] for code in rows.status.codes.tolist()],
        rows.valid.tolist(),
        [None if count < 0 else count for count in rows.valid_at_solution.tolist()],
        rows.edges_checked.tolist(),
        rows.length.tolist(),
        rows.run.tolist(),
        rows.instance.tolist(),
    )
    return zip(*columns, strict=True)
