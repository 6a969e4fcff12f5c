"""A roadmap that is kept for a scene and asked often, with and without trees where ends are cut off; and trees alone.

    python -m benchmarks.arm_roadmap

Starts and goals are those of UR5 problems of one kind and seed: between the places that the scene has for the tool.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from benchmarks.arm_problems import KINDS, Pool, arm, queries
from evenroad.roadmap import Budget, PlanResult, Roadmap, find_path

MOST = Budget(seconds=2.0)


def line(name: str, ask: Callable[[np.ndarray, np.ndarray], PlanResult], pairs: np.ndarray) -> str:
    """Return one line of the table."""
    seconds, solved, lengths = [], 0, []
    for start, goal in pairs:
        before = time.perf_counter()
        result = ask(start, goal)
        seconds.append(1e3 * (time.perf_counter() - before))
        solved += result.solved
        lengths.append(result.cost if result.cost is not None else np.nan)
    half = np.array(seconds[len(seconds) // 2 :])
    return (
        f"| {name} | {100 * solved / len(pairs):.0f} % | {np.median(seconds):.2f} | {np.median(half):.2f} |"
        f" {np.mean(half):.2f} | {np.quantile(half, 0.95):.2f} | {np.nanmedian(lengths):.2f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, default=2048)
    parser.add_argument("--queries", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1000)
    arguments = parser.parse_args()
    pool = Pool(arm("ur5"))
    for kind in KINDS:
        world, pairs = queries(pool, kind, arguments.seed, arguments.queries)
        find_path(world, *pairs[0])
        roadmap = Roadmap.build(world.space, arguments.n)
        print(
            f"\n{kind}\n\n| | solved | median ms | second half: median | mean | 95 % | length |\n|"
            + "---|" * 7
        )
        for name, connect in (("roadmap", False), ("roadmap, then trees", True)):
            known = roadmap.in_world(world)
            known.query(*pairs[0])
            known = roadmap.in_world(world)

            def ask(start, goal, known=known, connect=connect):  # type: ignore[no-untyped-def]
                return known.query(start, goal, connect=connect, budget=MOST)

            print(line(name, ask, pairs), flush=True)
        print(
            line("trees", lambda start, goal, world=world: find_path(world, start, goal, budget=MOST), pairs)
        )


if __name__ == "__main__":
    main()
