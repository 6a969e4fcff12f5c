"""Whether `seconds` is a promise: queries of every kind with 1 ms to 1 s, and by how much they take longer.

    python -m studies.benchmarks.deadlines --count 10000        # some minutes
    python -m studies.benchmarks.deadlines --kinds tasks maps   # some kinds alone

Queries are easy, hard and impossible ones at random: arms of 6, 7 and 14 joints with each planner, poses as goals,
constraints, tasks, roadmaps, disks and cars on maps, and functions of a user, fast and slow.  The time allowed is
drawn evenly by its logarithm.  Each world exists and has answered a query before.  What a query takes too long is
processor time of this process after its deadline: another process reads this one's clock at that moment, and where it
wakes up late, what it is late counts as well.  So others on this machine make the figures larger, not smaller.
Python's full collections of garbage, 40 ms among the worlds of all kinds, run between queries.  The table has the
overrun at 50 %, 99 %, 99.9 % and at most [ms], and how many queries exceed 5 ms + 5 % of what was allowed, and 20 ms.
"""

from __future__ import annotations

import gc
import os
import select
import struct
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache, partial
from time import perf_counter as now
from typing import Any

import numpy as np
from studies.benchmarks.arm_problems import REPORTING, Pool, Problem, problems
from studies.benchmarks.map_queries import office, rooms
from studies.benchmarks.rows import parser_of
from studies.benchmarks.tasks import problem as task_problem
from studies.benchmarks.two_arms import robot_of as two_arms

import evenroad as er
from evenroad.constraints import KeepUpright
from evenroad.planning.planners.growing import GrowingPRM
from evenroad.planning.planners.trees import GridSearch
from evenroad.robots.kinematics import link_poses
from evenroad_studies.arms.robots import arm_named

LEAST, MOST = 1e-3, 1.0
"""Seconds that a query is allowed."""
SPARE, SHARE, LARGEST = 5e-3, 0.05, 20e-3
"""What a query may take longer: some seconds and a share of the time allowed; and at most."""
COLLECT_EVERY = 20
"""Number of queries between two collections of garbage: too few for Python to begin one by itself."""

Call = Callable[[float], Any]
"""A query that takes the seconds allowed, and returns a result with a status."""


class Watch:
    """Another process that reads the processor clock of this one at the deadline."""

    def __init__(self) -> None:
        (self._asks, ours), (theirs, self._says) = os.pipe(), os.pipe()
        self._ask, self._hear, of = ours, theirs, os.getpid()
        if os.fork() == 0:
            os.close(ours), os.close(theirs)
            self._watch(of)

    def _watch(self, of: int) -> None:
        # Linux: the clock of a process by its number.
        clock = (~of << 3) | 2
        with suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        while request := os.read(self._asks, 8):
            at, seen, late = struct.unpack("d", request)[0], -1.0, 0.0
            if not select.select([self._asks], [], [], max(at - now(), 0.0))[0]:
                seen, late = time.clock_gettime(clock), now() - at
            os.read(self._asks, 8)
            os.write(self._says, struct.pack("dd", seen, late))
        os._exit(0)

    def overrun(self, call: Call, seconds: float) -> tuple[float, Any]:
        """Return how long a query takes after its deadline [s], and its result."""
        began, at = time.process_time(), now() + seconds
        os.write(self._ask, struct.pack("d", at))
        result = call(seconds)
        ended, used = now(), time.process_time()
        os.write(self._ask, struct.pack("d", 0.0))
        seen, late = struct.unpack("dd", os.read(self._hear, 16))
        if seen < 0.0 or ended < at:
            return 0.0, result
        return min(max(used - seen, 0.0) + late, ended - at, used - began), result


def boxes(rng: np.random.Generator, reach: float) -> er.Scene:
    """Return boxes at random around a robot, none at its base."""
    made: list[er.Box] = []
    while len(made) < rng.integers(5, 40):
        xyz = rng.uniform(-reach, reach, 3)
        if np.hypot(*xyz[:2]) > 0.3:
            made.append(er.Box(tuple(rng.uniform(0.03, 0.35, 3)), xyz=tuple(xyz)))
    return er.Scene(made)


@lru_cache
def robot(joints: int) -> er.Robot:
    """Return an arm of so many joints, of 14 two arms."""
    return two_arms(14) if joints == 14 else arm_named({6: "ur5", 7: "arm7"}[joints])


@lru_cache(maxsize=24)
def arm(joints: int, seed: int) -> er.ArmWorld:
    """Return an arm among boxes, which has answered a query."""
    world = er.ArmWorld(robot(joints), boxes(np.random.default_rng(seed), 0.9))
    q = free(world, np.random.default_rng(seed), 2)
    er.plan(world, *q, seconds=0.5)
    return world


def free(world: Any, rng: np.random.Generator, count: int) -> np.ndarray:
    """Return free configurations at random, (count, dim)."""
    q = world.space.from_cube(rng.random((20_000, world.space.cube_dim)))
    q = q[world.valid(q)]
    return q[:count] if len(q) >= count else free(world, rng, count)


def arms(rng: np.random.Generator, **how: Any) -> Call:
    """Return a query of an arm among boxes."""
    world = arm(int(rng.choice([6, 7, 14])), int(rng.integers(8)))
    start, goal = free(world, rng, 2)
    return lambda seconds: er.plan(world, start, goal, seconds=seconds, **how)


def poses(rng: np.random.Generator) -> Call:
    """Return a query to poses: reached by some posture, out of reach, or many."""
    world = arm(int(rng.choice([6, 7])), int(rng.integers(8)))
    start = free(world, rng, 1)[0]
    goals = [
        er.PoseGoal(
            er.Pose(tuple(rng.uniform(-0.8, 0.8, 3)), rpy=tuple(rng.uniform(-3, 3, 3))),
            free_axis="z" if rng.random() < 0.3 else None,
        )
        for _ in range(int(rng.choice([1, 3, 20])))
    ]
    return lambda seconds: er.plan(world, start, goals, seconds=seconds)


def constraints(rng: np.random.Generator) -> Call:
    """Return a query that keeps its tool upright, or leaves and comes along straight lines."""
    world = arm(int(rng.choice([6, 7])), int(rng.integers(8)))
    start, goal = free(world, rng, 2)
    if rng.random() < 0.5:
        line = er.CartesianLine(0.1, 0.1)
        return lambda seconds: er.plan(world, start, goal, seconds=seconds, constraints=line)
    angle = float(rng.uniform(0.3, 1.5))
    kept = KeepUpright(angle, "z")
    q = free(world, rng, 1000)
    up = np.concatenate([link_poses(world.robot, some)[:, -1, 2, 2] for some in np.array_split(q, 10)])
    upright = list(q[np.arccos(np.clip(up, -1.0, 1.0)) < angle])
    start, goal = [*upright, start, goal][:2]
    return lambda seconds: er.plan(world, start, goal, seconds=seconds, constraints=kept)


@lru_cache(maxsize=8)
def _task(seed: int) -> tuple[er.ArmWorld, Any]:
    ur5 = er.load_robot("ur5")
    scene, task = task_problem(ur5, seed)
    return er.ArmWorld(ur5, scene), task


def tasks(rng: np.random.Generator) -> Call:
    """Return a task that takes a can from a shelf and puts it down."""
    world, task = _task(int(rng.integers(8)))
    home = [0.0, -2.0, 1.9, -1.5, -np.pi / 2, 0.0]
    return lambda seconds: task.plan(world, home, seconds=seconds)


@lru_cache(maxsize=4)
def _roadmap(seed: int) -> Any:
    return er.build_roadmap(er.ArmWorld(robot(6)), er.draw("even", 256, 6))


def roadmaps(rng: np.random.Generator) -> Call:
    """Return a query along a roadmap of an arm, in a world that it knows or not."""
    world = arm(6, int(rng.integers(8)))
    start, goal = free(world, rng, 2)
    kept = _roadmap(0).within(world) if rng.random() < 0.5 else _roadmap(0)
    return lambda seconds: er.plan(world, start, goal, kept, seconds=seconds)


@lru_cache(maxsize=12)
def _map(kind: int, seed: int) -> er.GridMap:
    rng = np.random.default_rng(seed)
    cells = (rooms, office)[kind](rng) if kind < 2 else np.kron(rng.random((300, 300)) < 0.35, np.ones((8, 8), bool))
    return er.GridMap(cells.astype(bool))


@lru_cache(maxsize=12)
def _disk(kind: int, seed: int) -> Any:
    return _map(kind, seed).world(float(np.random.default_rng(seed).uniform(1.0, 5.0)))


@lru_cache(maxsize=24)
def _car(kind: int, seed: int, reverse: bool) -> Any:
    half = np.random.default_rng(seed).uniform((2.0, 1.0), (6.0, 3.0))
    corners = half * [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return _map(kind, seed).world(footprint=corners, turning_radius=3.0 * seed, reverse=reverse)


def cars(rng: np.random.Generator) -> Call:
    """Return a query of a car on such a map, which may drive backwards or not."""
    world = _car(int(rng.integers(3)), int(rng.integers(4)), bool(rng.random() < 0.5))
    start, goal = free(world, rng, 2)
    return lambda seconds: er.plan(world, start, goal, seconds=seconds)


def maps(rng: np.random.Generator) -> Call:
    """Return a query of a disk on a map: buildings, and blocks at random, of which many have no path."""
    world = _disk(int(rng.integers(3)), int(rng.integers(4)))
    start, goal = free(world, rng, 2)
    improve = bool(rng.random() < 0.3)
    return lambda seconds: er.plan(world, start, goal, GridSearch(improve) if improve else None, seconds=seconds)


def functions(rng: np.random.Generator) -> Call:
    """Return a query of a user's function: balls at random, many at once or one after the other, some of them slow."""
    dim, slow = int(rng.integers(2, 8)), float(rng.choice([0.0, 0.0, 1e-4, 1e-3]))
    centres, radius = rng.random((20, dim)), float(rng.uniform(0.05, 0.5))

    def is_free(q: np.ndarray) -> np.ndarray:
        q = np.atleast_2d(q)
        end = time.process_time() + slow * len(q)
        apart = (np.linalg.norm(q[:, np.newaxis] - centres, axis=2) > radius).all(axis=1)
        while slow and time.process_time() < end:
            pass
        return apart

    one = bool(rng.random() < 0.5)
    world = er.FunctionWorld([(0, 1)] * dim, (lambda q: bool(is_free(q)[0])) if one else is_free, vectorised=not one)
    start, goal = rng.random((2, dim))
    planner = [None, er.RRTConnect(), er.PRM(128), er.FMT(256)][int(rng.integers(4))]
    return lambda seconds: er.plan(world, start, goal, planner, seconds=seconds)


def many(rng: np.random.Generator) -> Call:
    """Return one query by `plan_many`."""
    world = arm(int(rng.choice([6, 7])), int(rng.integers(8)))
    start, goal = free(world, rng, 2)
    return lambda seconds: er.plan_many(world, [start], [goal], seconds=seconds, threads=1)


@lru_cache
def _cages(joints: int) -> tuple[Problem, ...]:
    return tuple(problems(Pool(robot(joints)), REPORTING[:8], ("cage",)))


def cages(rng: np.random.Generator) -> Call:
    """Return a query out of a cage, where a third has no path."""
    cage = _cages(int(rng.choice([6, 7])))[int(rng.integers(8))]
    world = er.ArmWorld(cage.robot, cage.scene)
    _ = world.checker, world.roomier.checker
    start, goal = (cage.start, cage.goal) if rng.random() < 0.5 else (cage.goal, cage.start)
    return lambda seconds: er.plan(world, start, goal, seconds=seconds)


KINDS: dict[str, Callable[[np.random.Generator], Call]] = {
    "arms": arms,
    "cages": cages,
    "quick": partial(arms, smooth="quick"),
    "certified": partial(arms, certified=True),
    "improve": partial(arms, planner=er.RRTConnect(improve=True)),
    "prm": partial(arms, planner=er.PRM(256)),
    "growing": partial(arms, planner=GrowingPRM()),
    "many": many,
    "poses": poses,
    "constraints": constraints,
    "tasks": tasks,
    "roadmaps": roadmaps,
    "maps": maps,
    "functions": functions,
    "cars": cars,
}


def main() -> None:
    """Ask queries of each kind in turn, and print the table."""
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    watch = Watch()
    print(f"{'kind':12} {'count':>6} {'50 %':>7} {'99 %':>7} {'99.9 %':>7} {'most':>7}  over  over 20 ms  statuses")
    every: list[tuple[float, float]] = []
    for name in given.kinds:
        rows, statuses = [], Counter[str]()
        for number in range(-2, given.count // len(given.kinds)):
            rng = np.random.default_rng([given.seed, list(KINDS).index(name), number + 2])
            call = KINDS[name](rng)
            seconds = float(np.exp(rng.uniform(np.log(LEAST), np.log(MOST))))
            if number < 0:
                # Modules are loaded by then.
                call(2.0)
                continue
            if number % COLLECT_EVERY == 0:
                gc.collect()
            overrun, result = watch.overrun(call, seconds)
            rows.append((overrun, seconds))
            statuses[str(result.status) if hasattr(result, "status") else "many"] += 1
            if overrun > LARGEST:
                print(f"    {name} {number + 2}: {1e3 * overrun:.1f} ms after {seconds:.3g} s", flush=True)
        print(line_of(name, rows), dict(statuses), flush=True)
        every += rows
    print(line_of("all", every))


def line_of(name: str, rows: list[tuple[float, float]]) -> str:
    """Return a line of the table of overruns and times allowed."""
    over, allowed = 1e3 * np.array(rows).T
    shares = " ".join(f"{np.percentile(over, share):7.2f}" for share in (50, 99, 99.9, 100))
    beyond = int((over > 1e3 * SPARE + SHARE * allowed).sum()), int((over > 1e3 * LARGEST).sum())
    return f"{name:12} {len(over):6} {shares}  {beyond[0]:4}  {beyond[1]:10} "


if __name__ == "__main__":
    main()
