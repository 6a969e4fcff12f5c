"""The paper's network as printed, trained: its sets beside published and other ones, and the loss over the steps.

    python -m studies.benchmarks.printed_network --train OUT     # minutes a pool on one core; goes on where it stopped
    python -m studies.benchmarks.printed_network --train OUT --steps 300 --refine 5000 --only d2-n128-8
    python -m studies.benchmarks.printed_network --table OUT --csv SETS.csv --curves CURVES.csv --picture CURVES.png

A pool is a batch of sets that one network makes of random points.  The network is the published one: points within
0.35, at most 32, send messages, two linear maps each; three layers of width 64; positions are cut off at the faces.
Training is 3000 steps of Adam from 1e-3 along a half cosine, weight decay 1e-6, Hickernell's discrepancy, seed 0.
Rows that differ say in what.  Mazes are asked with k = 10 symmetrised, start and goal linked by the rule: solved sets,
in percent.  `--only` trains some pools alone, `--steps` for another number of steps.  `--refine` anneals the sets of
trained pools on, which the paper does not: NAME-refined in the table.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.spatial.distance import pdist
from studies.benchmarks.rows import parser_of, write_rows

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad.points import draw
from evenroad.points.bank import TRAINED_FAMILIES, Bank
from evenroad.points.measures import MEASURES, star_discrepancy
from evenroad.points.measures.covering import dispersion_bounds
from evenroad.points.pointset import Origin, PointSet
from evenroad_studies.connected import connected
from evenroad_studies.network import refine
from evenroad_studies.network.printed import Printed, train_printed
from evenroad_studies.problems import PROBLEMS

EVERY = 100
"""Steps between two points of a kept curve; a pool is written after ten times as many."""


def _pool(n: int, d: int, sets: int) -> Printed:
    return Printed(n, d, sets, steps=3_000)


POOLS = {
    f"d{d}-n{n}-8": _pool(n, d, 8) for n, d in ((64, 2), (128, 2), (256, 2), (128, 3), (256, 5), (128, 6), (128, 10))
}
POOLS |= {f"d2-n{n}-{sets}": _pool(n, 2, sets) for n in (64, 128) for sets in (16, 32)}
POOLS |= {"d2-n64-8-nearest": replace(_pool(64, 2, 8), radius=None)}
POOLS |= {"d2-n64-8-sigmoid": replace(_pool(64, 2, 8), end="sigmoid")}
"""Name -> what is trained, in the order in which it is."""


@dataclass(frozen=True, eq=False)
class Pool:
    """A pool as far as it is trained: steps done, sets (sets, n, d), the mean loss at every 100th step, seconds."""

    step: int
    points: Floats
    curve: Floats
    seconds: float


def load_pool(path: Path) -> Pool:
    """Return the pool of a file."""
    with np.load(path, allow_pickle=False) as file:
        return Pool(int(file["step"]), file["points"].astype(np.float64), file["curve"], float(file["seconds"]))


def train_pool(name: str, config: Printed, folder: Path) -> None:
    """Train a pool and write it into FOLDER/NAME.npz as it gets better."""
    path, curve, begin = folder / f"{name}.npz", [], time.process_time()

    def seen(step: int, loss: float, points: Floats) -> None:
        if step % EVERY == 0:
            curve.append(loss)
        if step % (10 * EVERY) == 0 or step == config.steps:
            seconds = time.process_time() - begin
            with atomic_write(path) as file:
                np.savez(file, step=step, points=points.astype(np.float32), curve=curve, seconds=seconds)
            print(f"{name}: step {step} of {config.steps}, mean loss {loss:.6f}, {seconds:.0f} s", flush=True)

    train_printed(config, rng=0, seen=seen)


def refine_pool(name: str, folder: Path, steps: int) -> None:
    """Anneal the sets of a pool on, and write them into FOLDER/NAME-refined.npz."""
    config, pool, begin = POOLS[name], load_pool(folder / f"{name}.npz"), time.process_time()
    bests, curve = np.zeros((len(pool.points), steps)), slice(EVERY - 1, None, EVERY)

    def seen(step: int, _: int, best: float) -> None:
        bests[(step - 1) // steps, (step - 1) % steps] = best

    origins = (Origin(family="mpmc", objective=config.objective, replica=i) for i in range(len(pool.points)))
    sets = refine(list(map(PointSet, pool.points, origins)), steps=steps, callback=seen)
    points, seconds = np.stack([each.points for each in sets]), pool.seconds + time.process_time() - begin
    with atomic_write(folder / f"{name}-refined.npz") as file:
        np.savez(file, step=steps, points=points.astype(np.float32), curve=bests.mean(axis=0)[curve], seconds=seconds)
    print(f"{name}: annealed on from step {pool.step}, mean loss {bests[:, -1].mean():.6f}, {seconds:.0f} s in all")


MAZES = {64: (1, 2), 128: (2,), 256: (3,)}
"""Number of points in the plane -> levels of mazes that are asked with so many."""
BESIDE = ("mpmc", "hickernell", "even", "sobol")
"""What stands beside the pools: those of the bank, and 16 draws of samplers."""


def sets_beside(name: str, n: int, d: int) -> list[Floats]:
    """Return the pool of a family in the bank, or 16 draws of a sampler."""
    if name in TRAINED_FAMILIES:
        return list(Bank().cell(name, n, d).load().astype(np.float64))
    return [draw(name, n, d, rng=seed).points for seed in range(16)]


def row_of(name: str, n: int, d: int, sets: list[Floats]) -> dict[str, str]:
    """Return the mean measures of sets, and how many solve each maze [%]."""
    l2 = {name: [MEASURES[name].rooted(each) for each in sets] for name in ("hickernell", "star")}
    stars = [star_discrepancy(each) for each in sets] if d <= 3 else []
    row = {"d": str(d), "n": str(n), "sets": name, "of": str(len(sets))}
    row |= {f"L2 {kind}": f"{np.mean(values):.5f}" for kind, values in l2.items()}
    row["L2 hickernell best"] = f"{min(l2['hickernell']):.5f}"
    if stars:
        row |= {"star": f"{np.mean(stars):.4f}", "star best": f"{min(stars):.4f}"}
        row["largest hole"] = f"{np.mean([dispersion_bounds(each).upper for each in sets]):.4f}"
    row["least gap"] = f"{np.mean([pdist(each).min() for each in sets]):.4f}"
    for level in MAZES.get(n, ()) if d == 2 else ():
        problem = PROBLEMS[f"maze-{level}"].make(0)
        row[f"maze {level}"] = f"{100 * np.mean([connected(problem, each, (10,))[0, 0] for each in sets]):.0f}"
    return row


def table(folder: Path, out: Path | None) -> dict[str, Pool]:
    """Print a row for each pool and what stands beside it, and return the pools."""
    names = [f"{name}{end}" for name in POOLS for end in ("", "-refined")]
    pools = {name: load_pool(folder / f"{name}.npz") for name in names if (folder / f"{name}.npz").exists()}
    rows, beside = [], set()
    for name, pool in pools.items():
        config = POOLS[name.removesuffix("-refined")]
        n, d = config.n, config.d
        row = row_of(name, n, d, list(pool.points))
        rows.append(row | {"steps": str(pool.step), "seconds": f"{pool.seconds:.0f}"})
        for other in BESIDE if (n, d) not in beside else ():
            rows.append(row_of(other, n, d, sets_beside(other, n, d)))
        beside.add((n, d))
    rows.sort(key=lambda row: (int(row["d"]), int(row["n"])))
    columns = list(dict.fromkeys(column for row in rows for column in row))
    print(*columns, sep=" | ")
    for row in rows:
        print(*(row.get(column, "") for column in columns), sep=" | ")
    write_rows(out, columns, rows)
    return pools


def draw_curves(pools: dict[str, Pool], path: Path) -> None:
    """Draw the mean loss of each pool over the steps."""
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    axes.set_prop_cycle(color=colormaps["tab20"].colors)
    for name, pool in pools.items():
        axes.loglog(EVERY * np.arange(1, len(pool.curve) + 1), pool.curve, label=name, linewidth=1.2)
    axes.set(xlabel="steps", ylabel="mean D_H of the batch")
    axes.legend(fontsize=7, ncols=2, frameon=False)
    FigureCanvasAgg(figure).print_png(path)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--train", type=Path, help="folder of the pools, made if it is missing")
    parser.add_argument("--only", nargs="*", choices=POOLS, default=list(POOLS))
    parser.add_argument("--steps", type=int, help="of each training; default: 3000")
    parser.add_argument("--refine", type=int, default=0, help="steps of annealing after the training")
    parser.add_argument("--table", type=Path, help="folder of the pools")
    parser.add_argument("--csv", type=Path)
    parser.add_argument("--curves", type=Path)
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    if options.table:
        pools = table(options.table, options.csv)
        curves = (
            {"sets": name, "step": str(EVERY * (i + 1)), "loss": f"{loss:.6g}"}
            for name, pool in pools.items()
            for i, loss in enumerate(pool.curve)
            if i % 10 == 9
        )
        write_rows(options.curves, ("sets", "step", "loss"), curves)
        if options.picture:
            draw_curves(pools, options.picture)
    if options.train:
        options.train.mkdir(exist_ok=True)
        for name in options.only:
            config = replace(POOLS[name], steps=options.steps or POOLS[name].steps)
            path = options.train / f"{name}.npz"
            if not path.exists() or load_pool(path).step < config.steps:
                train_pool(name, config, options.train)
            if options.refine:
                refine_pool(name, options.train, options.refine)


if __name__ == "__main__":
    main()
