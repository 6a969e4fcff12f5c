"""What queries of a robot's roadmap cost, and what whole turns are worth.

    python -m benchmarks.robot_roadmap_queries --queries 100
    python -m benchmarks.robot_roadmap_queries --counts 60
    python -m benchmarks.robot_roadmap_queries --suite 150
    python -m benchmarks.robot_roadmap_queries --turns 40
    python -m benchmarks.robot_roadmap_queries --prices 40

Scenes and problems come from the seeds kept for reporting.  Times are of the processor, the best of three: three copies
of a kept roadmap learn the same side by side, so that none answers a query that it knows.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.arm_problems import KINDS, REPORTING, TUNING, Pool, Problem, arm, problems, queries
from benchmarks.robot_roadmaps import table_of
from evenroad.roadmap import Budget, PlanResult
from evenroad.roadmap.find_path import find_path
from evenroad.robot import ArmWorld, Scene, with_limits
from evenroad.robot.trees import tighten
from evenroad.robot_roadmap import scene_roadmap
from evenroad.robot_roadmap.chance import chance_of_freedom
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.scene_roadmap import AMONG_SURFACES, WORK, SceneRoadmap
from evenroad.robot_roadmap.search_memory import NUMBER
from evenroad_studies.arms.problems import draw_problem
from evenroad_studies.arms.roadmaps import made_roadmap
from evenroad_studies.arms.scenes import GENERATORS

COPIES = 3
SCENES = 6
FIRST = 9
"""So many queries in a scene come before those that count."""

SCENES_AT_RANDOM = 400
"""By which the chance that an edge is free is measured."""

LIMIT = Budget(seconds=1.0)
TURN = 2.0 * np.pi


class TightWorld(ArmWorld):
    """An arm's world whose paths are drawn tight as those of a kept roadmap are, whatever the trees have taken."""

    def shorten(self, path: np.ndarray) -> tuple[np.ndarray, int]:
        """Return a path that is not longer, and how many motions were looked at."""
        return tighten(self, path, batches=WORK if self.lanes.surfaces is None else AMONG_SURFACES)


def timed(calls: Sequence[Callable[[], PlanResult]]) -> tuple[float, PlanResult]:
    """Return the least time of some calls that all do the same, and the first result."""
    seconds, results = [], []
    for call in calls:
        began = time.thread_time()
        results.append(call())
        seconds.append(time.thread_time() - began)
    return min(seconds), results[0]


def in_new_scene(made: RobotRoadmap, scene: Scene, start: np.ndarray, goal: np.ndarray) -> PlanResult:
    """Plan along the roadmap in a scene that it has never seen."""
    return made.in_scene(scene).plan(start, goal, budget=LIMIT)


def costs(name: str, count: int, n: int, kinds: list[str], seeds: range = REPORTING) -> None:
    """Print milliseconds, motions and lengths of queries, along a kept roadmap and with trees.

    Trees have three copies of their world, as the roadmap has: none comes upon a warm cache.
    """
    pool = Pool(arm(name))
    began = time.process_time()
    made = make_roadmap(pool.robot, table_of(next(problems(pool, REPORTING))), n)
    print(f"roadmap of {n} made in {time.process_time() - began:.1f} s of the processor")
    print(
        "| kind | planner | median ms | 95 % ms | 95 % / trees | motions | trees alone | length / trees | of all |"
    )
    print("|---|" + "---|" * 8)
    for kind in kinds:
        rows: dict[str, list[tuple[float, float, float, float]]] = {}
        straight, unsolved = [], 0
        for seed in seeds[:SCENES]:
            world, pairs = queries(pool, kind, seed, count)
            alone, tight = (
                [of(world.robot, world.scene) for _ in range(COPIES)] for of in (ArmWorld, TightWorld)
            )
            copies = [SceneRoadmap(made, world.scene) for _ in range(COPIES)]
            for number, (start, goal) in enumerate(pairs):
                ends = partial(find_path, start=start, goal=goal, budget=LIMIT)
                calls = {
                    "trees": [partial(ends, w) for w in alone],
                    "trees, drawn tight": [partial(ends, w) for w in tight],
                    "roadmap, kept scene": [partial(k.plan, start, goal, budget=LIMIT) for k in copies],
                    "roadmap, new scene": [partial(in_new_scene, made, world.scene, start, goal)] * COPIES,
                    "trees, new scene": [partial(made.plan, world.scene, start, goal, budget=LIMIT)] * COPIES,
                }
                answers = {title: timed(some) for title, some in calls.items()}
                apart = np.linalg.norm(start - goal)
                unsolved += not all(result.solved for _, result in answers.values())
                if number < FIRST or apart < 1e-6 or not all(r.solved for _, r in answers.values()):
                    continue
                straight.append(apart)
                for title, (seconds, result) in answers.items():
                    motions = sum(result.counts.get(c, 0) for c in ("edges_checked", "shortcut_motions"))
                    helped = result.planner.endswith("then trees")
                    assert result.cost is not None
                    rows.setdefault(title, []).append((seconds, motions, helped, result.cost))
        trees = np.array(rows["trees"])
        for title, values in rows.items():
            table = np.array(values)
            ms = 1e3 * table[:, 0]
            ratio, low, high = ratio_of_tails(table[:, 0], trees[:, 0])
            shares = table[:, 3] / trees[:, 3]
            error, whole = shares.std(ddof=1) / np.sqrt(len(shares)), table[:, 3].sum() / trees[:, 3].sum()
            figures = (
                f"{np.median(ms):.3f} | {np.quantile(ms, 0.95):.3f} | {ratio:.2f} ({low:.2f} .. {high:.2f})"
            )
            print(
                f"| {kind} | {title} | {figures} | {table[:, 1].mean():.0f} | {100 * table[:, 2].mean():.0f} % |"
                f" {shares.mean():.3f} ± {error:.3f} | {whole:.3f} |",
                flush=True,
            )
        print(
            f"{kind}: {len(trees)} queries, {unsolved} unsolved; straight from start to goal is"
            f" {np.mean(straight / trees[:, 3]):.3f} of the trees' length"
        )


def counts(name: str, count: int, n: int, kinds: list[str]) -> None:
    """Print how many configurations and motions the first query in a scene asks about, without trees: medians."""
    pool = Pool(arm(name))
    made = make_roadmap(pool.robot, table_of(next(problems(pool, REPORTING))), n)
    for kind in kinds:
        results = [
            made.in_scene(p.scene).plan(p.start, p.goal, shorten=False, trees=False)
            for p in indirect(pool, REPORTING[:count], (kind,))
        ]
        if not results:
            print(f"{kind}: no problem whose straight motion is not free")
            continue
        asked = np.array([[r.counts["configurations_checked"], r.counts["edges_checked"]] for r in results])
        share = 100 * np.mean([r.solved for r in results])
        print(
            f"{kind}: median of {np.median(asked[:, 0]):.0f} configurations and {np.median(asked[:, 1]):.0f} motions,"
            f" {share:.0f} % of {len(results)} solved",
            flush=True,
        )


def counts_in_suite(name: str, count: int, n: int, draws: int) -> None:
    """Print the same for problems of `evenroad bench arms`, and what it is without links that are put off."""
    mades = [made_roadmap(name, n, draw, 0) for draw in range(draws)]
    put_off = scene_roadmap.NEARBY
    print("| kind | solved | configurations | motions (95 %) | motions, none put off | length |")
    for kind in GENERATORS:
        rows = np.empty((count, draws, 2, 3))
        for number in range(count):
            problem = draw_problem(name, kind, "report", number)
            assert isinstance(problem.world, ArmWorld)
            for draw, nearby in np.ndindex(draws, 2):
                scene_roadmap.NEARBY = (0.0, put_off)[nearby]
                found = (
                    mades[draw].in_scene(problem.world.scene).plan(problem.start, problem.goal, trees=False)
                )
                asked = found.counts.get("configurations_checked", 0), found.counts["edges_checked"]
                rows[number, draw, nearby] = *asked, found.cost if found.solved else np.nan
        solved, rng = np.isfinite(rows[..., 2]), np.random.default_rng(0)
        assert (solved[..., 0] == solved[..., 1]).all()
        medians, both = [], rows[solved[..., 0]]
        for _ in range(2000):
            again = rng.integers(count, size=count)
            medians.append(np.median(rows[again][solved[again][..., 0]][:, :, 1], axis=0))
        (low0, low), (high0, high) = np.quantile(medians, [0.025, 0.975], axis=0)
        before, after = np.median(both, axis=0)
        longer = both[:, 1, 2] / both[:, 0, 2]
        print(
            f"| {kind} | {100 * solved[..., 0].mean():.0f} % of {solved[..., 0].size} | {after[0]:.0f} |"
            f" {after[1]:.0f} ({low:.0f} .. {high:.0f}) | {before[1]:.0f} ({low0:.0f} .. {high0:.0f}) |"
            f" {longer.mean():.3f} ± {longer.std(ddof=1) / np.sqrt(len(longer)):.3f} |",
            flush=True,
        )


def prices(name: str, count: int, n: int) -> None:
    """Print what it is worth, on tuning seeds, that an edge is dearer the less often random boxes leave it free."""
    pool = Pool(arm(name))
    cell, some = table_of(next(problems(pool, TUNING))), indirect(pool, TUNING[:count])
    made = make_roadmap(pool.robot, cell, n)
    a, b = made.milestones[made.edges[:, 0]], made.milestones[made.edges[:, 1]] + TURN * made.turns
    places = np.concatenate([a + share * (b - a) for share in (0.0, 0.25, 0.5, 0.75, 1.0)])
    free = chance_of_freedom(
        pool.robot, places, SCENES_AT_RANDOM, np.random.default_rng(0), lambda share: None
    )
    # Beta(1, 1) before the random scenes.
    chance = (SCENES_AT_RANDOM * free.reshape(5, -1).min(axis=0) + 1.0) / (SCENES_AT_RANDOM + 2.0)

    def asked(made: RobotRoadmap) -> np.ndarray:
        rows = []
        for p in some:
            r = made.in_scene(p.scene).plan(p.start, p.goal, trees=False)
            rows.append((r.counts["edges_checked"], r.cost if r.solved else np.nan, r.solved))
        return np.array(rows, dtype=float)

    before = asked(made)
    print("| power | motions | difference | length, both solved | solved |\n|---|---|---|---|---|")
    for power in (1.0, 2.0, 4.0):
        priced = replace(made)
        halves = 2 * len(made.edges)
        priced.graph.lengths[:halves] /= chance[priced.graph.halves[:halves, NUMBER]] ** power
        after = asked(priced)
        apart, length = after[:, 0] - before[:, 0], after[:, 1] / before[:, 1] - 1.0
        length = length[np.isfinite(length)]
        errors = [x.std(ddof=1) / np.sqrt(len(x)) for x in (apart, length)]
        print(
            f"| {power:g} | {before[:, 0].mean():.0f} -> {after[:, 0].mean():.0f} |"
            f" {apart.mean():+.1f} ± {errors[0]:.1f} |"
            f" {100 * length.mean():+.1f} ± {100 * errors[1]:.1f} % |"
            f" {100 * before[:, 2].mean():.1f} -> {100 * after[:, 2].mean():.1f} % of {len(some)} |",
            flush=True,
        )


def ratio_of_tails(a: np.ndarray, b: np.ndarray) -> tuple[float, float, float]:
    """Return the ratio of the 95 % quantiles of two paired samples, and its 95 % interval by bootstrap."""
    rng = np.random.default_rng(0)
    ratios = []
    for _ in range(2000):
        rows = rng.integers(len(a), size=len(a))
        ratios.append(np.quantile(a[rows], 0.95) / np.quantile(b[rows], 0.95))
    low, high = np.quantile(ratios, [0.025, 0.975])
    return float(np.quantile(a, 0.95) / np.quantile(b, 0.95)), float(low), float(high)


def indirect(pool: Pool, seeds: range, kinds: tuple[str, ...] = KINDS) -> list[Problem]:
    """Return the problems whose straight motion is not free."""
    return [
        problem
        for problem in problems(pool, seeds, kinds)
        if not ArmWorld(pool.robot, problem.scene).motion_valid(problem.start[None], problem.goal[None])[0]
    ]


def solved(made: RobotRoadmap, some: list[Problem]) -> np.ndarray:
    """Return which problems the roadmap solves without trees, (p,), every path proved again."""
    verdicts = []
    for problem in some:
        known = SceneRoadmap(made, problem.scene)
        result = known.plan(problem.start, problem.goal, shorten=False, trees=False)
        verdicts.append(result.path is not None and bool(known.world.recheck(result.path).all()))
    return np.array(verdicts, dtype=float)


def paired(title: str, some: list[Problem], a: np.ndarray, b: np.ndarray) -> None:
    """Print the shares solved, by kind, of two methods, (draws, p) each, and their difference over problems."""
    for kind in (*dict.fromkeys(problem.kind for problem in some), "all"):
        of = np.array([kind in (problem.kind, "all") for problem in some])
        apart = 100.0 * (a[:, of] - b[:, of]).mean(axis=0)
        error = apart.std(ddof=1) / np.sqrt(len(apart))
        print(
            f"| {title} | {kind} | {100 * b[:, of].mean():.1f} | {100 * a[:, of].mean():.1f} |"
            f" {apart.mean():+.1f} ± {error:.1f} |",
            flush=True,
        )


def turns(name: str, count: int, n: int, draws: int) -> None:
    """Print what edges that wrap are worth on a robot whose pan and wrists have two turns."""
    pool = Pool(arm(name))
    some, cell = indirect(pool, REPORTING[:count]), table_of(next(problems(pool, REPORTING)))
    free = [j for j in pool.robot.group if j not in ("shoulder_lift_joint", "elbow_joint")]
    wide = with_limits(pool.robot, dict.fromkeys(free, (-TURN, TURN)))
    one, two = [], []
    for draw in range(draws):
        one.append(solved(make_roadmap(pool.robot, cell, n, k=10, rng=draw), some))
        two.append(solved(make_roadmap(wide, cell, n, k=10, rng=draw), some))
    print(f"N = {n}, {draws} draws, {len(some)} problems\n| | kind | one turn | whole turns | difference |")
    print("|---|---|---|---|---|")
    paired("whole turns", some, np.array(two), np.array(one))
    lost = int(np.sum((np.array(one) == 1.0) & (np.array(two) == 0.0)))
    print(f"solved in one turn and not with whole turns: {lost} of {int(np.sum(one))}")


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--robot", default="ur5")
    parser.add_argument("--queries", type=int, default=0, help="in each scene")
    parser.add_argument("--counts", type=int, default=0, help="problems of each kind")
    parser.add_argument("--suite", type=int, default=0, help="problems of each of the suite's generators")
    parser.add_argument("--turns", type=int, default=0, help="problems of each kind")
    parser.add_argument("--prices", type=int, default=0, help="problems of each kind")
    parser.add_argument("--tuning", action="store_true", help="queries on the seeds kept for tuning")
    parser.add_argument("--draws", type=int, default=2)
    parser.add_argument("-n", type=int, help="milestones; default: 1024 for queries, else 256")
    parser.add_argument("--kinds", nargs="+", default=["table", "box", "shelf"], choices=KINDS)
    options = parser.parse_args()
    if options.queries:
        seeds = TUNING if options.tuning else REPORTING
        costs(options.robot, options.queries, options.n or 1024, options.kinds, seeds)
    if options.counts:
        counts(options.robot, options.counts, options.n or 1024, options.kinds)
    if options.suite:
        counts_in_suite(options.robot, options.suite, options.n or 1024, options.draws)
    if options.turns:
        turns(options.robot, options.turns, options.n or 256, options.draws)
    if options.prices:
        prices(options.robot, options.prices, options.n or 1024)


if __name__ == "__main__":
    main()
