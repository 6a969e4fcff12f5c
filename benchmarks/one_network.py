"""One network for every N: trained over many N, measured on N that it never saw: ``python -m benchmarks.one_network``.

It moves the points ((i + 1/2) / n, i g + 1/2 modulo 1), g the golden ratio, in the plane; every tenth N is kept from
the training.  Beside it, annealing in as much time as one pass of the network takes, and at its standard of 5000 steps.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.points import draw
from evenroad.points.bank.anneal import anneal
from evenroad.points.measures import MEASURES
from evenroad.research.network import NetworkConfig
from evenroad.research.network.train import INSET, Network, moved, nearest
from evenroad.research.training.order import GOLDEN

UNSEEN = (50, 100, 150, 200, 250)
MEASURE = MEASURES["hickernell"]


def golden(n: int, k: int) -> tuple[Floats, Ints]:
    """Return the start of n points and its graph."""
    i = np.arange(n)
    starts = np.clip(np.column_stack([(i + 0.5) / n, (i * GOLDEN + 0.5) % 1.0]), INSET, 1.0 - INSET)
    return starts, nearest(starts, k)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--steps", type=int, default=30_000)
    parser.add_argument("--width", type=int, default=64)
    options = parser.parse_args()
    config = NetworkConfig(2, 2, width=options.width, steps=options.steps)
    draws = np.random.default_rng(0)
    network = Network(config, draws)
    seen = [golden(n, config.k) for n in range(32, 257) if n % 10]
    began = time.process_time()
    for step in range(options.steps):
        starts, neighbours = seen[draws.integers(len(seen))]
        points = moved(starts, network.moves(starts, neighbours))
        value, columns = MEASURE.of_columns(np.ascontiguousarray(points.T))
        # Of the logarithm: sets of all sizes count alike.
        slope = columns.T * points * (1.0 - points) / value
        network.learn(slope, config.rate * 0.5 * (1.0 + math.cos(math.pi * step / options.steps)))
    print(f"trained over {len(seen)} N in {time.process_time() - began:.0f} s of processor time")
    print("   n  start    network  ms    annealed as long  annealed, 5000 steps  Sobol")
    for n in UNSEEN:
        starts, neighbours = golden(n, config.k)
        times = []
        for _ in range(5):
            began = time.process_time()
            starts, neighbours = golden(n, config.k)
            points = moved(starts, network.moves(starts, neighbours))
            times.append(time.process_time() - began)
        few = 20
        anneal(n, 2, MEASURE, steps=few)
        began = time.process_time()
        anneal(n, 2, MEASURE, steps=few)
        steps = max(1, round(few * min(times) / (time.process_time() - began)))
        short = np.mean([anneal(n, 2, MEASURE, steps=steps, rng=seed).value for seed in range(8)])
        long = np.mean([anneal(n, 2, MEASURE, rng=seed).value for seed in range(8)])
        sobol = np.mean([MEASURE.rooted(draw("sobol", n, 2, rng=seed)) for seed in range(8)])
        print(
            f"{n:4d}  {MEASURE.rooted(starts):.5f}  {MEASURE.rooted(points):.5f}  {1e3 * min(times):4.1f}"
            f"  {short:.5f} ({steps} steps)  {long:.5f}               {sobol:.5f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
