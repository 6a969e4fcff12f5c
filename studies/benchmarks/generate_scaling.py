"""What `evenroad generate` would take on 2, 16 and 1000 cores: parts are measured here, and more cores simulated.

    python -m studies.benchmarks.generate_scaling OUT.csv OUT.png [--robot ur5] [--parts 60] [--problems 3270000]

Parts of 100 problems are made by one process, and by two beside each other, and written as the command writes them.  Of
each its processor time is noted, and what the process that writes pays for it; what two processes lose to each other is
told by the processor time that the same parts take there.  Then cores are simulated: parts of 1000 problems take what
ten of those measured take, drawn again, and go to the cores as the command gives them out, two waiting for each; either
one process writes all (--jobs, --scheduler), or each core has a shard of its own (--shard i/n), and one process copies
the files in the end.  Networks, disks, and what is loaded once are not simulated.
"""

from __future__ import annotations

import heapq
import os
import pickle
import tempfile
import time
from concurrent.futures import Executor
from pathlib import Path

import numpy as np
import numpy.typing as npt
from studies.benchmarks.rows import parser_of
from studies.benchmarks.sizes import draw_costs, most_held, shown, write_table

from evenroad.datasets.folder import write
from evenroad.datasets.part import Request, make_part
from evenroad.datasets.workers import processes

Floats = npt.NDArray[np.float64]
ROWS, WHOLE = 100, 1000
"""How many problems a part has that is measured, and that is simulated."""
CORES = (1, 2, 4, 8, 16, 64, 256, 1000)
COLUMNS = ("cores", "one process writes [h]", "shards [h]", "of the best [%]", "memory of all [GB]")


def timed_part(request: Request, part: int) -> tuple[float, bytes, float]:
    """Return the processor time of a part [s], the part, and the most memory that the process has held [MB]."""
    begin = time.process_time()
    made = make_part(request, part)
    took = time.process_time() - begin
    return took, made, most_held()


def measured(request: Request, executor: Executor) -> tuple[Floats, Floats, float]:
    """Return of each part its processor time, and that of writing it [s]; and memory of a process [GB]."""
    first = [executor.submit(timed_part, request, request.parts - 1 - i) for i in range(2)]
    _ = [each.result() for each in first]  # what is loaded once
    futures = [executor.submit(timed_part, request, part) for part in range(request.parts)]
    took, written, most = [], [], 0
    with tempfile.TemporaryDirectory() as folder:
        for part, future in enumerate(futures):
            seconds, made, held = future.result()
            begin = time.process_time()
            # What a process pays to send and receive, and to write.
            write(Path(folder) / request.name(part), pickle.loads(pickle.dumps(made)))
            took.append(seconds)
            written.append(time.process_time() - begin)
            most = max(most, held)
    return np.array(took), np.array(written), most / 1e3


def by_one_writer(parts: Floats, writes: Floats, cores: int) -> float:
    """Return when all parts are written [s], where one process gives them out and writes them in order."""
    free = [0.0] * cores
    clock, done, given = 0.0, np.zeros(len(parts)), 0
    for part in range(len(parts)):
        # Two for each core wait, or are made; the next one comes when one is written.
        while given < len(parts) and given < part + 2 * cores:
            begin = max(heapq.heappop(free), clock)
            done[given] = begin + parts[given]
            heapq.heappush(free, done[given])
            given += 1
        clock = max(clock, done[part]) + writes[part]
    return clock


def by_shards(parts: Floats, writes: Floats, cores: int) -> float:
    """Return the same where each core makes every so manieth part, and one process copies them all in the end [s]."""
    made = max(float((parts + writes)[shard::cores].sum()) for shard in range(min(cores, len(parts))))
    return made + float(writes.sum())


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("table", type=Path)
    parser.add_argument("picture", type=Path)
    parser.add_argument("--robot", default="ur5")
    parser.add_argument("--parts", type=int, default=60)
    parser.add_argument("--problems", type=float, default=3.27e6)
    args = parser.parse_args()
    request = Request(args.robot, ("boxes", "clutter"), ROWS * args.parts, rows=ROWS)
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    found = {}
    for jobs in (1, 2):
        with processes(jobs).make() as executor:
            begin = time.perf_counter()
            found[jobs] = measured(request, executor)
            wall = time.perf_counter() - begin
        took, written, memory = found[jobs]
        spread = f"{1e3 * took.std() / ROWS:.2f}"
        print(
            f"{jobs} at once: {1e3 * took.mean() / ROWS:.2f} ms a problem (of parts ± {spread}), to write"
            f" {1e3 * written.mean() / ROWS:.3f} ms, {60 * ROWS / took.mean():.0f} problems a minute and core,"
            f" wall {wall:.0f} s, {memory:.2f} GB a process"
        )
    took, written, memory = found[2]
    rng = np.random.default_rng(0)
    draws = rng.integers(len(took), size=(round(args.problems / WHOLE), WHOLE // ROWS))
    parts, writes = took[draws].sum(axis=1), written[draws].sum(axis=1)
    rows = []
    for cores in CORES:
        one, shards = by_one_writer(parts, writes, cores) / 3600, by_shards(parts, writes, cores) / 3600
        best = float(parts.sum()) / cores / 3600
        rows.append(shown((cores, one, shards, 100 * best / min(one, shards), memory * cores)))
    write_table(args.table, COLUMNS, rows)
    curves = {
        "one process writes": [(cores, one, memory) for cores, one, _, _, memory in rows],
        "shards": [(cores, shards, memory) for cores, _, shards, _, memory in rows],
        "no loss": [(cores, rows[0][1] / cores, memory) for cores, *_, memory in rows],
    }
    draw_costs(args.picture, "cores", (f"{args.problems:.3g} problems [h]", "memory [GB]"), curves)


if __name__ == "__main__":
    main()
