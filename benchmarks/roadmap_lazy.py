"""Share of the full roadmap's motion checks that other searches need on the shipped mazes, same points and rule.

    python -m benchmarks.roadmap_lazy --runs 50

Lazy must find the path of the full search in every run, or the script stops.  Medians over scrambled Sobol sets;
milliseconds are those of the search with its checks (validity, motions, search), in which the disk world answers a
motion in a microsecond: lazy is for worlds where that takes a thousand times as long.
"""

from __future__ import annotations

import argparse

import numpy as np

from evenroad.points import draw
from evenroad.roadmap import KNearest, PlanResult, fmt, plan
from evenroad.world.gridmap.shipped import LEVELS, load_maze

PHASES = ("validity", "motions", "search")


def searches(level: int, n: int, k: int, run: int) -> dict[str, PlanResult]:
    """Return the answers of all searches to one query, by name."""
    maze = load_maze(level)
    query = maze.world(), maze.start, maze.goal, draw("sobol", n, 2, rng=run)
    options = dict(rule=KNearest(k), links=None, shorten=False)
    return {
        "full": plan(*query, **options),
        "lazy": plan(*query, search="lazy", **options),
        "lazy + milestones": plan(*query, search="lazy", lazy_milestones=True, **options),
        "success only": plan(*query, success_only=True, **options),
        "fmt*": fmt(*query, **options),
    }


def require_same_path(one: PlanResult, other: PlanResult) -> None:
    """Stop unless the two answers are equal bit for bit."""
    paths = [None if result.path is None else result.path.tobytes() for result in (one, other)]
    if paths[0] != paths[1] or one.cost != other.cost:
        raise SystemExit("lazy and full differ")


def row(level: int, n: int, k: int, name: str, answers: list[dict[str, PlanResult]]) -> str:
    """Return one line of the table."""
    full, here = [answer["full"] for answer in answers], [answer[name] for answer in answers]
    checks = [result.counts["edges_checked"] for result in here]
    share = [100 * mine / theirs.counts["edges_checked"] for mine, theirs in zip(checks, full, strict=True)]
    configurations = [result.counts["configurations_checked"] for result in here]
    seconds = [sum(result.timings[phase] for phase in PHASES) for result in here]
    longer = [
        100 * (mine.cost / theirs.cost - 1)
        for mine, theirs in zip(here, full, strict=True)
        if mine.cost is not None and theirs.cost is not None
    ]
    solved = sum(result.solved for result in here)
    return (
        f"| {level} | {n} | {k} | {name} | {solved}/{len(here)} | {np.median(checks):.0f} |"
        f" {np.median(share):.1f} % | {np.quantile(share, 0.9):.1f} % | {np.median(configurations):.0f} |"
        f" {1e3 * np.median(seconds):.1f} | {np.median(longer) if longer else np.nan:+.2f} % |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("-n", type=int, default=1024)
    parser.add_argument("-k", type=int, nargs="+", default=[10, 20])
    arguments = parser.parse_args()
    searches(1, 64, 10, 0)
    print(
        "| level | N | k | search | solved | motions checked | share | 90 % quantile | configurations | ms | path |"
    )
    print("|" + "---|" * 11)
    for k in arguments.k:
        for level in LEVELS:
            answers = [searches(level, arguments.n, k, run) for run in range(arguments.runs)]
            for answer in answers:
                require_same_path(answer["full"], answer["lazy"])
            for name in answers[0]:
                print(row(level, arguments.n, k, name, answers), flush=True)


if __name__ == "__main__":
    main()
