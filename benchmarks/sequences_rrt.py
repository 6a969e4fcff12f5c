"""NeuroLDS's published comparison again: RRT in a chain of four joints, its draws taken from sequences.

    python -m benchmarks.neural_sequence --out neural_sequences.npz          # the peer, trained here
    python -m benchmarks.sequences_rrt calibrate                             # how many draws; tuning problems
    python -m benchmarks.sequences_rrt plan --neural neural_sequences.npz    # docs/data/sequences_rrt.csv
    python -m benchmarks.sequences_rrt variants --neural neural_sequences.npz
    python -m benchmarks.sequences_rrt picture

Every method solves the same problems.  `plain` sequences are the same points each time, from index 128 on; those of
`neural`, `sequence` and `greedy` are taken in turn; `shifted` adds a new vector modulo 1 for each problem.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.chain_rrt import JOINTS, Setting, grow, problem
from benchmarks.sequences import of_bank
from evenroad._arrays import Floats, Ints
from evenroad.points import draw
from evenroad.points.measures import rooted_prefixes
from evenroad.points.samplers import Halton, Sobol
from evenroad.research.problems.fair import Stream
from evenroad.research.statistics.rates import wilson

WIDTHS = (0.64, 0.40)
PUBLISHED = {0.64: (96.6, 88.0), 0.40: (80.0, 67.3)}
"""Width -> success [%] of NeuroLDS and of Halton."""

BURNT, LONGEST, MOST = 128, 1024, 2048
"""Points that plain sequences leave out; length of the trained sets; draws of a run, at most."""

SETS = 8
"""Sequences of the kinds that take long to make."""

MAIN = Setting(step=0.9, turned=True)
VARIANTS = {
    "main": MAIN,
    "goal drawn every 20th time": Setting(step=0.9, turned=True, every=19),
    "steps of .6": Setting(step=0.6, turned=True),
    "steps of 1.4": Setting(step=1.4, turned=True),
    "joints end at +-pi": Setting(step=0.9, turned=True, wraps=False),
    "only the tunnel is moved": Setting(step=0.9, shift=0.9),
}
DATA = Path("docs/data")


@cache
def fixed(name: str, number: int) -> Floats:
    if name == "halton":
        return Halton(scramble=False, start=BURNT).draw(MOST, JOINTS).points
    if name == "sobol":
        return Sobol(scramble=False, start=BURNT).draw(MOST, JOINTS).points
    if name == "greedy":
        return of_bank(LONGEST, JOINTS, number)
    if name == "sequence":
        return draw("sequence", LONGEST, JOINTS, rng=number).points
    with np.load(_neural) as file:
        return np.asarray(file["points"][number % len(file["points"])], np.float64)


_neural = Path()


def sequences_of(name: str) -> int:
    """Return from how many sequences a method takes one in turn; 0: a new one each time."""
    kind, _, _ = name.partition(", ")
    if name in ("halton, plain", "sobol, plain"):
        return 1
    if kind in ("greedy", "sequence"):
        return SETS
    return len(np.load(_neural)["points"]) if kind == "neural" else 0


def points_of(name: str, number: int) -> Floats:
    """Return the draws of a method for the problem of that number."""
    kind, _, how = name.partition(", ")
    rng = np.random.default_rng([7, number])
    if how in ("plain", "shifted") or kind in ("greedy", "sequence", "neural"):
        points = fixed(kind, number % max(sequences_of(kind), 1))
        return (points + rng.random(JOINTS)) % 1.0 if how == "shifted" else points
    return draw(kind, MOST, JOINTS, rng=rng).points


METHODS = (
    "uniform",
    "halton, plain",
    "halton, shifted",
    "halton",
    "sobol, plain",
    "sobol, shifted",
    "sobol",
    "growing",
    "sequence",
    "sequence, shifted",
    "greedy",
    "greedy, shifted",
    "neural",
    "neural, shifted",
)


def draws_needed(name: str, width: float, stream: Stream, problems: int, setting: Setting) -> Ints:
    """Return the draws that each problem took, (problems,); one more than there were where it was not solved."""
    found = np.empty(problems, dtype=np.int64)
    for i in range(problems):
        points = points_of(name, i)
        draws = grow(points, problem(width, i, int(stream), setting), setting).draws
        found[i] = draws or MOST + 1
    return found


def calibrated(setting: Setting, problems: int) -> dict[float, int]:
    """Return for each width the draws with which plain Halton points solve the published share of tuning problems."""
    found = {}
    for width in WIDTHS:
        draws = draws_needed("halton, plain", width, Stream.TUNING, problems, setting)
        found[width] = int(np.quantile(draws, PUBLISHED[width][1] / 100.0, method="inverted_cdf"))
    return found


def errors(solved: Floats, name: str) -> tuple[float, float]:
    """Return the standard errors [%] of a mean over problems: as if each were alone, and over the sequences."""
    alone = 100.0 * float(solved.std(ddof=1)) / np.sqrt(len(solved))
    sets = sequences_of(name)
    if sets < 2:
        return alone, alone
    means = [100.0 * solved[i::sets].mean() for i in range(sets)]
    return alone, float(np.std(means, ddof=1)) / np.sqrt(sets)


def compared(
    names: tuple[str, ...],
    width: float,
    counts: tuple[int, ...],
    problems: int,
    setting: Setting,
    label: str,
) -> list[dict[str, object]]:
    """Print and return success with `counts` draws, and differences to Halton's points, plain and shifted."""
    draws = {name: draws_needed(name, width, Stream.REPORTING, problems, setting) for name in names}
    rows: list[dict[str, object]] = []
    for count in counts:
        for name in names:
            solved = (draws[name] <= count).astype(float)
            low, high = wilson(int(solved.sum()), problems)
            row: dict[str, object] = {"setting": label, "width": width, "draws": count, "method": name}
            row |= {"problems": problems, "sequences": sequences_of(name)}
            row |= {"success": round(100 * solved.mean(), 2), "low": round(100 * float(low), 2)}
            row |= {"high": round(100 * float(high), 2), "error_over_sequences": round(errors(solved, name)[1], 2)}
            for other in ("halton, plain", "halton, shifted"):
                paired = solved - (draws[other] <= count)
                mean, error = 100 * paired.mean(), max(errors(paired, name))
                row |= {f"minus {other}": round(mean, 2), f"error, {other}": round(error, 2)}
            row["median_draws"] = int(np.median(draws[name]))
            rows.append(row)
            print(
                f"{label:26s} {width:.2f} {count:5d} {name:18s} {row['success']:6.1f} % [{row['low']:.1f},"
                f" {row['high']:.1f}] {row['minus halton, plain']:+6.1f} ({row['error, halton, plain']})"
                f" {row['minus halton, shifted']:+6.1f} ({row['error, halton, shifted']}) {row['median_draws']}",
                flush=True,
            )
    return rows


def needed_for(
    goal: float, draws: dict[float, Ints], resamples: int = 400
) -> tuple[float, float, float]:
    """Return how many draws solve `goal` [%] on average over the widths, and the 95 % interval over problems."""
    rng = np.random.default_rng(0)
    found = []
    problems = len(next(iter(draws.values())))
    for i in range(resamples + 1):
        chosen = rng.integers(problems, size=problems) if i else slice(None)
        pooled = np.concatenate([each[chosen] for each in draws.values()])
        found.append(float(np.quantile(pooled, goal / 100.0, method="inverted_cdf")))
    return found[0], *(float(each) for each in np.percentile(found[1:], (2.5, 97.5)))


LENGTHS = (16, 24, 32, 48, 64, 100, 128, 181, 256, 362, 512, 660, 724, 1024)


def discrepancy() -> list[dict[str, object]]:
    """Print and return, for two measures, the ratios to the mean of 32 scrambled Sobol sequences."""
    rows: list[dict[str, object]] = []
    for measure in ("star", "hickernell"):
        owen = [rooted_prefixes(draw("sobol", LONGEST, JOINTS, rng=1000 + i).points, measure) for i in range(32)]
        usual = np.mean(owen, axis=0)
        for name in METHODS:
            if name.endswith("shifted"):
                continue
            sets = sequences_of(name) or 32
            ratio = np.array([rooted_prefixes(points_of(name, i)[:LONGEST], measure) for i in range(sets)]) / usual
            mean, error = ratio.mean(axis=0), ratio.std(axis=0, ddof=min(sets - 1, 1)) / np.sqrt(sets)
            for n in LENGTHS:
                row: dict[str, object] = {"measure": measure, "method": name, "sets": sets, "n": n}
                row |= {"usual": f"{usual[n - 1]:.5e}", "ratio": round(float(mean[n - 1]), 4)}
                rows.append(row | {"error": round(float(error[n - 1]), 4)})
            text = " ".join(f"{mean[n - 1]:.3f}" for n in LENGTHS)
            ahead = 100.0 * float((mean[15:] < 1.0).mean())
            print(f"{measure:10s} {name:14s} {text} | ahead {ahead:.0f} %, mean {mean[15:].mean():.3f}", flush=True)
    return rows


def write(rows: list[dict[str, object]], path: Path) -> None:
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=("calibrate", "plan", "variants", "discrepancy", "picture"))
    parser.add_argument("--problems", type=int, default=2000)
    parser.add_argument("--neural", type=Path, default=Path("neural_sequences.npz"))
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument("--out", type=Path, default=DATA)
    options = parser.parse_args()
    global _neural
    _neural = options.neural
    if options.part == "calibrate":
        for label, setting in VARIANTS.items():
            print(f"{label:26s} {calibrated(setting, options.problems)}", flush=True)


if __name__ == "__main__":
    main()
