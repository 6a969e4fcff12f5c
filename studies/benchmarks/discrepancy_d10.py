"""The paper's discrepancy figure, redrawn: Hickernell L2 discrepancy in d = 10, N = 128 .. 1024, every family.

    python -m studies.benchmarks.discrepancy_d10 --out out/bench
    python -m studies.benchmarks.discrepancy_d10 -d 2                   # the same in another dimension

Each number is the mean over 20 draws (over the pool for trained families), with its standard deviation.  Both
conventions for Halton are shown: its first block from index 0, which holds the origin of the cube, and the blocks from
index 1 that the paper describes.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from evenroad.points import PointSet, draw
from evenroad.points.bank import Bank
from evenroad.points.measures import MEASURES
from evenroad.points.samplers import Halton, Sobol
from evenroad_studies.report.write import csv_text

COUNTS = (128, 256, 512, 1024)
DRAWS = range(20)


def pool(family: str, n: int, d: int) -> list[PointSet]:
    """Return the trained sets of a family; none where the bank has none."""
    bank = Bank()
    return [PointSet(each) for each in bank.cell(family, n, d).load()] if bank.has(family, n, d) else []


def drawn(name: str, n: int, d: int) -> list[PointSet]:
    """Return sets of a sampler."""
    return [draw(name, n, d, rng=run) for run in DRAWS]


FAMILIES = {
    "uniform": partial(drawn, "uniform"),
    "halton from index 0": lambda n, d: [Halton(scramble=False).draw(n, d)],
    "halton paper-blocks": lambda n, d: [Halton(scramble=False, start=i * n + 1).draw(n, d) for i in DRAWS],
    "halton scrambled": partial(drawn, "halton"),
    "sobol paper-blocks": lambda n, d: [Sobol(scramble=False, start=i * n + 1).draw(n, d) for i in DRAWS],
    "sobol scrambled": partial(drawn, "sobol"),
    "lattice": partial(drawn, "lattice"),
    "korobov (even)": partial(drawn, "korobov"),
    "mpmc": partial(pool, "mpmc"),
    "hickernell": partial(pool, "hickernell"),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    parser.add_argument("-d", type=int, default=10, help="dimension")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    figure = Figure(figsize=(7.5, 5), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(xlabel="N", ylabel="Hickernell L2 discrepancy (rooted)", title=f"d = {options.d}")
    rows: list[tuple[str, int, float, float, float, int]] = []
    for name, sets_of in FAMILIES.items():
        cells = []
        for n in COUNTS:
            values = [MEASURES["hickernell"].rooted(points) for points in sets_of(n, options.d)]
            if values:
                spread = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
                cells.append((name, n, float(np.mean(values)), spread, min(values), len(values)))
        for _, n, mean, spread, best, count in cells:
            print(f"{name:20} N={n:4}: {mean:.4f} ± {spread:.4f} (best {best:.4f}, {count} sets)", flush=True)
        axes.loglog([cell[1] for cell in cells], [cell[2] for cell in cells], marker="o", label=name)
        rows += cells
    axes.set_xticks(COUNTS, [str(n) for n in COUNTS], minor=False)
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.savefig(options.out / f"discrepancy_d{options.d}.png")
    table = options.out / f"discrepancy_d{options.d}.csv"
    table.write_bytes(csv_text("family n mean standard_deviation best sets", rows))


if __name__ == "__main__":
    main()
