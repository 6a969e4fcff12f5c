"""What a large trained set is worth for fewer axes and for fewer points: discrepancies beside sets made for them.

    python -m studies.benchmarks.reused_sets
    python -m studies.benchmarks.points_apart -d 5 -n 256 --only even sobol hickernell projected ordered

Means of the Hickernell L2 discrepancy over eight sets.  The large sets are those annealed for it, of ten dimensions for
the projections, of 1024 points for the orders.  The second command has what the sets are worth in planning.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from studies.benchmarks.rows import parser_of

from evenroad.points import PointSet, draw, greedy_order, prefix_discrepancies, project
from evenroad.points.bank import Bank
from evenroad.points.measures import MEASURES

SETS, LARGE_D, LARGE_N = 8, 10, 1024


def mean(values: Iterable[float]) -> str:
    """Return the mean as text."""
    return f"{np.mean(list(values)):.5f}"


def pool(n: int, d: int) -> list[PointSet]:
    """Return sets of the bank."""
    return [PointSet(each) for each in Bank().cell("hickernell", n, d).load()[:SETS]]


def projections(n: int) -> None:
    """Print what projections of ten-dimensional sets are worth."""
    rooted, large = MEASURES["hickernell"].rooted, pool(n, LARGE_D)
    for d in (2, 3, 5, 7):
        columns = {
            "first axes": mean(rooted(each.points[:, :d]) for each in large),
            "best axes": mean(rooted(project(each, d).points) for each in large),
            "made for d": mean(rooted(each.points) for each in pool(n, d)),
            "sobol": mean(rooted(draw("sobol", n, d, rng=seed).points) for seed in range(SETS)),
            "even": mean(rooted(draw("even", n, d, rng=seed).points) for seed in range(SETS)),
        }
        print(f"n={n} d={d}", *(f"{name} {value}" for name, value in columns.items()), flush=True)


def orders(d: int) -> None:
    """Print what the beginnings of a set in greedy order are worth."""
    rooted = MEASURES["hickernell"].rooted
    greedy = np.mean([prefix_discrepancies(greedy_order(each)) for each in pool(LARGE_N, d)], axis=0)
    for n in (50, 64, 100, 128, 256, 512):
        columns = {"greedy": f"{greedy[n - 1]:.5f}"}
        for name in ("sobol", "growing", "hickernell"):
            columns[name] = mean(rooted(draw(name, n, d, rng=seed).points) for seed in range(SETS))
        print(f"d={d} n={n}", *(f"{name} {value}" for name, value in columns.items()), flush=True)


def main() -> None:
    parser_of(__doc__).parse_args()
    for n in (256, 1024):
        projections(n)
    for d in (2, 3, 5, 10):
        orders(d)


if __name__ == "__main__":
    main()
