"""Cells of a store of parts that is larger than the memory: a problem at a time, from counts of its rows.

Cells never mix problems, so these are the cells that :func:`~evenroad_studies.report.cells.cells_of` makes of all rows
at once, with the same intervals.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterator
from pathlib import Path

from evenroad_studies.bench.rows import joined, read_rows
from evenroad_studies.bench.store_parts import is_parts, parts_of, problems_of, require_folder, rows_of_part
from evenroad_studies.report.cells import Cell, cells_of
from evenroad_studies.report.runs import runs_of

COLUMNS = ("problem", "rule", "search", "sampler", "n", "runs", "solved", "failures", "rate", "low", "high", "interval")


def streamed_cells(store: str | os.PathLike[str]) -> Iterator[tuple[Cell, ...]]:
    """Yield the cells of each problem of a store of parts, in alphabetical order; of one file all at once.

    In memory are the rows of one problem.
    """
    if not is_parts(store):
        yield cells_of(runs_of(read_rows(store)))
        return
    require_folder(store)
    holding: dict[str, list[Path]] = {}
    for part in parts_of(store):
        for problem in problems_of(part):
            holding.setdefault(problem, []).append(part)
    for problem in sorted(holding):
        rows = joined([rows_of_part(part, [problem]) for part in holding.pop(problem)])
        if len(rows):
            yield cells_of(runs_of(rows))


def write_cells(store: str | os.PathLike[str], file: str | os.PathLike[str]) -> int:
    """Write the success of every cell with its interval as CSV; return the number of runs."""
    runs = 0
    with Path(file).open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(COLUMNS)
        for cells in streamed_cells(store):
            for cell in cells:
                runs += cell.runs
                counts = (cell.sampler, cell.n, cell.runs, cell.solved, cell.failures)
                shares = (f"{share:.6g}" for share in (cell.rate, cell.interval.low, cell.interval.high))
                table.writerow([cell.setting.problem, cell.setting.rule, cell.setting.search, *counts, *shares,
                                cell.interval.kind])  # fmt: skip
    return runs
