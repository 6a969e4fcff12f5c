"""Milliseconds a query on one roadmap of 4096 points in each maze, while it learns.

    python -m benchmarks.roadmap_queries

Starts and goals are uniform valid configurations.  A query validates the two, joins them to the roadmap, searches
lazily and returns the path; the first thousand warm the roadmap up, the next thousand count.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from evenroad.points import draw
from evenroad.roadmap import KNearest, Roadmap
from evenroad.world.gridmap.shipped import LEVELS, load_maze


def measure(level: int, n: int, k: int, queries: int, links: int | None = None) -> str:
    """Return one line of the table."""
    world = load_maze(level).world()
    begin = time.perf_counter()
    roadmap = Roadmap.build(world.space, draw("sobol", n, 2), KNearest(k))
    built = time.perf_counter()
    known = roadmap.in_world(world)
    ready = time.perf_counter()
    # A second world: the roadmap is measured, and no milestone is asked for.
    roadmap.in_world(world, lazy_milestones=True)
    again = time.perf_counter()
    places = world.space.from_cube(draw("uniform", 8 * queries, 2, rng=1).points)
    pairs = places[world.valid(places)][: 4 * queries].reshape(-1, 2, 2)
    seconds, checks, solved = [], [], 0
    for start, goal in pairs:
        before = time.perf_counter()
        result = known.query(start, goal, links=links, shorten=False)
        seconds.append(time.perf_counter() - before)
        checks.append(result.counts["edges_checked"])
        solved += result.solved
    cold, warm = 1e3 * np.array(seconds[:100]), 1e3 * np.array(seconds[queries:])
    return (
        f"| {level} | {n} | {k} | {1e3 * (built - begin):.0f} | {1e3 * (ready - built):.1f} |"
        f" {1e3 * (again - ready):.2f} | {np.median(cold):.2f} | {np.median(warm):.2f} |"
        f" {np.quantile(warm, 0.95):.2f} |"
        f" {np.mean(checks[:100]):.1f} | {np.mean(checks[queries:]):.1f} | {100 * solved / len(pairs):.1f} % |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=4096)
    parser.add_argument("-k", type=int, nargs="+", default=[10, 20])
    parser.add_argument("--links", type=int, help="default: as the rule says")
    parser.add_argument("--queries", type=int, default=1000)
    arguments = parser.parse_args()
    measure(1, 64, 10, 10)
    print(
        "| level | N | k | build ms | milestones ms | another world ms | ms a query, first 100 | ms, warm |"
        " 95 %, warm | checks, first 100 | checks, warm | solved |"
    )
    print("|" + "---|" * 12)
    for k in arguments.k:
        for level in LEVELS:
            print(measure(level, arguments.n, k, arguments.queries, arguments.links), flush=True)


if __name__ == "__main__":
    main()
