"""Corridors in d = 2, 3, 6 with N = 1024: OMPL's PRM with a Python checker, and ours, side by side in one process.

pip install -c constraints.txt -e '.[peers]'      # ompl 2.0.1
python -m studies.benchmarks.ompl_corridor
"""

from __future__ import annotations

import statistics
import time

from evenroad.points import draw
from evenroad.roadmap import KEarlier, plan
from evenroad_studies.worlds import Corridor

N = 1024
SHAPES = ((2, 0.1), (3, 0.2), (6, 0.37))
REPEATS = 15


def corridor_checker(d: int, lam: float):  # type: ignore[no-untyped-def]
    """Return the corridor's definition as a plain Python function of one state."""

    def valid(x):  # type: ignore[no-untyped-def]
        return any(all(v <= lam for v in x[:k]) and all(v >= 1 - lam for v in x[k + 1 :]) for k in range(d))

    return valid


def median_seconds(run, repeats: int = REPEATS) -> float:  # type: ignore[no-untyped-def]
    run()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        run()
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def main() -> None:
    try:
        from studies.benchmarks.ompl_peer import ompl_prm
    except ImportError:
        print("needs ompl: pip install -c constraints.txt -e '.[peers]'")
        return
    print("| corridor, N=1024 | OMPL [ms] | all edges [ms] | ratio | success only [ms] | ratio | agree |")
    print("|---|---|---|---|---|---|---|")
    for d, lam in SHAPES:
        world = Corridor(d, lam)
        points = draw("uniform", N, d, rng=0)
        rule = KEarlier(10)
        peer = [
            ompl_prm(corridor_checker(d, lam), points.points, world.start, world.goal, 0.001)
            for _ in range(3)
        ]
        theirs = statistics.median(seconds for _, _, seconds in peer)

        def ask(world=world, points=points, rule=rule, **how):  # type: ignore[no-untyped-def]
            return plan(world, world.start, world.goal, points, rule=rule, links=None, shorten=False, **how)

        full, quick = median_seconds(ask), median_seconds(lambda ask=ask: ask(success_only=True))
        agree = ask().solved == ask(success_only=True).solved == peer[0][0]
        print(
            f"| d={d}, lambda={lam} | {1e3 * theirs:.0f} | {1e3 * full:.2f} | {theirs / full:.0f}x"
            f" | {1e3 * quick:.2f} | {theirs / quick:.0f}x | {agree} |"
        )
        result = ask()
        motions = result.counts["edges_checked"]
        ours_alone = result.timings["motions"] / motions
        states = peer[0][1]
        print(
            f"  a motion, neither skipping work: OMPL {1e6 * theirs / motions:.1f} us (with sampling and neighbours),"
            f" ours {1e6 * full / motions:.2f} us with and {1e6 * ours_alone:.2f} us without them;"
            f" {motions} motions, OMPL asked for {states} states"
        )


if __name__ == "__main__":
    main()
