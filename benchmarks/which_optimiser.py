"""Which optimiser makes the better sets in equal time: the network, annealing, or the network and then annealing?

    python -m benchmarks.which_optimiser --seconds 4 --out out/bench

Eight sets a cell, one thread.  Every method gets the same processor time for all eight: its number of steps is chosen
from the measured time of a few steps, because its learning rate must know where it ends; the time really taken is
reported.  "network + annealing" gives each half of the time.  Rows are written as they come; finished ones are kept.
"""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from evenroad.points import PointSet
from evenroad.points.measures import MEASURES
from evenroad_studies.network import NetworkConfig, refine
from evenroad_studies.training import anneal_many, train_many

CELLS = [(d, n) for n in (128, 512) for d in (2, 5, 10)]
SETS = 8
SEED = 7
FIELDS = ["d", "n", "method", "budget [s]", "taken [s]", "steps", "mean D_H", "std", "best D_H", "sets"]

Made = tuple[tuple[PointSet, ...], str]


def network(n: int, d: int, seconds: float) -> Made:
    """Train a network for each set, for about so many seconds in all."""

    def run(steps: int) -> tuple[PointSet, ...]:
        return train_many(NetworkConfig(n, d, steps=steps), SETS, rng=SEED, workers=1)

    steps = _steps_in(seconds, run, probe=20)
    return run(steps), str(steps)


def annealing(n: int, d: int, seconds: float) -> Made:
    """Anneal each set for its share of the time."""

    def run(steps: int) -> tuple[PointSet, ...]:
        return anneal_many(n, d, "hickernell", SETS, steps=steps, rng=SEED, workers=1)

    steps = _steps_in(seconds, run, probe=60)
    return run(steps), str(steps)


def both(n: int, d: int, seconds: float) -> Made:
    """Train the network for half of the time, then anneal its sets for the other half."""
    sets, network_steps = network(n, d, seconds / 2)
    steps = _steps_in(seconds / 2, lambda count: refine(sets, "hickernell", steps=count), probe=60)
    return refine(sets, "hickernell", steps=steps), f"{network_steps} + {steps}"


METHODS: dict[str, Callable[[int, int, float], Made]] = {
    "network": network,
    "annealing": annealing,
    "network + annealing": both,
}


def _steps_in(seconds: float, run: Callable[[int], object], probe: int) -> int:
    """Return how many steps `run` makes in `seconds`, from two short probes: what they share is not per step."""
    run(1)
    times = []
    for count in (probe, 3 * probe):
        began = time.process_time()
        run(count)
        times.append(time.process_time() - began)
    return max(1, int(seconds / (max(times[1] - times[0], 1e-6) / (2 * probe))))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--seconds", type=float, default=4.0, help="processor time a method, at n=512 four times"
    )
    parser.add_argument("--out", type=Path, default=Path("out/bench"))
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=list(METHODS))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.out / "which_optimiser.csv"
    rows = list(csv.DictReader(path.open())) if path.exists() else []
    measure = MEASURES["hickernell"].rooted
    for d, n in CELLS:
        for name in options.methods:
            budget = options.seconds * (4 if n == 512 else 1)
            wanted = (str(d), str(n), name, str(budget))
            if any((row["d"], row["n"], row["method"], str(row["budget [s]"])) == wanted for row in rows):
                continue
            began = time.process_time()
            sets, steps = METHODS[name](n, d, budget)
            taken = time.process_time() - began
            values = [measure(each) for each in sets]
            numbers = [f"{value:.6g}" for value in (np.mean(values), np.std(values), np.min(values))]
            rows.append(
                dict(
                    zip(FIELDS, [d, n, name, budget, f"{taken:.1f}", steps, *numbers, len(sets)], strict=True)
                )
            )
            with path.open("w", newline="") as file:
                writer = csv.DictWriter(file, FIELDS)
                writer.writeheader()
                writer.writerows(rows)
            print(rows[-1], flush=True)
    print("| " + " | ".join(FIELDS) + " |\n" + "|---" * len(FIELDS) + "|")
    for row in rows:
        print("| " + " | ".join(str(row[field]) for field in FIELDS) + " |")


if __name__ == "__main__":
    main()
