"""The paper's network as printed, trained: its sets beside published and other ones, and the loss over the steps.

    python -m studies.benchmarks.printed_network --train OUT     # minutes a pool on one core; goes on where it stopped
    python -m studies.benchmarks.printed_network --table OUT --csv CURVES.csv

A pool is a batch of sets that one network makes of random points.  The protocol, the same for all pools: the 8 nearest
initial points send messages, three layers of width 64, the logistic function at the end as in the public code, 10 000
steps of Adam from 1e-3 along a half cosine, Hickernell's discrepancy, seed 0.  Rows that differ say in what.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad_studies.network.printed import Printed, train_printed

EVERY = 100
"""Steps between two points of a kept curve; a pool is written after ten times as many."""


def _pool(n: int, d: int, sets: int) -> Printed:
    return Printed(n, d, sets, end="sigmoid", steps=10_000)


POOLS = {f"d{d}-n{n}-8": _pool(n, d, 8) for n, d in ((64, 2), (128, 2), (256, 2), (128, 3), (256, 5))}
POOLS |= {"d2-n128-8-clamp": replace(_pool(128, 2, 8), end="clamp")}
POOLS |= {f"d2-n{n}-{sets}": _pool(n, 2, sets) for n in (64, 128) for sets in (16, 32)}
POOLS |= {"d2-n128-8-radius": replace(_pool(128, 2, 8), radius=0.35)}
POOLS |= {"d2-n128-8-long": replace(_pool(128, 2, 8), steps=40_000), "d2-n256-16": _pool(256, 2, 16)}
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


def train_pool(name: str, folder: Path) -> None:
    """Train a pool and write it into FOLDER/NAME.npz as it gets better."""
    config, path, curve, begin = POOLS[name], folder / f"{name}.npz", [], time.process_time()

    def seen(step: int, loss: float, points: Floats) -> None:
        if step % EVERY == 0:
            curve.append(loss)
        if step % (10 * EVERY) == 0:
            seconds = time.process_time() - begin
            with atomic_write(path) as file:
                np.savez(file, step=step, points=points.astype(np.float32), curve=curve, seconds=seconds)
            print(f"{name}: step {step} of {config.steps}, mean loss {loss:.6f}, {seconds:.0f} s", flush=True)

    train_printed(config, rng=0, seen=seen)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--train", type=Path, help="folder of the pools, made if it is missing")
    options = parser.parse_args()
    if options.train:
        options.train.mkdir(exist_ok=True)
        for name, config in POOLS.items():
            path = options.train / f"{name}.npz"
            if not path.exists() or load_pool(path).step < config.steps:
                train_pool(name, options.train)


if __name__ == "__main__":
    main()
