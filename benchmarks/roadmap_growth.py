"""Time and memory of the neighbour graph, k = 10 in six dimensions, from a thousand to a million points.

    python -m benchmarks.roadmap_growth --largest 1000000 --out out/bench

Every size runs in a process of its own, so that its peak memory is its own; `memory` is the peak above that of the
points alone.  CPU seconds of one thread, the median of the repeats (one from 3 10^5 on).
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from evenroad.roadmap import KEarlier, KNearest
from evenroad.roadmap.neighbours import nearest

SIZES = (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000)
EARLIER_LARGEST = 100_000


@dataclass(frozen=True)
class Row:
    n: int
    nearest: float
    symmetrised: float
    earlier: float
    memory: float
    edges: int


def _peak() -> float:
    """Return the peak memory of this process in MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def measure(n: int, d: int, k: int) -> Row:
    """Return one size; to be run in a fresh process."""
    points = np.random.default_rng(0).random((n, d))
    few = points[:100]
    KNearest(k).edges(few), KEarlier(k).edges(few)
    before = _peak()
    repeats = 3 if n < 300_000 else 1
    edges = KNearest(k).edges(points)
    memory = _peak() - before

    def seconds(task: object) -> float:
        times = []
        for _ in range(repeats):
            begin = time.process_time()
            task()  # type: ignore[operator]
            times.append(time.process_time() - begin)
        return statistics.median(times)

    earlier = seconds(lambda: KEarlier(k).edges(points)) if n <= EARLIER_LARGEST else float("nan")
    return Row(
        n,
        seconds(lambda: nearest(points, k)),
        seconds(lambda: KNearest(k).edges(points)),
        earlier,
        memory,
        len(edges),
    )


def picture(rows: list[Row], path: Path) -> None:
    """Draw time and memory against n, with a line of slope one beside each."""
    figure = Figure(figsize=(10, 4.2), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    sizes = np.array([row.n for row in rows])
    for name, marker in (("nearest", "o"), ("symmetrised", "s"), ("earlier", "^")):
        left.loglog(sizes, [getattr(row, name) for row in rows], marker=marker, label=name)
    left.loglog(sizes, rows[0].symmetrised * sizes / sizes[0], color="#999999", linestyle=":", label="~ n")
    left.set_ylabel("CPU seconds, one thread")
    memory = np.array([max(row.memory, 0.1) for row in rows])
    right.loglog(sizes, memory, marker="o", label="peak above the points")
    right.loglog(sizes, memory[-1] * sizes / sizes[-1], color="#999999", linestyle=":", label="~ n")
    right.set_ylabel("MB")
    for axes in (left, right):
        axes.set_xlabel("n")
        axes.grid(alpha=0.3)
        axes.legend()
    figure.suptitle("k = 10 neighbour graph, d = 6, uniform points")
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--largest", type=int, default=SIZES[-1])
    parser.add_argument("-d", type=int, default=6)
    parser.add_argument("-k", type=int, default=10)
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    print("| n | k nearest s | symmetrised edges s | earlier edges s | MB | edges | MB / (n k) 10^6 |")
    print("|" + "---|" * 7)
    for n in SIZES:
        if n > arguments.largest:
            break
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            row = pool.apply(measure, (n, arguments.d, arguments.k))
        rows.append(row)
        share = 1e6 * row.memory / (n * arguments.k)
        print(
            f"| {n} | {row.nearest:.3f} | {row.symmetrised:.3f} | {row.earlier:.3f} | {row.memory:.0f} |"
            f" {row.edges} | {share:.0f} |",
            flush=True,
        )
    picture(rows, arguments.out / "roadmap_growth.png")


if __name__ == "__main__":
    main()
