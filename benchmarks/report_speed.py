"""Time of a report of a million rows, phase by phase.

    python -m benchmarks.report_speed --rows 1000000 --out out/bench

The store is made up, in the shape of the real suites: half of it problems of the paper's table (their names, so that
scenes and verdicts are drawn and tested, too), half random worlds under four rules; two of the samplers draw from
pools of 64 sets.  Each phase is run `repeats` times; the median is printed.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from evenroad_studies.bench.samplers import SAMPLERS
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.report import write_report
from evenroad_studies.report.analysis import analyse

POOLS = ("mpmc", "hickernell")
POOL = 64
COUNTS = (128, 256, 512, 1024)
FAIR_RULES = tuple(f"k={k} symmetrised" for k in (4, 6, 10, 20))
DRAWS_PER_WORLD = 3


def paper_cells() -> Iterator[tuple[str, str, str, str, int, bool]]:
    """Yield (problem, rule, search, sampler, n, random) of problems that exist."""
    fixed = [name for name, source in PROBLEMS.items() if not source.random]
    for problem, sampler, n in itertools.product(fixed, SAMPLERS, COUNTS):
        symmetrised = problem.startswith(("maze", "ur5"))
        rule, search = ("k=10 symmetrised", "connect") if symmetrised else ("k=10 earlier", "stock")
        yield problem, rule, search, sampler, n, False


def fair_cells() -> Iterator[tuple[str, str, str, str, int, bool]]:
    """Yield the same of random worlds; their names are all that counts here."""
    problems = [
        f"fair-{kind}-{d}d-{level}"
        for kind, d, level in itertools.product(("balls", "boxes"), (2, 3, 5, 7, 10), (25, 50, 75))
    ]
    for problem, rule, sampler in itertools.product(problems, FAIR_RULES, SAMPLERS):
        yield problem, rule, "connect", sampler, 256, True


def fill(path: Path, rows: int) -> int:
    """Write about so many rows; return how many."""
    rng = np.random.default_rng(0)
    written = 0
    with open_store(path) as store:
        for cells in (list(paper_cells()), list(fair_cells())):
            for problem, rule, search, sampler, n, random in cells:
                runs = rows // (2 * len(cells))
                solved = rng.random(runs) < min(0.95, n / 1100 + 0.04 * list(SAMPLERS).index(sampler))
                of_pool = rng.integers(POOL, size=runs)
                for run in range(runs):
                    instance = run // DRAWS_PER_WORLD if random else 0
                    task = Task(problem, instance, sampler, n, rule, search, run, 0)
                    outcome = Outcome(
                        "solved" if solved[run] else "not_connected",
                        valid=n // 2 + run % 7,
                        edges_checked=n + run % 31,
                        seconds=1e-5 * n,
                        set_id=str(of_pool[run]) if sampler in POOLS else "",
                    )
                    store.add("made up", task, outcome, "here:1")
                store.commit_if_due()
                written += runs
    return written


def median_seconds(action: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        began = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - began)
    return statistics.median(seconds)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rows", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=options.out) as folder:
        store = Path(folder) / "made-up.db"
        began = time.perf_counter()
        written = fill(store, options.rows)
        print(f"{written} rows written in {time.perf_counter() - began:.1f} s")
        rows = read_rows(store)
        phases: dict[str, Callable[[], object]] = {
            "read": lambda: read_rows(store),
            "analyse": lambda: analyse(rows),
            "whole report": lambda: write_report(store, Path(folder) / "report"),
        }
        for name, action in phases.items():
            print(f"{name}: {median_seconds(action, options.repeats):.2f} s", flush=True)


if __name__ == "__main__":
    main()
