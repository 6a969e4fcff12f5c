"""The paper's discrepancy figure, redrawn: Hickernell L2 discrepancy in d = 10, N = 128 .. 1024, every family.

    python -m studies.benchmarks.discrepancy_d10 --out out/bench
    python -m studies.benchmarks.discrepancy_d10 -d 2                   # the same in another dimension

Each number is the mean over 20 draws (over the pool for trained families), with its standard deviation.  Both
conventions for Halton are shown: its first block from index 0, which holds the origin of the cube, and the blocks from
index 1 that the paper describes.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from evenroad.points import PointSet, draw
from evenroad.points.bank import Bank
from evenroad.points.measures import MEASURES
from evenroad.points.samplers import Halton, Sobol

D = 10
COUNTS = (128, 256, 512, 1024)
DRAWS = 20


def _pool(family: str, n: int, d: int) -> list[PointSet]:
    bank = Bank()
    return [PointSet(each) for each in bank.cell(family, n, d).load()] if bank.has(family, n, d) else []


def _drawn(name: str) -> Callable[[int, int], list[PointSet]]:
    return lambda n, d: [draw(name, n, d, rng=run) for run in range(DRAWS)]


FAMILIES: dict[str, Callable[[int, int], list[PointSet]]] = {
    "uniform": _drawn("uniform"),
    "halton from index 0": lambda n, d: [Halton(scramble=False).draw(n, d)],
    "halton paper-blocks": lambda n, d: [
        Halton(scramble=False, start=run * n + 1).draw(n, d) for run in range(DRAWS)
    ],
    "halton scrambled": _drawn("halton"),
    "sobol paper-blocks": lambda n, d: [
        Sobol(scramble=False, start=run * n + 1).draw(n, d) for run in range(DRAWS)
    ],
    "sobol scrambled": _drawn("sobol"),
    "lattice": _drawn("lattice"),
    "korobov (even)": _drawn("korobov"),
    "mpmc": lambda n, d: _pool("mpmc", n, d),
    "hickernell": lambda n, d: _pool("hickernell", n, d),
}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    parser.add_argument("-d", type=int, default=D, help="dimension")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    measure = MEASURES["hickernell"].rooted
    figure = Figure(figsize=(7.5, 5), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    rows = []
    print(
        f"| D_H, d={options.d} | "
        + " | ".join(f"N={n}" for n in COUNTS)
        + " |\n|---"
        + "|---" * len(COUNTS)
        + "|"
    )
    for place, (name, sets_of) in enumerate(FAMILIES.items()):
        cells = []
        for n in COUNTS:
            values = [measure(points) for points in sets_of(n, options.d)]
            if values:
                cells.append(
                    (
                        n,
                        np.mean(values),
                        np.std(values, ddof=1) if len(values) > 1 else 0.0,
                        np.min(values),
                        len(values),
                    )
                )
        rows += [(name, *cell) for cell in cells]
        text = {
            n: f"{mean:.4f} ± {spread:.4f} (best {best:.4f}, {count})" if count > 1 else f"{mean:.4f}"
            for n, mean, spread, best, count in cells
        }
        print(f"| {name} | " + " | ".join(text.get(n, "no set") for n in COUNTS) + " |", flush=True)
        if cells:
            trained = name in ("hickernell", "mpmc")
            axes.plot(
                [cell[0] for cell in cells],
                [cell[1] for cell in cells],
                marker="os^vD"[place % 5],
                linestyle="-" if trained or "scrambled" in name or name == "uniform" else "--",
                linewidth=2.4 if trained else 1.4,
                color=f"C{place}",
                label=name,
            )
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    axes.set_xticks(COUNTS, [str(n) for n in COUNTS])
    axes.yaxis.set_minor_formatter(NullFormatter())
    if options.d == D:
        axes.set_yticks((0.05, 0.1, 0.2, 0.5), ("0.05", "0.1", "0.2", "0.5"))
    axes.set_xlabel("N")
    axes.set_ylabel("Hickernell L2 discrepancy (rooted)")
    axes.set_title(f"d = {options.d}")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=8)
    figure.savefig(options.out / f"discrepancy_d{options.d}.png")
    with open(options.out / f"discrepancy_d{options.d}.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["family", "n", "mean", "standard deviation", "best", "sets"])
        writer.writerows(rows)


if __name__ == "__main__":
    main()
