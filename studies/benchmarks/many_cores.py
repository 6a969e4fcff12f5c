"""What more cores give, measured: `er.plan_many` in threads, `evenroad generate` in processes.

    python -m studies.benchmarks.many_cores OUT.csv [--cores 1 2] [--problems 6000] [--queries 100000]

A UR5 among 25 boxes answers the same queries in more and more threads: motions of 0.2 times the way between random free
configurations, and the whole ways, a tenth as many.  Then the command makes sets of `boxes` and `clutter`, of so many
problems for each core.  Times are of the clock, so nothing else should run.  Each answer of more cores is compared with
that of the fewest, byte for byte.
"""

from __future__ import annotations

import hashlib
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from studies.benchmarks.plan_call import BOXES, boxes_around
from studies.benchmarks.rows import parser_of, write_rows

import evenroad as er

COLUMNS = ("what", "cores", "count", "clock [s]", "processor [s]", "a second", "a core, of the first [%]", "same")


def queries(count: int) -> dict[str, tuple[er.ArmWorld, Any, Any]]:
    """Return by name a world, starts and goals."""
    world = er.ArmWorld("ur5", er.Scene.of_boxes(*boxes_around(BOXES)))
    rng = np.random.default_rng(3)
    q = world.robot.random(rng, 20_000)
    q = q[world.valid(q)]
    starts, goals = (q[rng.integers(len(q), size=count)] for _ in range(2))
    near = starts + 0.2 * (goals - starts)
    free = world.valid(near)
    return {
        "short motions": (world, starts[free], near[free]),
        "whole ways": (world, starts[: count // 10], goals[: count // 10]),
    }


def in_threads(asked: tuple[er.ArmWorld, Any, Any], threads: int) -> tuple[int, float, float, list[str]]:
    """Return how many queries were answered, by the clock and by the processor [s], and a digest of the answers."""
    clock, processor = time.perf_counter(), time.process_time()
    results = er.plan_many(*asked, threads=threads)
    took = time.perf_counter() - clock, time.process_time() - processor
    answers = (results.waypoints, results.offsets, results.cost)
    digest = hashlib.sha256(b"".join(np.ascontiguousarray(each).tobytes() for each in answers))
    return len(results), *took, [digest.hexdigest()]


def in_processes(count: int, jobs: int) -> tuple[int, float, float, list[str]]:
    """Return the same of a data set of so many problems, with a digest of each of its files."""
    command = [sys.executable, "-m", "evenroad", "generate", "boxes", "clutter"]
    with tempfile.TemporaryDirectory() as folder:
        before, clock = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        rows = min(1000, count // jobs)
        options = ["--count", str(count), "--rows", str(rows), "--jobs", str(jobs), "-o", f"{folder}/set"]
        subprocess.run([*command, *options], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        took, after = time.perf_counter() - clock, resource.getrusage(resource.RUSAGE_CHILDREN)
        files = sorted(Path(folder, "set").glob("part-*"))
        digests = [hashlib.sha256(file.read_bytes()).hexdigest() for file in files]
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return count, took, spent, digests


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("table", type=Path)
    parser.add_argument("--cores", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--problems", type=int, default=6000, help="of a data set, for each core")
    parser.add_argument("--queries", type=int, default=100_000)
    given = parser.parse_args()
    print(f"{os.cpu_count()} processors, load average of the last minute: {os.getloadavg()[0]:.1f}")
    rows: list[dict[str, Any]] = []
    asked = queries(given.queries)
    for what in (*asked, "data set"):
        first: tuple[float, list[str]] | None = None
        for cores in given.cores:
            if what in asked:
                count, clock, processor, digests = in_threads(asked[what], cores)
            else:
                count, clock, processor, digests = in_processes(given.problems * cores, cores)
            rate = count / clock / cores
            first = first or (rate, digests)
            share = 100.0 * rate / first[0]
            values = (what, cores, count, f"{clock:.2f}", f"{processor:.2f}", f"{count / clock:.0f}", f"{share:.1f}")
            same = all(a == b for a, b in zip(first[1], digests, strict=False))
            rows.append(dict(zip(COLUMNS, (*values, same), strict=True)))
            print(*rows[-1].values(), flush=True)
            write_rows(given.table, COLUMNS, rows)


if __name__ == "__main__":
    main()
