"""Sequences, judged by their beginnings: discrepancy, spread, and planning in random worlds at many lengths.

    python -m benchmarks.sequences discrepancy           # ratios to scrambled Sobol points, d = 2, 3, 4, 5, 7, 10
    python -m benchmarks.sequences spread                # Riesz energy, separation and dispersion
    python -m benchmarks.sequences plan --worlds 200     # worlds of the reporting stream; --tuning: those that chose
    python -m benchmarks.sequences anytime --worlds 150  # points that `plan_anytime` needs, beside Sobol's
    python -m benchmarks.sequences picture               # docs/sequences.png, from the csv files of the others

`kronecker` is i (g^-1, .., g^-d) modulo 1 with g^(d+1) = g + 1, shifted; `greedy` the paper's way, an annealed set in
the order in which each next point leaves the lowest discrepancy; `objective` annealing and the network on
`prefixes(hickernell)` from scratch; `even` is no sequence but a new lattice for every n: what could be had.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.nested_k import smallest_k
from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.points.bank import Bank
from evenroad.points.measures import dispersion_l2, riesz_rooted, separation
from evenroad.points.samplers import Growing, Sobol
from evenroad.roadmap import Budget, plan_anytime
from evenroad_studies.network import NetworkConfig
from evenroad_studies.prefixes import rooted_prefixes
from evenroad_studies.problems.fair import DIFFICULTIES, SIZES, Family, Stream, make_instance
from evenroad_studies.sequence import Sequence
from evenroad_studies.training import anneal_many, train_many

LENGTHS = (
    16,
    20,
    24,
    32,
    40,
    50,
    64,
    77,
    100,
    128,
    150,
    181,
    200,
    256,
    300,
    362,
    400,
    512,
    724,
    1024,
    1448,
    2048,
)
SCRAMBLES, SEED = 32, 1000
NEIGHBOURS = (4, 6, 10, 20)
DATA = Path("docs/data")


def kronecker(n: int, d: int, seed: int) -> Floats:
    ratio = 2.0
    for _ in range(99):
        ratio = (1.0 + ratio) ** (1.0 / (d + 1))
    shift = np.random.default_rng(seed).random(d)
    return (np.arange(n)[:, None] * ratio ** -np.arange(1.0, d + 1) + shift) % 1.0


def greedy(points: Floats) -> Floats:
    """Return the points in the order in which each next one leaves the lowest Hickernell discrepancy."""
    n, d = points.shape
    kernel = np.prod(2.0 - np.maximum(points[:, None], points[None]), axis=2)
    linear = np.prod((3.0 - points**2) / 2.0, axis=1)
    with_chosen, left = np.zeros(n), np.ones(n, bool)
    order, total, sums = [], 0.0, 0.0
    for length in range(1, n + 1):
        pairs = (total + 2.0 * with_chosen + np.diag(kernel)) / length**2
        squared = (4.0 / 3.0) ** d - 2.0 * (sums + linear) / length + pairs
        chosen = int(np.argmin(np.where(left, squared, np.inf)))
        total += 2.0 * with_chosen[chosen] + kernel[chosen, chosen]
        sums += linear[chosen]
        with_chosen += kernel[chosen]
        left[chosen] = False
        order.append(chosen)
    return points[order]


def of_bank(n: int, d: int, seed: int) -> Floats:
    sets = Bank().cell("hickernell", n, d).load()
    return greedy(np.asarray(sets[seed % len(sets)], np.float64))


def trained(n: int, d: int, seed: int, network: bool) -> Floats:
    objective = "prefixes(hickernell)"
    if network:
        return train_many(NetworkConfig(n, d, objective, steps=5000), 1, rng=seed, workers=1)[0].points
    return anneal_many(n, d, objective, 1, steps=5000, rng=seed, workers=1)[0].points


METHODS: dict[str, tuple[Callable[[int, int, int], Floats], int, int]] = {
    "sequence": (lambda n, d, seed: Sequence().draw(n, d, rng=seed).points, 1024, 4),
    "growing": (lambda n, d, seed: draw("growing", n, d, rng=seed).points, 1024, 32),
    "halton": (lambda n, d, seed: draw("halton", n, d, rng=seed).points, 1024, 32),
    "kronecker": (kronecker, 1024, 32),
    "greedy": (of_bank, 512, 4),
    "objective, network": (lambda n, d, seed: trained(n, d, seed, True), 256, 2),
    "objective, annealed": (lambda n, d, seed: trained(n, d, seed, False), 256, 2),
}
"""Name -> (from n, d and seed to the points, longest, sets)."""


def discrepancy(dimensions: list[int]) -> list[dict[str, object]]:
    """Print and return ratios of D_H to the geometric mean of scrambled Sobol sets of the same length."""
    rows: list[dict[str, object]] = []
    for d in dimensions:
        longest = max(LENGTHS)
        owen = np.log([rooted_prefixes(draw("sobol", longest, d, rng=SEED + i)) for i in range(SCRAMBLES)])
        usual = owen.mean(axis=0)
        for name, (make, most, sets) in METHODS.items():
            if name == "greedy" and not Bank().has("hickernell", most, d):
                continue
            if name.startswith("objective") and d in (4, 7):
                continue
            began = time.process_time()
            made = [make(most, d, seed) for seed in range(sets)]
            seconds = (time.process_time() - began) / sets
            over = np.log([rooted_prefixes(each) for each in made]) - usual[:most]
            error = np.hypot(
                over.std(axis=0, ddof=1) / np.sqrt(sets),
                owen.std(axis=0, ddof=1)[:most] / np.sqrt(SCRAMBLES),
            )
            mean = over.mean(axis=0)
            ahead = float((mean[15:512] < 0).mean())
            worst, place = float(np.exp(mean[15:512].max())), int(mean[15:512].argmax()) + 16
            for n in LENGTHS:
                if n <= most:
                    ratio, se = float(np.exp(mean[n - 1])), float(error[n - 1])
                    rows.append(
                        {
                            "d": d,
                            "method": name,
                            "sets": sets,
                            "n": n,
                            "ratio": round(ratio, 4),
                            "error": round(se, 4),
                        }
                    )
            text = " ".join(f"{np.exp(mean[n - 1]):.3f}" for n in LENGTHS if n <= most)
            print(
                f"{d:2d} {name:20s} {seconds:5.1f} s | {text} | n = 16 .. 512: ahead at {100 * ahead:.0f} %,"
                f" worst {worst:.3f} at {place}, mean {np.exp(mean[15:512].mean()):.3f},"
                f" error {error[15:512].max():.3f}",
                flush=True,
            )
    return rows


def spread(dimensions: list[int]) -> list[dict[str, object]]:
    """Print and return means over four sets, in units of n^(-1/d): Riesz energy, separation and dispersion."""
    rows: list[dict[str, object]] = []
    for d, name in itertools.product(
        dimensions, ("growing", "sequence", "sobol", "halton", "kronecker", "even")
    ):
        sets = 4
        for n in (64, 100, 181, 256, 362, 512):
            found = []
            for seed in range(sets):
                points = kronecker(n, d, seed) if name == "kronecker" else draw(name, n, d, rng=seed).points
                unit = n ** (1.0 / d)
                hole = dispersion_l2(points) * unit if d <= 3 else np.nan
                found.append((riesz_rooted(points), separation(points, periodic=True) * unit, hole))
            means = np.mean(found, axis=0)
            errors = np.std(found, axis=0, ddof=1) / np.sqrt(sets)
            row: dict[str, object] = {"d": d, "method": name, "sets": sets, "n": n}
            for what, mean, error in zip(("riesz", "separation", "dispersion"), means, errors, strict=True):
                row |= {what: round(float(mean), 4), f"{what}_error": round(float(error), 4)}
            rows.append(row)
        mine = [row for row in rows if row["d"] == d and row["method"] == name]
        for what in ("riesz", "separation", "dispersion"):
            print(f"{d:2d} {name:10s} {what:10s} " + " ".join(f"{row[what]:.3f}" for row in mine), flush=True)
    return rows


@cache
def moved_sobol(d: int, number: int) -> Floats:
    return Sequence().draw(512, d, rng=number).points


COUNTS = (64, 90, 128, 181, 256, 362, 512)
CUBES = (Family.BALLS, Family.BOXES)
PLANNED = ("sobol", "growing", "sequence", "halton", "uniform", "kronecker", "even")


def points_of(name: str, d: int, key: list[int], n: int) -> Floats:
    rng = np.random.default_rng(key)
    if name == "kronecker":
        return kronecker(n, d, int(rng.integers(2**60)))
    if name == "sequence":
        return moved_sobol(d, key[-1] % 8)[:n, rng.permutation(d)]
    return draw(name, n, d, rng=rng).points


def planning(
    dimensions: list[int], worlds: int, stream: Stream, names: tuple[str, ...]
) -> list[dict[str, object]]:
    """Print and return success [%] over balls and boxes of three difficulties, and differences to Sobol's points."""
    rows: list[dict[str, object]] = []
    for d in dimensions:
        least = np.zeros((len(names), len(COUNTS), 2, 3, worlds), dtype=np.int32)
        for kind, hard, world in itertools.product(range(2), range(3), range(worlds)):
            family = CUBES[kind]
            problem = make_instance(stream, family, d, DIFFICULTIES[hard], SIZES[family, d][hard], world)
            for f, name in enumerate(names):
                key = [SEED, int(stream), d, kind, hard, world]
                longest = points_of(name, d, key, max(COUNTS)) if name != "even" else None
                for c, n in enumerate(COUNTS):
                    cube = longest[:n] if longest is not None else points_of(name, d, key, n)
                    least[f, c, kind, hard, world] = smallest_k(problem, cube, NEIGHBOURS[-1])
        solved = 100.0 * np.stack([least <= k for k in NEIGHBOURS], axis=1)
        for f, name in enumerate(names):
            difference = solved[f] - solved[names.index("sobol")]
            for c, count in enumerate(("all", *COUNTS)):
                at = slice(None) if c == 0 else slice(c - 1, c)
                paired = difference[:, at].mean(axis=(0, 1)).ravel()
                rows.append(
                    {
                        "stream": stream.name.lower(),
                        "d": d,
                        "method": name,
                        "n": count,
                        "worlds": paired.size,
                        **{
                            f"k{k}": round(float(solved[f, i, at].mean()), 2)
                            for i, k in enumerate(NEIGHBOURS)
                        },
                        "success": round(float(solved[f][:, at].mean()), 2),
                        "minus_sobol": round(float(paired.mean()), 2),
                        "error": round(float(paired.std(ddof=1) / np.sqrt(paired.size)), 2),
                    }
                )
            mine = [row for row in rows if row["d"] == d and row["method"] == name]
            text = " ".join(f"{row['minus_sobol']:+.1f}" for row in mine[1:])
            head = mine[0]
            by_k = " ".join(f"{head[f'k{k}']:.1f}" for k in NEIGHBOURS)
            print(
                f"{d:2d} {name:10s} {head['success']:.1f} % {head['minus_sobol']:+.2f} ({head['error']:.2f})"
                f" | by n {text} | by k {by_k}",
                flush=True,
            )
    return rows


def anytime(dimensions: list[int], worlds: int, stream: Stream) -> list[dict[str, object]]:
    """Print and return what `plan_anytime` needs with the growing lattice, and with scrambled Sobol points instead."""
    rows: list[dict[str, object]] = []
    for d in dimensions:
        found: list[list[tuple[float, float, float]]] = []
        for family, hard, world in itertools.product(CUBES, range(3), range(worlds)):
            problem = make_instance(stream, family, d, DIFFICULTIES[hard], SIZES[family, d][hard], world)
            found.append([])
            for sampler in (Growing(), Sobol()):
                result = plan_anytime(
                    problem.world,
                    problem.start,
                    problem.goal,
                    sampler,
                    budget=Budget(samples=2048),
                    rng=world + 10**6 * (3 * int(family) + hard),
                    shorten=False,
                )
                found[-1].append((result.solved, result.stages[-1].points, result.counts["edges_checked"]))
        solved, points, edges = np.moveaxis(np.array(found, dtype=float), 2, 0)
        both = solved.all(axis=1)
        row: dict[str, object] = {"stream": stream.name.lower(), "d": d, "worlds": len(found)}
        for name, of in (("solved_growing", 100 * solved[:, 0]), ("solved_sobol", 100 * solved[:, 1])):
            row[name] = round(float(of.mean()), 2)
        paired = {"solved_difference": 100 * (solved[:, 0] - solved[:, 1])}
        paired |= {
            f"log2_{what}": np.log2(of[both, 0] / of[both, 1])
            for what, of in (("points", points), ("edges", edges))
        }
        for what, values in paired.items():
            error = float(values.std(ddof=1) / np.sqrt(len(values)))
            row |= {what: round(float(values.mean()), 3), f"{what}_error": round(error, 3)}
        rows.append(row)
        print(row, flush=True)
    return rows


def picture(out: Path) -> None:
    """Draw docs/sequences.png from the csv files."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    colours = {"sequence": "#d1343b", "growing": "#2f5fd0", "halton": "#8a949e", "kronecker": "#c79a2b"}
    colours |= {"greedy": "#6a4c93", "even": "#1b998b", "sobol": "#3b4650", "uniform": "#bbbbbb"}
    ratios, success = (_read(out / f"sequences_{part}.csv") for part in ("discrepancy", "plan"))
    figure = Figure(figsize=(12, 10), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(3, 3)
    for place, d in zip(axes[0], (2, 5, 10), strict=True):
        for name in ("sequence", "growing", "halton", "kronecker", "greedy"):
            mine = [row for row in ratios if row["d"] == str(d) and row["method"] == name]
            if mine:
                n, y, e = (np.array([float(row[key]) for row in mine]) for key in ("n", "ratio", "error"))
                place.fill_between(
                    n, y * np.exp(-2 * e), y * np.exp(2 * e), color=colours[name], alpha=0.15, lw=0
                )
                place.plot(n, y, color=colours[name], label=name, marker=".", markersize=4)
        place.axhline(1.0, color="black", linewidth=0.8)
        place.set(
            xscale="log",
            ylim=(0.75, 2.0),
            title=f"D_H over Sobol's, d = {d}",
            xlabel="points",
        )
        place.grid(alpha=0.3)
        place.set_xticks(ticks := (16, 64, 256, 1024), [str(tick) for tick in ticks])
    axes[0, 1].legend(loc="upper left", fontsize=8)
    for place, d in zip(axes[1], (2, 3, 5), strict=True):
        for name in ("growing", "sequence", "halton", "kronecker", "even", "uniform"):
            mine = [r for r in success if r["d"] == str(d) and r["method"] == name and r["n"] != "all"]
            if not mine:
                continue
            n, y, e = (np.array([float(row[key]) for row in mine]) for key in ("n", "minus_sobol", "error"))
            place.errorbar(n, y, e, color=colours[name], label=name, marker=".", capsize=2)
        place.axhline(0.0, color="black", linewidth=0.8)
        place.set(xscale="log", ylim=(-11, 8), title=f"success minus Sobol's [%], d = {d}", xlabel="points")
        place.grid(alpha=0.3)
        place.set_xticks(COUNTS, [str(n) for n in COUNTS])
        place.minorticks_off()
    axes[1, 2].legend(loc="upper left", fontsize=8, ncols=2)
    for place, name in zip(axes[2], ("growing", "sequence", "sobol"), strict=True):
        points = draw(name, 362, 2, rng=1).points
        for first, last, colour in ((0, 128, "#d1343b"), (128, 256, "#2f5fd0"), (256, 362, "#9aa5b1")):
            place.scatter(*points[first:last].T, s=9, color=colour, label=f"{first} .. {last - 1}")
        place.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), title=f"{name}: 362 points")
    axes[2, 0].legend(loc="upper right", fontsize=7)
    figure.savefig("docs/sequences.png")


def _read(path: Path) -> list[dict[str, str]]:
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=("discrepancy", "spread", "plan", "anytime", "picture"))
    parser.add_argument("-d", type=int, nargs="+")
    parser.add_argument("--worlds", type=int, default=200, help="of each kind and difficulty")
    parser.add_argument("--tuning", action="store_true")
    parser.add_argument("--methods", nargs="+", choices=PLANNED, default=PLANNED)
    parser.add_argument("--out", type=Path, default=DATA)
    options = parser.parse_args()
    if "sobol" not in options.methods:
        parser.error("--methods must have sobol among them, which the others are compared with")
    if options.part == "picture":
        picture(options.out)
        return
    stream = Stream.TUNING if options.tuning else Stream.REPORTING
    if options.part == "discrepancy":
        rows = discrepancy(options.d or [2, 3, 4, 5, 7, 10])
    elif options.part == "spread":
        rows = spread(options.d or [2, 3, 5])
    elif options.part == "anytime":
        rows = anytime(options.d or [2, 3, 5], options.worlds, stream)
    else:
        rows = planning(options.d or [2, 3, 5, 7, 10], options.worlds, stream, tuple(options.methods))
    name = f"sequences_{options.part}{'_tuning' if options.tuning else ''}.csv"
    with open(options.out / name, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
