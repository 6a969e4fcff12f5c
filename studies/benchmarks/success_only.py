"""What it costs to ask for success only, beside a full answer, on the shipped mazes: the same points and rule.

    python -m studies.benchmarks.success_only --runs 5

Milliseconds of CPU time of a whole `plan`, each the least of 25 interleaved runs, without shortening; means over
Halton sets.  "worst" is the largest ratio of one set.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from evenroad.points import draw
from evenroad.roadmap import plan
from evenroad.world.gridmap.shipped import LEVELS, load_maze

REPEATS = 25


def cpu_time(task: Callable[[], object]) -> float:
    """Return the milliseconds of CPU time that a task takes."""
    begin = time.thread_time()
    task()
    return 1e3 * (time.thread_time() - begin)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    for links in (100, None):
        for n in (512, 1024):
            for level in LEVELS:
                maze = load_maze(level)
                query = maze.world(), maze.start, maze.goal
                times = []
                for run in range(options.runs):
                    ask = partial(plan, *query, draw("halton", n, 2, rng=run), links=links, shorten=False)
                    any_path = partial(ask, success_only=True)
                    runs = [(cpu_time(ask), cpu_time(any_path)) for _ in range(REPEATS)]
                    times.append(np.min(runs, axis=0))
                full, some = np.mean(times, axis=0)
                worst = max(b / a for a, b in times)
                print(
                    f"maze {level}, N = {n}, links {links}: full {full:.2f} ms, success only {some:.2f} ms,"
                    f" ratio {some / full:.2f}, worst {worst:.2f}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
