"""What a store of parts costs by its number of rows: to write, to make the table of all cells, in memory and on disk.

    python -m studies.benchmarks.store_sizes OUT.csv OUT.png [--most 10000000]

Rows are made up: 20 000 of each cell, 20 cells a problem, half of the problems in random worlds, sets of a pool in some
cells.  Each part is written by one worker and holds 250 000 rows of five problems.  The table of all cells, with its
intervals, is a process of its own: its seconds of processor, and the largest memory that it held, with what Python and
its libraries take (the first row shows how much that is; Linux alone).  Beside it the one SQLite file, as far as 10^5.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
from studies.benchmarks.sizes import alone, draw_costs, most_held, shown, sizes_parser, write_table

from evenroad_studies.bench.store import Session, open_store, read_rows
from evenroad_studies.bench.store_parts import write_part
from evenroad_studies.bench.task import PROTOCOL, Outcome, Task
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.runs import runs_of
from evenroad_studies.report.streamed import write_cells

COUNTS = (10_000, 100_000, 1_000_000, 10_000_000)
OF_A_PART, OF_A_PROBLEM = 250_000, 50_000
SAMPLERS = ("uniform", "sobol", "even", "korobov")
KINDS = ("parts", "one file")
COLUMNS = ("store", "rows", "write [s]", "bytes a row", "table of cells [s]", "most memory [MB]", "cells")


def made_up(part: int, rows: int):
    """Return the columns of a part."""
    rng, at = np.random.default_rng(part), np.arange(rows)
    # Each problem has twenty cells, and its runs are spread over eight parts as workers would.
    problem = part // 8 * 40 + part % 8 * 5 + at // OF_A_PROBLEM
    cell, run = at % 20, at // 20
    random = problem % 2 == 1
    seconds, length = rng.gamma(2.0, 0.01, rows), 1.0 + rng.gamma(2.0, 0.3, rows)
    solved = rng.random(rows) < 0.2 + 0.04 * cell
    names = [f"problem-{number}" for number in range(int(problem[-1]) + 1)]
    sets = ["", *map(str, range(64))]
    texts = {
        "suite": (["made-up"], 0 * at), "problem": (names, problem), "sampler": (SAMPLERS, cell % 4),
        "rule": (["k=10 earlier"], 0 * at), "search": (["connect"], 0 * at),
        "status": (["not_connected", "solved"], solved.astype(int)), "error": ([""], 0 * at),
        "set_id": (sets, np.where(cell % 4 == 2, 1 + run % 64, 0)), "worker": ([f"host:{part % 8}"], 0 * at),
        "finished": (["2026-11-26T12:00:00+00:00"], 0 * at),
    }  # fmt: skip
    numbers = {
        "protocol": np.full(rows, PROTOCOL), "instance": np.where(random, run % 500, 0), "n": 64 << (cell // 4),
        "run": run, "seed": np.full(rows, 1), "valid": rng.integers(20, 60, rows),
        "valid_at_solution": np.full(rows, -1), "edges_checked": rng.integers(50, 900, rows),
        "length": np.where(solved, length, np.nan), "seconds": seconds,
    }  # fmt: skip
    coded = {name: pa.DictionaryArray.from_arrays(codes.astype(np.int32), list(of)) for name, (of, codes) in
             texts.items()}  # fmt: skip
    return coded | numbers


def written(folder: Path, rows: int) -> float:
    """Write a store of parts; return the seconds of processor, without those of making rows up."""
    took, session = 0.0, Session("2026-11-26", *["0"] * 6)
    for part in range(-(-rows // OF_A_PART)):
        columns = made_up(part, min(OF_A_PART, rows - part * OF_A_PART))
        began = time.process_time()
        write_part(folder, columns, session)
        took += time.process_time() - began
    return took


def written_as_one(file: Path, rows: int) -> float:
    """Write the same rows into one SQLite file."""
    columns = made_up(0, rows)
    tasks = [Task(*fields) for fields in zip(*(columns[name].tolist() for name in Task.__annotations__), strict=True)]
    outcomes = [Outcome("solved", 20, None, 93, 1.25, 0.003)] * rows
    began = time.process_time()
    with open_store(file) as store:
        for task, outcome in zip(tasks, outcomes, strict=True):
            store.add("made-up", task, outcome, "host:1")
    return time.process_time() - began


def tabled(store: Path) -> tuple[float, float, int]:
    """Return what the table of all cells costs, in seconds and MB, and how many there are."""
    began = time.process_time()
    if store.is_dir():
        write_cells(store, store.with_suffix(".csv"))
        cells = len(store.with_suffix(".csv").read_text().splitlines()) - 1
    else:
        cells = len(cells_of(runs_of(read_rows(store))))
    return time.process_time() - began, most_held(), cells


def measured(kind: str, rows: int, folder: Path) -> tuple[object, ...]:
    """Return a row of the table."""
    store = folder / f"{rows}.{'parts' if kind == 'parts' else 'db'}"
    if kind == "parts":
        store.mkdir()
        write = written(store, rows)
        size = sum(file.stat().st_size for file in store.iterdir())
    else:
        write = written_as_one(store, rows)
        size = store.stat().st_size
    return kind, rows, write, size / rows, *alone(tabled, store)


def draw(rows: list[tuple], file: Path) -> None:
    """Draw times, memory and bytes against the number of rows."""
    titles = ("table of all cells [s]", "most memory [MB]", "to write [s]")
    curves = {kind: [(row[1], row[4], row[5], row[2]) for row in rows if row[0] == kind] for kind in KINDS}
    draw_costs(file, "rows", titles, curves)


def main() -> None:
    """Measure, write and draw."""
    args = sizes_parser(__doc__, COUNTS[-1]).parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for kind, most in zip(KINDS, (args.most, min(args.most, 100_000)), strict=True):
            for count in (each for each in COUNTS if each <= most):
                rows.append(shown(measured(kind, count, Path(folder))))
    write_table(args.table, COLUMNS, rows)
    draw(rows, args.picture)


if __name__ == "__main__":
    main()
