"""A frozen set of answers: 10^6 verdicts, 500 plans with their paths, 2000 rows of a store; today's must be the same.

    python -m studies.benchmarks.frozen                 # compare today's tree with the kept set, bit for bit
    python -m studies.benchmarks.frozen --only arms     # the parts whose names have this in them
    python -m studies.benchmarks.frozen --write         # keep today's answers in their place; say why in the commit

Verdicts are kept as bits, plans and rows as one line each with a digest of the path's bytes.  So a change of structure,
or of the language that the kernel is written in, shows where it changed an answer.  The same bits come on one kind of
processor only: the kept file names the one it was made on.
"""

from __future__ import annotations

import hashlib
import platform
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_problems import KINDS, Pool, Problem, arm_named, problems
from studies.benchmarks.clouds import points_on, triangles_of
from studies.benchmarks.rows import parser_of

from evenroad import draw
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry import Mesh, PointCloud
from evenroad.planning import FMT, PRM, GrowingPRM, PlanResult, plan
from evenroad.roadmap import Budget, KNearest, build_roadmap
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.world import World
from evenroad.world.gridmap.load import load_maze
from evenroad_studies.bench.execute import run_task
from evenroad_studies.bench.task import Task
from evenroad_studies.problems import source_named
from evenroad_studies.suites import fair_suite, paper_suite

KEPT = Path(__file__).with_suffix(".npz")
SEEDS = range(3_000, 3_003)
"""Problems of arms: apart from those that constants were chosen on, and those that tables report."""

Lines = list[str]
Bools = npt.NDArray[np.bool_]


def verdicts(world: World, states: int, motions: int, *, seed: int = 0) -> Bools:
    """Return verdicts of random states and motions, and of states that were bisected to contact."""
    rng = np.random.default_rng(seed)
    q = world.space.from_cube(rng.random((states, world.space.cube_dim)))
    free = world.valid(q)
    apart = min(motions, np.count_nonzero(free), np.count_nonzero(~free))
    a, b = q[free][:apart], q[~free][:apart]
    for _ in range(12):
        middle = world.space.interpolate(a, b, 0.5)
        here = world.valid(middle)
        a, b = np.where(here[:, None], middle, a), np.where(here[:, None], b, middle)
    near = world.space.interpolate(a, b, 0.5)
    short = world.space.interpolate(q[:motions], q[motions : 2 * motions], 0.2)
    found = [free, world.valid(near), world.motion_valid(q[:motions], short)]
    if hasattr(world, "validate"):
        found.append(world.validate(np.stack([q[:motions], short], axis=1).reshape(-1, world.space.dim)))
    return np.concatenate(found)


def arm_problems() -> Iterator[Problem]:
    """Yield problems of two arms among shelves, boxes, cages and tables."""
    for name in ("ur5", "arm7"):
        yield from problems(Pool(arm_named(name)), SEEDS)


def map_verdicts() -> Bools:
    return np.concatenate([verdicts(load_maze(level).world(), 70_000, 25_000) for level in (1, 2, 3)])


def arm_verdicts() -> Bools:
    found = []
    for problem in arm_problems():
        found.append(verdicts(ArmWorld(problem.robot, problem.scene), 10_000, 2_000))
    return np.concatenate(found)


def body_verdicts() -> Bools:
    names = ("cubicles", "twistycool", "chain-10d", "corridor-10d-0.37", "corridor-2d-0.1")
    return np.concatenate([verdicts(source_named(name).make(0).world, 25_000, 5_000) for name in names])


def surface_worlds(kind: str) -> Iterator[ArmWorld]:
    """Yield the worlds of some problems with points or triangles in place of their boxes."""
    for problem in arm_problems():
        if problem.kind != KINDS[0]:
            continue
        boxes = [each for each in problem.scene.obstacles if each.name != "table"]
        table = [each for each in problem.scene.obstacles if each.name == "table"]
        rng = np.random.default_rng(problem.seed)
        if kind == "points":
            cloud = PointCloud(points_on(Scene(tuple(boxes), name="boxes"), 20_000, rng), 0.005)
            things = [Obstacle("cloud", cloud)]
        else:
            things = [Obstacle(each.name, Mesh(triangles_of(each, 2))) for each in boxes]
        scene = Scene((*table, *things), name=problem.scene.name, allowed=problem.scene.allowed)
        yield ArmWorld(problem.robot, scene)


def surface_verdicts(kind: str) -> Bools:
    return np.concatenate([verdicts(world, 20_000, 2_000) for world in surface_worlds(kind)])


VERDICTS: dict[str, Callable[[], Bools]] = {
    "maps": map_verdicts,
    "arms": arm_verdicts,
    "bodies": body_verdicts,
    "clouds": partial(surface_verdicts, "points"),
    "meshes": partial(surface_verdicts, "triangles"),
}


def line_of(name: str, result: PlanResult) -> str:
    """Return a plan as a line: its status, cost and waypoints, and a digest of the path's bytes."""
    path = b"" if result.path is None else np.ascontiguousarray(result.path).tobytes()
    cost = "-" if result.cost is None else float(result.cost).hex()
    count = 0 if result.path is None else len(result.path)
    return f"{name}: {result.status} {cost} {count} {hashlib.sha256(path).hexdigest()[:16]}"


def map_queries(level: int, count: int) -> tuple[World, npt.NDArray[np.float64]]:
    world = load_maze(level).world()
    q = world.space.from_cube(np.random.default_rng(level).random((8 * count, 2)))
    return world, q[world.valid(q)][: 2 * count].reshape(count, 2, 2)


def map_plans() -> Lines:
    lines = []
    budget = Budget(seconds=None)
    for level in (1, 2, 3):
        world, queries = map_queries(level, 40)
        for i, (start, goal) in enumerate(queries):
            lines.append(line_of(f"cells {level} {i}", plan(world, start, goal, limits=budget)))
        for i, (start, goal) in enumerate(queries[:12]):
            for sampler in ("even", "sobol", "uniform"):
                points = draw(sampler, 256, 2, rng=i)
                for search in ("full", "lazy"):
                    result = plan(world, start, goal, PRM(points, search=search, rule=KNearest(8)), limits=budget)
                    lines.append(line_of(f"prm {level} {i} {sampler} {search}", result))
        for i, (start, goal) in enumerate(queries[:6]):
            lines.append(line_of(f"fmt {level} {i}", plan(world, start, goal, FMT(512), limits=budget)))
            anytime = plan(world, start, goal, GrowingPRM(), limits=Budget(seconds=None, samples=4096))
            lines.append(line_of(f"anytime {level} {i}", anytime))
    world, queries = map_queries(3, 30)
    known = build_roadmap(world, draw("even", 512, 2)).within(world)
    lines += [line_of(f"kept {i}", known.plan(*pair, budget=budget)) for i, pair in enumerate(queries)]
    return lines


def arm_plans() -> Lines:
    lines = []
    trees, roadmap = Budget(seconds=None, motions=20_000), Budget(seconds=None)
    for problem in arm_problems():
        world, ends = ArmWorld(problem.robot, problem.scene), (problem.start, problem.goal)
        name = f"{problem.robot.name} {problem.scene.name}"
        lines.append(line_of(f"trees {name}", plan(world, *ends, limits=trees)))
        lines.append(line_of(f"trees back {name}", plan(world, *ends[::-1], limits=trees)))
        points = draw("even", 256, world.space.dim)
        lines.append(line_of(f"prm {name}", plan(world, *ends, PRM(points), limits=roadmap)))
    for goal in ("inside", "0.2,-1.0,1.2,-1.5,-1.5,0.0"):
        for scene in ("box-reach", "box-reach-narrow"):
            result = plan(scene, "home", goal, robot="ur5", limits=trees)
            lines.append(line_of(f"plan_arm {scene} {goal}", result))
    for kind in ("points", "triangles"):
        for world, problem in zip(
            surface_worlds(kind), (each for each in arm_problems() if each.kind == KINDS[0]), strict=True
        ):
            result = plan(world, problem.start, problem.goal, limits=trees)
            lines.append(line_of(f"trees {problem.robot.name} {problem.scene.name} {kind}", result))
    return lines


PLANS: dict[str, Callable[[], Lines]] = {
    "map-plans": map_plans,
    "arm-plans": arm_plans,
}


def rows_of(tasks: tuple[Task, ...], count: int) -> Lines:
    """Return the outcomes of so many tasks of a suite, evenly spread over it, without their times."""
    lines = []
    for task in (tasks[i * len(tasks) // count] for i in range(count)):
        outcome = run_task(task)
        figures = (
            outcome.status,
            outcome.valid,
            outcome.valid_at_solution,
            outcome.edges_checked,
            outcome.length,
        )
        lines.append(f"{task}: {figures} {outcome.set_id}")
    return lines


ROWS: dict[str, Callable[[], Lines]] = {
    "rows-paper": lambda: rows_of(_cheap(paper_suite(runs=40).tasks), 1200),
    "rows-fair": lambda: rows_of(_cheap(fair_suite(runs=60).tasks), 800),
}


def _cheap(tasks: tuple[Task, ...]) -> tuple[Task, ...]:
    """Return the tasks of at most 256 points: sets of more come in another package."""
    return tuple(task for task in tasks if task.n <= 256)


def compare(name: str, kept: Any, today: Any) -> int:
    """Print how many answers of a part differ, and the first of them; return their number."""
    kept, today = np.asarray(kept), np.asarray(today)
    if kept.shape != today.shape:
        print(f"{name}: {len(today)} answers, {len(kept)} were kept", flush=True)
        return max(len(today), len(kept))
    differ = np.flatnonzero(kept != today)
    print(f"{name}: {len(today)} answers, {len(differ)} differ", flush=True)
    for i in differ[:3]:
        print(f"  {i}: kept {kept[i]}\n  {' ' * len(str(i))}  now  {today[i]}")
    return len(differ)


def processor() -> str:
    """Return the kind of processor, as far as the system says."""
    cpuinfo = Path("/proc/cpuinfo")
    names = [line for line in cpuinfo.read_text().splitlines() if "model name" in line] if cpuinfo.exists() else []
    return names[0].partition(":")[2].strip() if names else platform.processor()


def main() -> int:
    parser = parser_of(__doc__)
    parser.add_argument("--only", default="", help="parts whose names have this in them")
    parser.add_argument("--write", action="store_true", help="keep today's answers")
    options = parser.parse_args()
    kept = dict(np.load(KEPT)) if KEPT.exists() else {}
    if kept and not options.write:
        print(f"kept on {kept['processor']}; this is {processor()}")
    differ = 0
    for name, make in (VERDICTS | PLANS | ROWS).items():
        if options.only not in name:
            continue
        began = time.perf_counter()
        answers = make()
        print(f"{name}: {time.perf_counter() - began:.0f} s", flush=True)
        if options.write:
            packed = name in VERDICTS
            kept[name] = np.packbits(answers) if packed else np.array(answers)
            kept[f"{name} count"] = np.array(len(answers))
        elif name not in kept:
            print(f"{name}: nothing was kept")
        else:
            was = kept[name]
            if name in VERDICTS:
                was = np.unpackbits(was, count=int(kept[f"{name} count"])).astype(np.bool_)
            differ += compare(name, was, answers)
    if options.write:
        np.savez_compressed(KEPT, **kept | {"processor": np.array(processor())})
    elif not options.only:
        print("all answers are the kept ones" if not differ else f"{differ} answers differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
