"""What benchmarks by size share: each row a process of its own, what that holds, the table, and cost by size."""

from __future__ import annotations

import argparse
import multiprocessing
import resource
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from studies.benchmarks.rows import parser_of, write_rows

LEAST = 1e-2
"""Costs below this are drawn as this."""


def sizes_parser(doc: str | None, most: float) -> argparse.ArgumentParser:
    """Return a parser of the files to write, a table and a picture, and of the largest size."""
    parser = parser_of(doc)
    parser.add_argument("table", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--most", type=float, default=most, help="no larger sizes")
    return parser


def alone(measured: Callable[..., Any], *given: Any) -> Any:
    """Return what a function measures in a process of its own, where nothing else is held."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(measured, given)


def shown(row: Sequence[Any]) -> Sequence[Any]:
    """Print a row, and return it."""
    print(*_texts(row), flush=True)
    return row


def write_table(out: Path, columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
    """Write rows to a CSV file."""
    write_rows(out, columns, [dict(zip(columns, _texts(row), strict=True)) for row in rows])


def _texts(row: Sequence[Any]) -> list[str]:
    return [f"{value:.4g}" if isinstance(value, float) else str(value) for value in row]


def held() -> float:
    """Return how much memory the process holds [MB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6


def most_held() -> float:
    """Return the most memory that the process has held [MB]."""
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return int(status["VmHWM"].split()[0]) / 1e3


def draw_costs(file: Path, along: str, titles: Sequence[str], curves: Mapping[str, Sequence[Sequence[float]]]) -> None:
    """Draw costs against sizes, both in powers of ten: a panel for each title.

    A curve has rows of a size, and its cost for each title; of a cost that is NaN nothing is drawn.
    """
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, len(titles), figsize=(4 * len(titles), 3.8), constrained_layout=True)
    for label, rows in curves.items():
        if len(rows) == 0:
            continue
        sizes, *costs = np.asarray(rows, dtype=float).T
        for axis, cost in zip(axes, costs, strict=True):
            axis.loglog(sizes, np.maximum(cost, LEAST), marker="o", label=label)
    for axis, title in zip(axes, titles, strict=True):
        axis.set(xlabel=along, title=title)
        axis.grid(alpha=0.3)
    axes[0].legend()
    figure.savefig(file, dpi=110)
