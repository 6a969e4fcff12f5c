"""Chain, Cubicles and Twistycool against counts that were measured with OMPL's rules and the original scenes.

    python -m benchmarks.pinned_rows [--runs 400] [--only cubicles ...]

k = 10 earlier, start and goal inserted first, stopped at the first solution.  For each cell: our successes and the
mean of the valid milestones that had been added, those pinned, and Fisher's exact test of the two counts of
successes, with Holm's correction over all cells.  Valid milestones leave out start and goal.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad.bench.execute import run_task
from evenroad.bench.statistics import fisher_exact, holm, wilson
from evenroad.bench.task import Task

NUMBERS = (128, 256, 512, 1024)

PINNED: dict[tuple[str, str], tuple[int, tuple[int | None, ...], tuple[float | None, ...]]] = {
    ("chain-10d", "uniform"): (60, (3, 7, 17, 37), (27.0, 52.2, 97.8, 157.2)),
    ("chain-10d", "halton paper-blocks"): (50, (1, 5, 11, 31), (None,) * 4),
    ("cubicles", "uniform"): (50, (0, None, 2, 12), (54.9, 109.8, 219.5, None)),
    ("cubicles", "halton paper-blocks"): (50, (0, None, 6, 27), (None,) * 4),
    ("twistycool", "uniform"): (50, (1, 5, 15, 37), (90.0, 171.0, 306.0, 484.0)),
    ("twistycool", "halton paper-blocks"): (50, (4, 7, 17, 31), (None,) * 4),
}
"""Problem and sampler -> runs, successes for each N, mean valid milestones for each N (None: not measured)."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--only", nargs="*", help="problems; default all")
    options = parser.parse_args()
    p_values, lines = [], []
    for (problem, sampler), (pinned_runs, pinned, pinned_valid) in PINNED.items():
        if options.only and problem not in options.only:
            continue
        for n, successes, pinned_mean in zip(NUMBERS, pinned, pinned_valid, strict=True):
            began = time.perf_counter()
            outcomes = [
                run_task(Task(problem, 0, sampler, n, "k=10 earlier", "stock", run, 0))
                for run in range(options.runs)
            ]
            seconds = (time.perf_counter() - began) / options.runs
            failed = [outcome.error for outcome in outcomes if outcome.error]
            assert not failed, failed[0]
            solved = sum(outcome.solved for outcome in outcomes)
            added = [
                outcome.valid if outcome.valid_at_solution is None else outcome.valid_at_solution
                for outcome in outcomes
            ]
            low, high = wilson(solved, options.runs)
            line = (
                f"{problem:11} {sampler:20} {n:5}: {solved / options.runs:6.1%}"
                f" [{low:.1%}, {high:.1%}] V {np.mean(added):6.1f}"
                f" +- {np.std(added) / len(added) ** 0.5:.1f} of {np.mean([o.valid for o in outcomes]):6.1f}"
                f" | pinned {'-' if successes is None else f'{successes / pinned_runs:.0%}':>4}"
                f" V {'-' if pinned_mean is None else pinned_mean:>6} | {1e3 * seconds:6.1f} ms a run"
            )
            if successes is not None:
                p_values.append(fisher_exact((solved, options.runs), (successes, pinned_runs)))
                line += f" | p {p_values[-1]:.3f}"
            print(line, flush=True)
            lines.append(line)
    print(f"smallest p after Holm's correction over {len(p_values)} cells: {min(holm(p_values)):.3f}")


if __name__ == "__main__":
    main()
