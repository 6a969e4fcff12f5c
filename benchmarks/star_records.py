"""Exact star discrepancies in the plane beside the published best: ``python -m benchmarks.star_records``.

Methods: a search over orders; the network on the L2 star discrepancy, from Kronecker points and with the exact star
discrepancy as its judge; these starts as they are; annealing.  The best set counts, as it is and with its points placed
anew in their order.  The published figures are those of MPMC (Rusch et
al. 2024) and the best that Clement, Doerr, Klamroth and Paquete (2024) give.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.points import PointSet
from evenroad.points.measures import star_discrepancy
from evenroad_studies.network import NetworkConfig
from evenroad_studies.network.train import kronecker
from evenroad_studies.training import anneal_many, order_many, train_many
from evenroad_studies.training.order import place_order

PUBLISHED = {  # n: MPMC, best known
    20: (0.0640, 0.0611),
    60: (0.0273, 0.0234),
    100: (0.0188, 0.0150),
    140: (0.0137, 0.0115),
    260: (0.0084, 0.0083),
    500: (0.0052, 0.0051),
    1020: (np.nan, 0.0025),
}
SEED = 7


def order_of(points: Floats) -> Ints:
    """Return the ranks by y of points sorted by x."""
    by_x = points[np.argsort(points[:, 0], kind="stable")]
    return np.argsort(np.argsort(by_x[:, 1], kind="stable"))


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-n", type=int, nargs="+", default=list(PUBLISHED))
    parser.add_argument("--sets", type=int, default=8)
    parser.add_argument("--methods", nargs="+", default=["order", "network", "start", "annealing"])
    parser.add_argument(
        "--steps", type=int, default=5000, help="of a set; orders of more than 300 points: a tenth"
    )
    options = parser.parse_args()
    print("   n  published MPMC, best   method     best     placed   mean +- standard error   s a set")
    for n in options.n:
        for method in options.methods:
            steps = options.steps // 10 if method == "order" and n > 300 else options.steps
            began = time.process_time()
            if method == "order":
                sets = order_many(n, options.sets, steps=steps, rng=SEED, workers=1)
            elif method == "network":
                config = NetworkConfig(n, 2, "star", steps=steps, judge="star")
                sets = train_many(config, options.sets, rng=SEED, workers=1)
            elif method == "start":
                shifts = np.random.default_rng(SEED).random((options.sets, 2))
                sets = tuple(PointSet(kronecker(n, shift)) for shift in shifts)
            else:
                sets = anneal_many(n, 2, "star", options.sets, steps=steps, rng=SEED, workers=1)
            seconds = (time.process_time() - began) / options.sets
            values = np.array([star_discrepancy(each) for each in sets])
            placed = min(place_order(order_of(each.points)).value for each in sets)
            error = values.std(ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan
            mpmc, best = PUBLISHED.get(n, (np.nan, np.nan))
            print(
                f"{n:4d}  {mpmc:14.4f}, {best:.4f}   {method:9s}  {values.min():.5f}"
                f"  {placed:.5f}  {values.mean():.5f} +- {error:.5f}  {seconds:14.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
