"""The compiled planner of arms on shelves, boxes, cages and tables: scene, path and shortening, and what they cost.

    python -m studies.benchmarks.arm_planner      # UR5 and the arm of 7 joints, 100 problems a kind

Times are milliseconds of CPU time of one thread, each the best of a few runs of a query, which are all the same;
printed as median / mean / 95 %.  "query" is everything, from a robot and a Scene to the shortened path; "again" is a
second query in the same world: path and shortening.  Beside them stands the time, Python included, as a multiple of
what a query's batches of sixteen checks take by themselves, in one compiled loop.  Problems that are not solved are
left out of the figures and named.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from itertools import chain
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit
from studies.benchmarks.arm_problems import KINDS, REPORTING, TUNING, Pool, Problem, arm_named, problems
from studies.benchmarks.rows import parser_of

from evenroad.planning.arm_trees import connect, shorten
from evenroad.roadmap.connector import Connection
from evenroad.roadmap.shortcut import shortcut
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel import lane_world, layout
from evenroad.robot.kernel.addresses import address, call_at
from evenroad.space.path import path_length

Path = npt.NDArray[np.float64]

REPEATS = 5
MOST_MOTIONS = 200_000
FIRST_PLAN = """
import time
begin = time.perf_counter()
from studies.benchmarks.arm_planner import first_problem
from evenroad.planning.arm_trees import connect, prepare, shorten
prepare()
world, start, goals = first_problem()
world.valid(goals), world.motion_valid(goals, goals)
before = time.perf_counter()
path = connect(world, start, goals).path
between = time.perf_counter()
shorten(world, path)
print(before - begin, between - before, time.perf_counter() - between)
"""


_CHECK = ctypes.CFUNCTYPE(ctypes.c_int64, *[ctypes.c_void_p] * 4, ctypes.c_int64)


class Log:
    """The batches of sixteen that a query tests, to be tested again by themselves."""

    def __init__(self, world: ArmWorld) -> None:
        self.lanes, self.dim = world.tables.lanes, world.space.dim
        self.header = int(self.lanes[layout.INTEGERS])
        self.states: list[bytes] = []
        self.tables: list[bytes] = []
        self.table: list[int] = []
        self.enough: list[int] = []
        self.addresses = lane_world.check_addresses(int(self.lanes[layout.HULL_PAIRS]) > 0)
        self._check = _CHECK(int(self.addresses[1]))
        self._callback = _CHECK(self._noted)

    def _noted(self, scratch: int, states: int, ints: int, table: int, enough: int) -> int:
        if enough == 0:
            return int(self._check(scratch, states, ints, table, enough))
        self.states.append(ctypes.string_at(states, 8 * layout.LANES * self.dim))
        radii = ctypes.string_at(table, 8 * (len(self.lanes) - self.header))
        if not self.tables or self.tables[-1] != radii:
            self.tables.append(radii)
        self.table.append(len(self.tables) - 1)
        self.enough.append(enough)
        return int(self._check(scratch, states, ints, table, enough))

    def filled_by(self, task: Callable[[], Any]) -> None:
        """Run a task whose batches are noted."""
        own = int(self.addresses[1])
        self.addresses[1] = ctypes.cast(self._callback, ctypes.c_void_p).value or 0
        try:
            task()
        finally:
            self.addresses[1] = own

    def time_again(self) -> float:
        """Return how long the batches take by themselves, bodies as large as they were [ms]."""
        states = np.frombuffer(b"".join(self.states)).reshape(len(self.states), -1)
        tables = np.frombuffer(b"".join(self.tables), dtype=np.float32).reshape(len(self.tables), -1)
        memory = np.empty(layout.LANES * self.dim + int(self.lanes[layout.SCRATCH]) // 2 + 16)
        # As programs have it: lanes begin on a cache line.
        skip = -address(memory) % 64 // 8
        room, scratch = np.split(memory[skip:], [layout.LANES * self.dim])
        ints, floats = self.lanes[: self.header], self.lanes[self.header :].view(np.float32)
        arguments = (states, tables, np.array(self.table), np.array(self.enough), ints, floats)
        return best_time(partial(_again, *arguments, room, scratch, self.addresses))[1]


@njit(nogil=True)
def _again(
    states: Any,
    tables: Any,
    table: Any,
    enough: Any,
    ints: Any,
    floats: Any,
    room: Any,
    scratch: Any,
    addresses: Any,
) -> int:
    radii, current, blocked = floats.copy(), -1, 0
    address = addresses[1]
    call_at(address, (scratch, addresses[2], ints, radii, 0))
    for i in range(len(states)):
        if table[i] != current:
            current = table[i]
            radii[:] = tables[current]
        room[:] = states[i]
        blocked += call_at(address, (scratch, room, ints, radii, enough[i]))
    return blocked


def best_time(task: Callable[[], Any]) -> tuple[Any, float]:
    """Return what a task gives, and the shortest of its times [ms]."""
    best = np.inf
    for _ in range(REPEATS):
        begin = time.thread_time()
        result = task()
        best = min(best, time.thread_time() - begin)
    return result, 1e3 * best


def answer(world: ArmWorld, problem: Problem) -> tuple[Connection, Path]:
    """Return the path of the trees, and the shortened one."""
    connection = connect(
        world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60
    )
    path = connection.path
    return connection, shorten(world, path)[0] if connection.goal >= 0 else path


def measure(problem: Problem) -> dict[str, float] | None:
    """Return the figures of one problem, or None where it is not solved."""
    world, scene_time = best_time(partial(ArmWorld, problem.robot, problem.scene))
    connection = connect(
        world, problem.start, problem.goal[np.newaxis], most_motions=MOST_MOTIONS, seconds=60
    )
    if connection.goal < 0:
        return None
    goals = problem.goal[np.newaxis]
    _, path_time = best_time(
        partial(connect, world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60)
    )
    (short, _), short_time = best_time(partial(shorten, world, connection.path))
    _, again = best_time(partial(answer, world, problem))
    _, query = best_time(lambda: answer(ArmWorld(problem.robot, problem.scene), problem))
    log = Log(world)
    log.filled_by(partial(answer, world, problem))
    theirs, _ = shortcut(world, connection.path)
    return {
        "scene": scene_time,
        "path": path_time,
        "shorten": short_time,
        "again": again,
        "query": query,
        "checks": log.time_again(),
        "motions": connection.motions,
        "raw": path_length(connection.path, world.space),
        "short": path_length(short, world.space),
        "all pairs": path_length(theirs, world.space),
    }


def report(title: str, rows: list[dict[str, float]]) -> None:
    """Print a line of figures."""

    def spread(name: str) -> str:
        values = [row[name] for row in rows]
        return f"{np.median(values):.2f}/{np.mean(values):.2f}/{np.quantile(values, 0.95):.2f}"

    total = {name: sum(row[name] for row in rows) for name in rows[0]}
    print(
        f"{title}: {len(rows)} solved; scene {spread('scene')}, path {spread('path')}, shorten {spread('shorten')},"
        f" query {spread('query')}, again {spread('again')} ms; motions {spread('motions')};"
        f" query / checks {total['query'] / total['checks']:.2f}, again {total['again'] / total['checks']:.2f};"
        f" length {total['raw'] / len(rows):.2f} -> {total['short'] / len(rows):.2f}"
        f" (all pairs {total['all pairs'] / len(rows):.2f}: {total['short'] / total['all pairs'] - 1:+.1%})",
        flush=True,
    )


def first_problem() -> tuple[ArmWorld, Path, Path]:
    """Return a world, a start and goals that need more than a straight motion."""
    from studies.benchmarks.arm_speed import ur5_world

    world = ur5_world("box-reach")
    goals = np.array([[-0.1216, -0.6993, 1.2160, -2.1070, 2.3023]])
    return world, np.array([0.0, -0.5 * np.pi, 0.0, -0.5 * np.pi, 0.0]), goals


def measure_compilation() -> None:
    """Print how long it takes to load the world, and until the first path and the first shortened one."""
    with tempfile.TemporaryDirectory() as folder:
        for state in ("empty", "full"):
            run = subprocess.run(
                [sys.executable, "-c", FIRST_PLAN],
                env={**os.environ, "NUMBA_CACHE_DIR": folder},
                capture_output=True,
                text=True,
                check=True,
            )
            load, path, short = map(float, run.stdout.split())
            print(
                f"{state} cache: world with its first checks {load:.2f} s, then first path {path:.2f} s,"
                f" first shortening {short:.2f} s"
            )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100, help="problems of each kind, at most 100")
    parser.add_argument("--arms", nargs="*", default=["ur5", "arm7"])
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    parser.add_argument("--compilation", action="store_true", help="how long first use takes")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    if options.compilation:
        measure_compilation()
    for name in options.arms:
        pool = Pool(arm_named(name))
        rows: dict[str, list[dict[str, float]]] = defaultdict(list)
        unsolved: list[Problem] = []
        for problem in problems(pool, (TUNING if options.tuning else REPORTING)[: options.count]):
            row = measure(problem)
            if row is None:
                unsolved.append(problem)
            else:
                rows[problem.kind].append(row)
        for kind in KINDS:
            if rows[kind]:
                report(f"{name}, {kind}", rows[kind])
        report(f"{name}, all", list(chain(*rows.values())))
        print(f"{name}: not solved within {MOST_MOTIONS} motions: {[(p.kind, p.seed) for p in unsolved]}")
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
