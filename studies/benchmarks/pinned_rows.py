"""Uniform and Halton against success rates and milestones that were measured independently, with OMPL's rules.

    python -m studies.benchmarks.pinned_rows [--runs 400] [--only cubicles,chain-10d] [--store results.db] [--jobs 2]

Runs those cells of the paper's suite that have a pinned counterpart
(`evenroad_studies/report/expected/pinned.toml`), in a store of their own, or those that the given store lacks.  For
each cell: our success with its 95 % interval, the mean number of milestones counted as the pinned row counts them, both
beside what is pinned, and Fisher's exact test of the two counts with Holm's correction over all cells that are tested
here.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

from evenroad._terminal import LineProgress
from evenroad_studies.bench.runner import run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Task
from evenroad_studies.report.analysis import Verdict, load_expected, verdicts_of
from evenroad_studies.report.cells import cells_of
from evenroad_studies.report.runs import runs_of
from evenroad_studies.suites import SEED, paper_suite
from evenroad_studies.workers import processes

PINNED = load_expected("pinned")


def pinned_tasks(runs: int, only: list[str]) -> list[Task]:
    """Return the tasks of the paper's suite whose cells are pinned."""
    pinned = {(cell.problem, cell.sampler, cell.rule, cell.n) for cell in PINNED.cells}
    problems = only or sorted({cell.problem for cell in PINNED.cells})
    tasks = paper_suite(runs, only=problems).tasks
    return [task for task in tasks if (task.problem, task.sampler, task.rule, task.n) in pinned]


def line_of(verdict: Verdict) -> str:
    """Return one cell as a line of the table."""
    expected, ours = verdict.expected, verdict.ours
    assert ours is not None
    name = f"{expected.problem:17} {expected.sampler:19} {expected.n:5}"
    success = f"{ours.rate:6.1%} [{ours.interval.low:6.1%}, {ours.interval.high:6.1%}]"
    p = "" if math.isnan(verdict.p) else f", p {verdict.p:.3f}, corrected {verdict.p_corrected:.3f}"
    return (
        f"{name}: {success} of {ours.runs}, pinned {_given(expected.success)} % of {expected.runs or '?'}"
        f" | V ({expected.v_definition}) {verdict.our_v:.1f}, pinned {_given(expected.v)} | {verdict.word}{p}"
    )


def _given(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:g}"


def run(tasks: list[Task], store_path: Path, jobs: int | None) -> tuple[Verdict, ...]:
    """Run what the store lacks; return the verdicts of the cells that these tasks are of."""
    show = LineProgress(f"{len(tasks)} tasks", lambda line: print(line, flush=True))
    with open_store(store_path) as store:
        run_tasks("paper", tasks, store, processes(jobs), callback=show)
    rows = read_rows(store_path, problems=sorted({task.problem for task in tasks}))
    cells = cells_of(runs_of(rows.where(rows.seed == SEED)))
    return tuple(verdict for verdict in verdicts_of(PINNED, cells) if verdict.ours is not None)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument(
        "--only", default="", help="problems with commas between them; default all that are pinned"
    )
    parser.add_argument("--store", type=Path, help="default: a temporary one")
    parser.add_argument("--jobs", type=int)
    options = parser.parse_args()
    tasks = pinned_tasks(options.runs, [name for name in options.only.split(",") if name])
    with tempfile.TemporaryDirectory() as folder:
        verdicts = run(tasks, options.store or Path(folder) / "pinned.db", options.jobs)
    for verdict in verdicts:
        print(line_of(verdict))
    corrected = [verdict.p_corrected for verdict in verdicts if not math.isnan(verdict.p)]
    smallest = f"{min(corrected):.3f}" if corrected else "-"
    print(f"smallest p after Holm's correction over {len(corrected)} cells: {smallest}")


if __name__ == "__main__":
    main()
