"""Sets that are used from their beginning: discrepancies of prefixes over those of Owen-scrambled Sobol points.

    python -m benchmarks.prefixes              # d = 2, 3, 5, 10, n = 256, four sets each

Methods: the network on the mean over all prefixes; annealing on the same; and the paper's way, an annealed set in
greedy order (next comes the point that leaves the prefix the lowest discrepancy).
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad._arrays import Floats
from evenroad.points import draw
from evenroad.points.bank import Bank
from evenroad.points.measures import MEASURES
from evenroad.research.network import NetworkConfig
from evenroad.research.training import anneal_many, train_many

LENGTHS = (20, 30, 50, 77, 100, 128, 150, 200, 256, 300, 400, 512)
OBJECTIVE = "prefixes(hickernell)"
SEED = 7


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


def profile(points: Floats, lengths: list[int]) -> Floats:
    return np.log([MEASURES["hickernell"].rooted(points[:length]) for length in lengths])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-d", type=int, nargs="+", default=[2, 3, 5, 10])
    parser.add_argument("-n", type=int, default=256)
    parser.add_argument("--sets", type=int, default=4)
    parser.add_argument("--steps", type=int, default=5000)
    options = parser.parse_args()
    n, lengths = options.n, [length for length in LENGTHS if length <= options.n]
    print(" d  method     s a set  " + "".join(f"{length:>7d}" for length in lengths) + "   largest error")
    for d in options.d:
        owen = [profile(draw("sobol", n, d, rng=seed).points, lengths) for seed in range(32)]
        for method in ("network", "annealing", "greedy"):
            began = time.process_time()
            if method == "network":
                config = NetworkConfig(n, d, OBJECTIVE, steps=options.steps)
                sets = [each.points for each in train_many(config, options.sets, rng=SEED, workers=1)]
            elif method == "annealing":
                made = anneal_many(n, d, OBJECTIVE, options.sets, steps=options.steps, rng=SEED, workers=1)
                sets = [each.points for each in made]
            else:
                shipped = Bank().cell("hickernell", n, d).load()[: options.sets]
                sets = [greedy(np.asarray(each, np.float64)) for each in shipped]
            seconds = (time.process_time() - began) / options.sets
            over = np.array([profile(each, lengths) for each in sets]) - np.mean(owen, axis=0)
            error = np.hypot(
                over.std(axis=0, ddof=1) / np.sqrt(len(sets)),
                np.std(owen, axis=0, ddof=1) / np.sqrt(len(owen)),
            )
            ratios = "".join(f"{ratio:7.3f}" for ratio in np.exp(over.mean(axis=0)))
            print(f"{d:2d}  {method:9s}  {seconds:7.1f}  {ratios}   {error.max():.3f}", flush=True)


if __name__ == "__main__":
    main()
