"""What else the network could do, beside what it does: ``python -m benchmarks.network_trials``.

Eight sets of 128 points, 2000 steps unless a row says more; mean Hickernell discrepancy over that of the annealed pool,
with its standard error, and processor time beside that of the first row.
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any
from unittest import mock

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.points.bank import Bank
from evenroad_studies.network import NetworkConfig, train
from evenroad_studies.network.train import Network, moved, nearest

N, SEED, REBUILT = 128, 7, 50

TRIALS: dict[str, dict[str, Any]] = {
    "as it is": {},
    "five times the steps": {"times": 5},
    "best of four, a quarter of the steps each": {"restarts": 4},
    "width 16": {"width": 16},
    "width 32": {"width": 32},
    "width 64": {"width": 64},
    "width 128": {"width": 128},
    "16 neighbours": {"k": 16},
    "five layers": {"layers": 5},
    f"graph rebuilt every {REBUILT} steps": {"rebuilt": True},
    "noise on the weights": {"shaken": True},
    "no drift of the starts": {"noise": 0.0},
    "drift of half an annealing's noise": {"noise": 0.5},
    "Sobol starts": {"start": "sobol"},
    "Kronecker starts, no drift": {"start": "kronecker", "noise": 0.0},
    "Korobov starts": {"start": "korobov"},
    "Halton starts": {"start": "halton"},
    "random starts": {"start": "uniform"},
}


class Rebuilt(Network):
    """A network whose graph joins the points as they are now, not their starts."""

    def moves(self, starts: Floats, neighbours: Ints) -> Floats:
        """Return by how much to move each start, along a graph that is some steps old at most."""
        if self._step and self._step % REBUILT == 0:
            self._graph = nearest(self._made, neighbours.shape[1])
        moves = super().moves(starts, self._graph if self._step >= REBUILT else neighbours)
        self._made = moved(starts, moves)
        return moves


class Shaken(Network):
    """A network whose weights get Gaussian noise after every step, a third of the rate and so cooling with it."""

    def learn(self, slope: Floats, rate: float) -> None:
        """Do a step of Adam, and shake the weights."""
        super().learn(slope, rate)
        noise = np.random.default_rng(self._step).standard_normal(self.weights.size)
        self.weights += (rate / 3.0 * noise).astype(np.float32)


def values(d: int, sets: int, steps: int, trial: dict[str, Any]) -> Floats:
    """Return the best discrepancy of each set."""
    options = dict(trial)
    steps, restarts = steps * options.pop("times", 1), options.pop("restarts", 1)
    made = Rebuilt if options.pop("rebuilt", False) else Shaken if options.pop("shaken", False) else Network
    config = NetworkConfig(N, d, steps=steps // restarts, **options)
    with mock.patch.object(sys.modules["evenroad_studies.network.train"], "Network", made):
        seeds = np.random.SeedSequence(SEED).spawn(sets * restarts)
        return np.array([train(config, rng=seed).value for seed in seeds]).reshape(sets, restarts).min(axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-d", type=int, nargs="+", default=[2, 10])
    parser.add_argument("--only", nargs="+", help="rows whose names have one of these words in them")
    parser.add_argument("--sets", type=int, default=8)
    parser.add_argument("--steps", type=int, default=2000)
    options = parser.parse_args()
    for d in options.d:
        level = np.mean(Bank().cell("hickernell", N, d).measures["hickernell_rooted"])
        values(d, 1, 20, {})  # compiles
        first = 0.0
        for name, trial in TRIALS.items():
            if first and options.only and not any(word in name for word in options.only):
                continue
            began = time.process_time()
            ratios = values(d, options.sets, options.steps, trial) / level
            took = time.process_time() - began
            first = first or took
            error = ratios.std(ddof=1) / np.sqrt(len(ratios)) if len(ratios) > 1 else np.nan
            print(f"| {d} | {name} | {ratios.mean():.3f} ± {error:.3f} | {took / first:.1f} |", flush=True)


if __name__ == "__main__":
    main()
