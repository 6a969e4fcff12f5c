"""Success of ps-PRM on the three shipped mazes: every sampler, N = 32 .. 1024.

    python -m benchmarks.maze_success --runs 400 --out out/bench

Connection: k = 10 symmetrised, and beside it the radius rule r = gamma sqrt(log V / V) of PRM* (Karaman and Frazzoli
2011).  Run i of a random sampler draws with seed i; run i of `paper-blocks` takes the points (i-1) N + 1 .. i N of the
plain sequence.  On a fixed maze a trained set either solves the query or it does not, so of `hickernell` every set of
the pool is taken once: 64 runs, not 400.  `even` is the same as `korobov` in the plane.  Intervals are Wilson's, 95 %.
"""

from __future__ import annotations

import argparse
import csv
import math
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from benchmarks.intervals import wilson
from evenroad.mazes import LEVELS, load_maze
from evenroad.points import PointSet, draw
from evenroad.points.bank import open_bank
from evenroad.points.samplers.sequences import Halton, Sobol, paper_block
from evenroad.roadmap import KNearest, Radius, plan

COUNTS = (32, 64, 128, 256, 512, 1024)
GAMMA_SHARE = 1.0
"""gamma = this x the PRM* constant 2 (1 + 1/d)^(1/d) (free area / area of the unit disk)^(1/d)."""

DRAWS = {
    "uniform": lambda n, run: draw("uniform", n, 2, rng=run),
    "halton paper-blocks": lambda n, run: paper_block(Halton(), run + 1, n).draw(n, 2),
    "halton scrambled": lambda n, run: draw("halton", n, 2, rng=run),
    "sobol paper-blocks": lambda n, run: paper_block(Sobol(), run + 1, n).draw(n, 2),
    "sobol scrambled": lambda n, run: draw("sobol", n, 2, rng=run),
    "lattice": lambda n, run: draw("lattice", n, 2, rng=run),
    "korobov": lambda n, run: draw("korobov", n, 2, rng=run),
    "hickernell": lambda n, run: PointSet(open_bank().cell("hickernell", n, 2).load()[run]),
    "even": lambda n, run: draw("even", n, 2, rng=run),
}


@dataclass(frozen=True)
class Row:
    level: int
    rule: str
    sampler: str
    n: int
    runs: int
    solved: int
    success: float
    low: float
    high: float
    mean_valid: float
    mean_edges_checked: float


def measure(level: int, rule: str, sampler: str, n: int, runs: int) -> Row:
    """Run one cell of the table."""
    maze = load_maze(level)
    world = maze.world()
    free_area = float(world.valid(world.space.from_cube(draw("sobol", 2**16, 2).points)).mean()) * 640 * 480
    if sampler == "hickernell":
        runs = open_bank().cell(sampler, n, 2).sets
    solved, valid, edges = 0, [], []
    for run in range(runs):
        points: PointSet = DRAWS[sampler](n, run)
        connect = KNearest(10)
        if rule == "radius":
            milestones = int(world.valid(world.space.from_cube(points.points)).sum()) + 2
            gamma = GAMMA_SHARE * 2 * math.sqrt(1.5) * math.sqrt(free_area / math.pi)
            connect = Radius(gamma * math.sqrt(math.log(milestones) / milestones))
        result = plan(world, maze.start, maze.goal, points, rule=connect, shorten=False)
        solved += result.solved
        valid.append(result.counts["valid"])
        edges.append(result.counts["edges_checked"])
    low, high = wilson(solved, runs)
    means = float(np.mean(valid)), float(np.mean(edges))
    return Row(level, rule, sampler, n, runs, solved, solved / runs, low, high, *means)


def table(rows: list[Row], rule: str) -> str:
    """Return the success rates as Markdown, one table a level."""
    parts = []
    for level in LEVELS:
        header = f"| level {level}, {rule} | " + " | ".join(f"N={n}" for n in COUNTS) + " |"
        lines = [header, "|---" * (len(COUNTS) + 1) + "|"]
        for sampler in DRAWS:
            cells = []
            for n in COUNTS:
                row = next(r for r in rows if (r.level, r.rule, r.sampler, r.n) == (level, rule, sampler, n))
                cells.append(f"{100 * row.success:.1f} [{100 * row.low:.0f}, {100 * row.high:.0f}]")
            lines.append(f"| {sampler} | " + " | ".join(cells) + " |")
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def picture(rows: list[Row], path: Path) -> None:
    """Draw success against N, a panel a level, with intervals."""
    figure = Figure(figsize=(13, 4.6), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(1, len(LEVELS), sharey=True)
    styles = {
        "uniform": ("#555555", "-", "o"),
        "halton": ("#1b9e5a", "-", "s"),
        "sobol": ("#2f5fd0", "-", "^"),
    }
    styles |= {"hickernell": ("#b07ad1", "-", "D"), "lattice": ("#e6a23c", "-", "v")}
    styles |= {"korobov": ("#8a5a2b", "-", "P"), "even": ("#d1343b", "-", "*")}
    for axes, level in zip(panels, LEVELS, strict=True):
        for sampler in DRAWS:
            colour, line, marker = styles[sampler.split()[0]]
            cells = [r for r in rows if (r.level, r.rule, r.sampler) == (level, "k=10", sampler)]
            rates = np.array([100 * r.success for r in cells])
            errors = np.abs(np.array([[100 * r.low, 100 * r.high] for r in cells]).T - rates)
            axes.errorbar(
                [r.n for r in cells],
                rates,
                yerr=errors,
                color=colour,
                linestyle="--" if "paper" in sampler else line,
                marker=marker,
                markersize=5,
                capsize=2,
                linewidth=1.4,
                label=sampler,
            )
        axes.set_xscale("log", base=2)
        axes.set_xticks(COUNTS, [str(n) for n in COUNTS])
        axes.set_xlabel("N")
        axes.set_title(f"maze level {level}, k = 10 symmetrised")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("success [%]")
    panels[-1].legend(fontsize=8, loc="upper left")
    figure.savefig(path)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    cells = [
        (level, rule, s, n) for rule in ("k=10", "radius") for level in LEVELS for s in DRAWS for n in COUNTS
    ]
    rows = []
    with (
        ProcessPoolExecutor(options.jobs) as pool,
        open(options.out / "maze_success.csv", "w", newline="") as file,
    ):
        writer = csv.DictWriter(file, fieldnames=list(Row.__dataclass_fields__))
        writer.writeheader()
        futures = [pool.submit(measure, *cell, options.runs) for cell in cells]
        for done, future in enumerate(futures, 1):
            rows.append(future.result())
            writer.writerow(asdict(rows[-1]))
            file.flush()
            print(
                f"{done}/{len(cells)} {rows[-1].level} {rows[-1].rule} {rows[-1].sampler} {rows[-1].n}",
                end="\r",
            )
    text = "\n".join(table(rows, rule) for rule in ("k=10", "radius"))
    (options.out / "maze_success.md").write_text(text)
    picture(rows, options.out / "maze_success.png")
    print("\n" + text)


if __name__ == "__main__":
    main()
