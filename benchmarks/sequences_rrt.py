"""NeuroLDS's published comparison again: RRT in a chain of four joints, its draws taken from sequences.

    python -m benchmarks.neural_sequence --out neural_star.npz    # the peer, trained here
    python -m benchmarks.sequences_rrt calibrate                  # how many draws; tuning problems
    python -m benchmarks.sequences_rrt plan                       # docs/data/sequences_rrt.csv
    python -m benchmarks.sequences_rrt variants                   # other ways to fill in what is not published
    python -m benchmarks.sequences_rrt luck                       # sequences of one kind among themselves
    python -m benchmarks.sequences_rrt discrepancy
    python -m benchmarks.sequences_rrt picture

Every method solves the same problems.  `plain` sequences are the same points each time, from index 128 on; those of
networks, `sequence` and `greedy` are taken in turn; `shifted` adds a new vector modulo 1 for each problem.
"""

from __future__ import annotations

import argparse
import csv
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.chain_rrt import JOINTS, Setting, grow, problem
from benchmarks.sequences import _read, of_bank
from evenroad._arrays import Floats, Ints
from evenroad.points import draw
from evenroad.points.samplers import Halton, Sobol
from evenroad_studies.prefixes import rooted_prefixes
from evenroad_studies.problems.fair import Stream
from evenroad_studies.sequence import Sequence
from evenroad_studies.statistics.rates import wilson

WIDTHS = (0.64, 0.40)
PUBLISHED = {0.64: (96.6, 88.0), 0.40: (80.0, 67.3)}
"""Width -> success [%] of NeuroLDS and of Halton."""

BURNT, LONGEST, MOST = 128, 1000, 1700
"""Points that plain sequences leave out; length of the trained sets; draws of a run, at most."""

SETS = 4
"""Sequences of the kinds that take long to make."""

MAIN = Setting(step=0.9, turned=True)
VARIANTS = {
    "main": MAIN,
    "goal drawn every 20th time": Setting(step=0.9, turned=True, every=19),
    "steps of 1.4": Setting(step=1.4, turned=True),
    "joints end at +-pi": Setting(step=0.9, turned=True, wraps=False),
    "only the tunnel is moved": Setting(step=0.9, shift=0.9),
}
COUNTS = {
    "main": {0.64: 850, 0.40: 850},
    "goal drawn every 20th time": {0.64: 38, 0.40: 399},
    "steps of 1.4": {0.64: 135, 0.40: 424},
    "joints end at +-pi": {0.64: 793, 0.40: LONGEST},
    "only the tunnel is moved": {0.64: 823, 0.40: 919},
}
"""Setting -> width -> draws; chosen with :func:`calibrate`."""

LUCK = ("main", "only the tunnel is moved")
DATA = Path("docs/data")


@cache
def fixed(name: str, number: int) -> Floats:
    if name == "halton":
        return Halton(scramble=False, start=BURNT).draw(MOST, JOINTS).points
    if name == "sobol":
        return Sobol(scramble=False, start=BURNT).draw(MOST, JOINTS).points
    if name == "greedy":
        return of_bank(1024, JOINTS, number)
    if name == "sequence":
        return Sequence().draw(LONGEST, JOINTS, rng=number).points
    return networks(name)[number]


_neural = Path()


@cache
def networks(name: str) -> Floats:
    """Return the points of the networks of that name, (networks, n, d)."""
    with np.load(_neural / f"{name.replace(' ', '_')}.npz") as file:
        return np.asarray(file["points"], np.float64)


def sequences_of(name: str) -> int:
    """Return from how many sequences a method takes one in turn; 0: a new one each time."""
    kind, _, _ = name.partition(", ")
    if name in ("halton, plain", "sobol, plain"):
        return 1
    if kind in ("greedy", "sequence"):
        return SETS
    return len(networks(kind)) if kind.startswith("neural") else 0


def points_of(name: str, number: int) -> Floats:
    """Return the draws of a method for the problem of that number."""
    kind, _, how = name.partition(", ")
    rng = np.random.default_rng([7, number])
    if how or kind in ("greedy", "sequence") or kind.startswith("neural"):
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
    "neural star",
    "neural star, shifted",
)


def draws_needed(name: str, width: float, stream: Stream, problems: int, setting: Setting) -> Ints:
    """Return the draws that each problem took, (problems,); one more than there were where it was not solved."""
    found = np.empty(problems, dtype=np.int64)
    for i in range(problems):
        points = points_of(name, i)
        draws = grow(points, problem(width, i, int(stream), setting), setting).draws
        found[i] = draws or MOST + 1
    return found


def calibrate(problems: int) -> None:
    """Print for each setting the draws with which shifted Halton points solve the published shares."""
    for label, setting in VARIANTS.items():
        for width in WIDTHS:
            for name in ("halton, shifted", "halton, plain"):
                draws = draws_needed(name, width, Stream.TUNING, problems, setting)
                least = int(np.quantile(draws, PUBLISHED[width][1] / 100.0, method="inverted_cdf"))
                at = 100.0 * float((draws <= COUNTS[label][width]).mean())
                print(
                    f"{label:26s} {width:.2f} {name:16s} {least:5d}; {at:.1f} % with {COUNTS[label][width]}",
                    flush=True,
                )


def errors(solved: Floats, name: str) -> tuple[float, float]:
    """Return the standard errors [%] of a mean over problems: as if each were alone, and over the sequences."""
    alone = 100.0 * float(solved.std(ddof=1)) / np.sqrt(len(solved))
    sets = sequences_of(name)
    if sets < 2:
        return alone, alone
    means = [100.0 * solved[i::sets].mean() for i in range(sets)]
    return alone, float(np.std(means, ddof=1)) / np.sqrt(sets)


class Runs:
    """Draws that problems took, kept in a file from one call to the next."""

    def __init__(self, path: Path, problems: int) -> None:
        self.path, self.problems = path, problems
        self.found: dict[str, Ints] = {}
        if path.exists():
            with np.load(path) as file:
                self.found = dict(file)

    def of(self, label: str, name: str, width: float) -> Ints:
        key = f"{label}; {name}; {width}"
        if len(self.found.get(key, ())) < self.problems:
            self.found[key] = draws_needed(name, width, Stream.REPORTING, self.problems, VARIANTS[label])
            np.savez_compressed(self.path, **self.found)
            print(key, flush=True)
        return self.found[key][: self.problems]


def compared(
    runs: Runs, label: str, names: tuple[str, ...], counts: dict[float, int]
) -> list[dict[str, object]]:
    """Print and return the success at each width, and differences to Halton's points, plain and shifted."""
    rows: list[dict[str, object]] = []
    for width, count in counts.items():
        draws = {name: runs.of(label, name, width) for name in names}
        for name in names:
            solved = (draws[name] <= count).astype(float)
            low, high = wilson(int(solved.sum()), runs.problems)
            row: dict[str, object] = {"setting": label, "width": width, "draws": count, "method": name}
            row |= {"problems": runs.problems, "sequences": sequences_of(name)}
            row |= {"success": round(100 * solved.mean(), 2), "low": round(100 * float(low), 2)}
            row |= {
                "high": round(100 * float(high), 2),
                "error over sequences": round(errors(solved, name)[1], 2),
            }
            for other in ("halton, plain", "halton, shifted"):
                paired = solved - (draws[other] <= count)
                row |= {f"minus {other}": round(100 * paired.mean(), 2)}
                row |= {f"error, {other}": round(max(errors(paired, name)), 2)}
            row["median draws"] = int(np.median(draws[name]))
            rows.append(row)
            print(" ".join(str(each) for each in row.values()), flush=True)
    return rows


def needed(runs: Runs, names: tuple[str, ...], like: str = "neural star, shifted") -> list[dict[str, object]]:
    """Print and return the draws with which methods solve, over both widths, what the networks' points solve.

    With 95 % intervals over problems (bootstrap) of their ratio to the networks' own.
    """
    rng, rows = np.random.default_rng(0), []
    draws = {name: np.array([runs.of("main", name, width) for width in WIDTHS]) for name in names}
    chosen = [np.arange(runs.problems), *rng.integers(runs.problems, size=(400, runs.problems))]
    found: dict[str, list[float]] = {name: [] for name in names}
    for each in chosen:
        goal = float((draws[like][:, each] <= COUNTS["main"][WIDTHS[0]]).mean())
        for name in names:
            found[name].append(float(np.quantile(draws[name][:, each], goal, method="inverted_cdf")))
    for name in names:
        ratios = np.array(found[name]) / np.array(found[like])
        low, high = np.percentile(ratios[1:], (2.5, 97.5))
        row: dict[str, object] = {"method": name, "draws": int(found[name][0]), "ratio": round(ratios[0], 3)}
        rows.append(row | {"low": round(float(low), 3), "high": round(float(high), 3)})
        print(*rows[-1].values(), flush=True)
    return rows


def luck(label: str, sequences: int = 30, problems: int = 160) -> list[dict[str, object]]:
    """Print and return how far sequences of one kind, Halton's under one shift each, are apart in success.

    Then two groups of ten of them are drawn, again and again, as if they were two methods.
    """
    rng, rows, setting = np.random.default_rng(3), [], VARIANTS[label]
    shifts = np.random.default_rng(2).random((sequences, JOINTS))
    for width in WIDTHS:
        tasks = [problem(width, i, int(Stream.REPORTING), setting) for i in range(problems)]
        success = np.empty(sequences)
        for i, shift in enumerate(shifts):
            points = (fixed("halton", 0)[: COUNTS[label][width]] + shift) % 1.0
            success[i] = 100.0 * np.mean([grow(points, task, setting).draws > 0 for task in tasks])
        groups = np.array([rng.permutation(success)[:20].reshape(2, 10).mean(axis=1) for _ in range(20000)])
        apart = np.abs(groups[:, 0] - groups[:, 1])
        gain = PUBLISHED[width][0] - PUBLISHED[width][1]
        row: dict[str, object] = {"setting": label, "width": width, "draws": COUNTS[label][width]}
        row |= {"sequences": sequences, "problems": problems}
        row |= {"mean": round(success.mean(), 1), "deviation": round(success.std(ddof=1), 1)}
        row |= {"least": round(success.min(), 1), "most": round(success.max(), 1)}
        row |= {
            "tens apart by 95 %": round(float(np.quantile(apart, 0.95)), 1),
            "published gain": round(gain, 1),
        }
        rows.append(row | {"tens at least so far apart [%]": round(100.0 * float((apart >= gain).mean()), 1)})
        print(rows[-1], flush=True)
    return rows


LENGTHS = (16, 24, 32, 48, 64, 100, 128, 181, 256, 362, 512, 660, 724, 1000)


def discrepancy() -> list[dict[str, object]]:
    """Print and return, for two measures, the ratios to the mean of 32 scrambled Sobol sequences."""
    rows: list[dict[str, object]] = []
    for measure in ("star", "hickernell"):
        owen = [
            rooted_prefixes(draw("sobol", LONGEST, JOINTS, rng=1000 + i).points, measure) for i in range(32)
        ]
        usual = np.mean(owen, axis=0)
        for name in METHODS:
            if name.endswith("shifted"):
                continue
            sets = sequences_of(name) or 32
            ratio = (
                np.array([rooted_prefixes(points_of(name, i)[:LONGEST], measure) for i in range(sets)])
                / usual
            )
            mean, error = ratio.mean(axis=0), ratio.std(axis=0, ddof=min(sets - 1, 1)) / np.sqrt(sets)
            for n in LENGTHS:
                row: dict[str, object] = {"measure": measure, "method": name, "sets": sets, "n": n}
                row |= {"usual": f"{usual[n - 1]:.5e}", "ratio": round(float(mean[n - 1]), 4)}
                rows.append(row | {"error": round(float(error[n - 1]), 4)})
            text = " ".join(f"{mean[n - 1]:.3f}" for n in LENGTHS)
            ahead = 100.0 * float((mean[15:] < 1.0).mean())
            print(
                f"{measure:10s} {name:14s} {text} | ahead {ahead:.0f} %, mean {mean[15:].mean():.3f}",
                flush=True,
            )
    return rows


def picture(runs: Runs, out: Path) -> None:
    """Draw docs/sequences_rrt.png: the task, discrepancies, and success over the number of draws."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    colours = {
        "neural star": "#c2410c",
        "neural hickernell": "#0f766e",
        "halton": "#6b7280",
        "sobol": "#111827",
        "growing": "#2f5fd0",
    }
    colours |= {"sequence": "#d1343b", "uniform": "#b9c0c7", "greedy": "#6a4c93"}
    figure = Figure(figsize=(13, 7.5), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 3)
    for place, width in zip(axes[:, 0], WIDTHS, strict=True):
        task = problem(width, 0, int(Stream.REPORTING), Setting(step=MAIN.step))
        path = grow(draw("halton", MOST, JOINTS, rng=2).points, task, Setting(step=MAIN.step)).path()
        for i, q in enumerate(path):
            heading = np.cumsum(q)
            x, y = (np.concatenate([[0.0], np.cumsum(f(heading)) / JOINTS]) for f in (np.cos, np.sin))
            ends = i in (0, len(path) - 1)
            colour = "#d1343b" if i == 0 else "#2f5fd0" if ends else "#9aa5b1"
            place.plot(x, y, color=colour, lw=2.5 if ends else 0.8, zorder=2 + ends)
        for x, y, along_x, along_y in task.walls.T:
            place.plot([x, x + along_x], [y, y + along_y], color="black", lw=2)
        place.set(aspect="equal", title=f"width {width:.2f}: start red, goal blue, a path grey")
    ratios = _read(out / "sequences_neural.csv")
    for place, measure in zip(axes[:, 1], ("star", "hickernell"), strict=True):
        for name in dict.fromkeys(row["method"] for row in ratios):
            if name in ("uniform", "sobol"):
                continue
            mine = [row for row in ratios if row["method"] == name and row["measure"] == measure]
            kind, _, how = name.partition(", ")
            n, y = (np.array([float(row[key]) for row in mine]) for key in ("n", "ratio"))
            place.plot(n, y, color=colours[kind], ls="--" if how else "-", marker=".", label=name)
        place.axhline(1.0, color="black", lw=0.8)
        place.set(
            xscale="log",
            ylim=(0.7, 2.1),
            xlabel="points",
            title=f"{measure} discrepancy over scrambled Sobol's",
        )
        place.set_xticks((16, 64, 256, 1024), ["16", "64", "256", "1024"])
        place.grid(alpha=0.3)
    axes[0, 1].legend(fontsize=8)
    for place, width in zip(axes[:, 2], WIDTHS, strict=True):
        for name in METHODS:
            kind, _, how = name.partition(", ")
            if f"main; {name}; {width}" not in runs.found or kind == "greedy":
                continue
            draws = np.sort(runs.of("main", name, width))
            share = 100.0 * np.arange(1, len(draws) + 1) / len(draws)
            seen = draws <= LONGEST
            style = {"plain": "--", "shifted": ":"}.get(how, "-")
            place.plot(draws[seen], share[seen], style, color=colours[kind], lw=1.3, label=name)
        place.axvline(COUNTS["main"][width], color="black", lw=0.6)
        place.set(xlim=(0, LONGEST), ylim=(0, 100), xlabel="draws", title=f"solved [%], width {width:.2f}")
        place.grid(alpha=0.3)
    axes[1, 2].legend(fontsize=7, loc="upper left")
    figure.savefig("docs/sequences_rrt.png")


def write(rows: list[dict[str, object]], path: Path) -> None:
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=("calibrate", "plan", "variants", "luck", "discrepancy", "picture"))
    parser.add_argument("--problems", type=int, default=1600)
    parser.add_argument("--neural", type=Path, default=Path(), help="folder of the networks' points")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=METHODS)
    parser.add_argument(
        "--runs", type=Path, default=Path("sequences_rrt_runs.npz"), help="keeps what is done"
    )
    parser.add_argument("--out", type=Path, default=DATA)
    options = parser.parse_args()
    global _neural
    _neural = options.neural
    runs, names = Runs(options.runs, options.problems), tuple(options.methods)
    if options.part == "calibrate":
        calibrate(options.problems)
    elif options.part == "plan":
        write(compared(runs, "main", names, COUNTS["main"]), options.out / "sequences_rrt.csv")
        write(needed(runs, names), options.out / "sequences_rrt_draws.csv")
    elif options.part == "variants":
        rows = [row for label in VARIANTS for row in compared(runs, label, names, COUNTS[label])]
        write(rows, options.out / "sequences_rrt_variants.csv")
    elif options.part == "luck":
        write([row for label in LUCK for row in luck(label)], options.out / "sequences_rrt_luck.csv")
    elif options.part == "discrepancy":
        write(discrepancy(), options.out / "sequences_neural.csv")
    else:
        picture(runs, options.out)


if __name__ == "__main__":
    main()
