"""Robots with two arms, of 14 to 20 joints, and upper bodies of 30: whether `er.plan` joins two postures, and how soon.

    python -m studies.benchmarks.two_arms --count 125     # 500 problems of four robots, and 125 of 30 joints

Each hand goes to a place of a shelf, in a box or low on a table, or both arms go through many boxes, where there is a
path by construction.  Of the others a problem counts as solvable if any planner solves it: `er.plan`, trees driven by
any of three other sequences, or OMPL's RRT-Connect with `--ompl`, of which each query gets so many seconds (extra
[ompl]).  Times are milliseconds of processor time of one thread, from a robot and a scene to the smoothed path of
`er.plan`, to the first path of OMPL, printed as median / mean / 95 % / longest.
"""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_problems import Problem, Region, scene_of, within
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.collision.arm_world import ArmWorld
from evenroad.planning.arm_trees import connect
from evenroad.points.reversed_halton import shifted_cube_points
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle

TUNING, REPORTING = range(1_000, 1_200), range(2_000, 2_200)

JOINTS = {14: (0, 7, 0), 16: (2, 7, 0), 18: (0, 9, 0), 20: (2, 9, 0), 30: (3, 7, 5)}
"""Number of joints -> those of the trunk, of each arm, and of each hand; 30 has a neck of 3."""

KINDS = ("shelf", "box", "table", "passage")

SECONDS = 5.0
"""Wall time of a plan, its default."""
OTHERS, MOST_MOTIONS = 3, 100_000
"""So many other sequences, with so many motions each, look for a path where there was none."""

BOXES = 1000
"""So many boxes are tried, and kept where a path does not touch them."""

POSTURES, TRUNKS = 60_000, 4
"""Postures of the pool, and how many values of the trunk's joints they share."""

Vector = npt.NDArray[np.float64]


def _link(name: str, length: float, radius: float) -> str:
    middle = f'<origin xyz="0 0 {0.5 * length:.4f}"/>'
    return (
        f'<link name="{name}"><collision>{middle}<geometry><cylinder radius="{radius}" length="{length:.4f}"/>'
        "</geometry></collision></link>\n"
    )


def _joint(
    parent: str, child: str, place: tuple[float, float, float], axis: str, limit: float, pitch: float = 0.0
) -> str:
    x, y, z = place
    return (
        f'<joint name="{child}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{x} {y} {z}" rpy="0 {pitch} 0"/><axis xyz="{axis}"/>'
        f'<limit lower="{-limit}" upper="{limit}" velocity="2" effort="1"/></joint>\n'
    )


def _chain(
    first: str, prefix: str, place: tuple[float, float, float], joints: int, reach: float, pitch: float = 0.0
) -> tuple[str, str]:
    """Return the text of a serial arm whose joints turn and bend in turn, and its last link."""
    text, parent, lengths = "", first, reach / (joints // 2)
    for i in range(joints):
        name, bends = f"{prefix}{i}", i % 2 == 1
        length, radius = (0.8 * lengths, 0.045) if bends else (0.2 * lengths, 0.05)
        text += _joint(parent, name, place, "0 1 0" if bends else "0 0 1", 2.0 if bends else 2.8, pitch)
        text += _link(name, length, radius)
        parent, place, pitch = name, (0.0, 0.0, length), 0.0
    return text, parent


def _text(joints: int) -> str:
    trunk, arm, hand = JOINTS[joints]
    text, parent, place = _link("floor", 0.02, 0.15), "floor", (0.0, 0.0, 0.02)
    for i, axis in enumerate(("0 0 1", "0 1 0", "1 0 0")[:trunk]):
        text += _joint(parent, f"trunk{i}", place, axis, 0.5) + _link(f"trunk{i}", 0.05, 0.1)
        parent, place = f"trunk{i}", (0.0, 0.0, 0.05)
    text += f'<joint name="chest" type="fixed"><parent link="{parent}"/><child link="chest"/>'
    text += f'<origin xyz="0 0 {place[2]}"/></joint>\n' + _link("chest", 0.45, 0.1)
    for side, y in (("left", 0.2), ("right", -0.2)):
        of_arm, last = _chain("chest", side, (0.0, y, 0.4), arm, 1.0, 0.5 * np.pi)
        text += of_arm
        for finger in range(hand):
            text += _joint(last, f"{side}finger{finger}", (0.0, 0.02 * (finger - 2), 0.06), "0 1 0", 0.8)
            text += _link(f"{side}finger{finger}", 0.05, 0.008)
    if hand:
        text += _chain("chest", "neck", (0.0, 0.0, 0.47), 3, 0.2)[0]
    return f'<robot name="two arms of {joints}">\n{text}</robot>\n'


@lru_cache
def robot_of(joints: int) -> Robot:
    """Return the robot with so many joints."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "robot.urdf"
        file.write_text(_text(joints))
        return er.load_robot(file)


@dataclass(frozen=True, eq=False)
class Pool:
    """Postures of a robot, (n, dim), and the places of its two hands, (n, 3) each."""

    robot: Robot
    q: Vector
    hands: tuple[Vector, Vector]
    right: npt.NDArray[np.bool_]

    @staticmethod
    def of(robot: Robot) -> Pool:
        """Return the pool of a robot: always the same."""
        space = ArmWorld(robot, er.Scene((), name="nothing")).space
        q = space.from_cube(np.random.default_rng(0).random((POSTURES, space.dim)))
        trunk = [i for i, name in enumerate(robot.group) if name.startswith("trunk")]
        q[:, trunk] = q[np.arange(POSTURES) % TRUNKS][:, trunk]
        arms = {i: name for i, name in enumerate(robot.links) if "finger" not in name}
        hands = [max(i for i, name in arms.items() if name.startswith(side)) for side in ("left", "right")]
        places = np.concatenate([link_poses(robot, each)[:, :, :3, 3][:, hands] for each in np.array_split(q, 20)])
        right = np.array([name.startswith("right") for name in robot.group])
        return Pool(robot, q, (places[:, 0], places[:, 1]), right)

    def posture(self, world: ArmWorld, regions: tuple[Region, Region], rng: np.random.Generator) -> Vector | None:
        """Return free postures with each hand in its region, (n, dim)."""
        found = [np.flatnonzero(within(place, region)) for place, region in zip(self.hands, regions, strict=True)]
        for trunk in rng.permutation(TRUNKS):
            left, right = ([i for i in rows if i % TRUNKS == trunk] for rows in found)
            if not left or not right:
                continue
            q = self.q[rng.choice(left, 64)]
            q[:, self.right] = self.q[rng.choice(right, 64)][:, self.right]
            free = q[world.valid(q)]
            if len(free):
                return free
        return None


def problems(pool: Pool, seeds: range) -> Iterator[Problem]:
    """Yield a problem for each seed, of the kinds in turn."""
    for seed in seeds:
        kind = KINDS[seed % len(KINDS)]
        rng = np.random.default_rng([seed, pool.q.shape[1]])
        found = None
        while found is None:
            found = (_passage if kind == "passage" else _furniture)(pool, kind, rng)
        yield Problem(kind, seed, pool.robot, *found)


def _furniture(pool: Pool, kind: str, rng: np.random.Generator) -> tuple[er.Scene, Vector, Vector] | None:
    """Return a scene with a posture at each end of which each hand is in a place."""
    obstacles, regions = scene_of(kind, rng)
    scene = er.Scene(tuple(obstacles), name=kind)
    world = ArmWorld(pool.robot, scene)
    ends = [pool.posture(world, (regions[i], regions[j]), rng) for i, j in rng.choice(len(regions), (2, 2))]
    if ends[0] is None or ends[1] is None:
        return None
    start, goal = (each[rng.integers(len(each))] for each in ends)
    return None if (start == goal).all() else (scene, start, goal)


def _passage(pool: Pool, kind: str, rng: np.random.Generator) -> tuple[er.Scene, Vector, Vector] | None:
    """Return a scene of many boxes that a motion of both arms does not touch: there is a path."""
    world = ArmWorld(pool.robot, er.Scene((), name="nothing"))
    some = pool.q[rng.integers(len(pool.q), size=64)]
    start, goal = some[world.valid(some)][:2]
    sequence = shifted_cube_points(world.space.dim, int(rng.integers(1, 1000)))
    path = connect(world, start, goal[np.newaxis], most_motions=2000, sequence=sequence).path
    if not len(path):
        return None
    states = np.concatenate([a + np.linspace(0, 1, 100)[:, np.newaxis] * (b - a) for a, b in pairwise(path)])
    kept: list[Obstacle] = []
    for i in range(BOXES):
        place, size = rng.uniform((-0.9, -1.1, -0.3), (1.1, 1.1, 1.4)), rng.uniform(0.03, 0.25, 3)
        box = Obstacle.of(f"box {i}", "box", tuple(size), tuple(place))
        if ArmWorld(pool.robot, er.Scene((box,), name="one")).valid(states).all():
            kept.append(box)
    return er.Scene(tuple(kept), name=kind), start, goal


def has_path(world: ArmWorld, problem: Problem) -> bool:
    """Return whether there is a path by construction, or trees driven by another sequence find one."""
    if problem.kind == "passage":
        return True
    for shift in range(1, 1 + OTHERS):
        other = shifted_cube_points(world.space.dim, shift)
        goals = problem.goal[np.newaxis]
        found = connect(world, problem.start, goals, most_motions=MOST_MOTIONS, seconds=60, sequence=other)
        if found.goal >= 0:
            return True
    return False


def by_ompl(world: ArmWorld, problem: Problem, seconds: float) -> float | None:
    """Return the processor time [ms] in which OMPL's RRT-Connect finds a path, or None."""
    from ompl import geometric as og
    from ompl import util as ou

    from evenroad.adapters.ompl import solve, space_information

    ou.setLogLevel(ou.LogLevel.LOG_NONE)
    begin = time.thread_time()
    path = solve(og.RRTConnect(space_information(world)), problem.start, problem.goal, seconds=seconds)
    return None if path is None else 1e3 * (time.thread_time() - begin)


def spread_of(times: list[float]) -> str:
    if not times:
        return "none"
    return f"{np.median(times):.2f} / {np.mean(times):.2f} / {np.quantile(times, 0.95):.2f} / {max(times):.1f} ms"


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100, help="problems of each robot")
    parser.add_argument("--joints", nargs="*", type=int, default=list(JOINTS))
    parser.add_argument("--ompl", type=float, default=0.0, help="seconds of OMPL's RRT-Connect, 0 for none [s]")
    parser.add_argument("--tuning", action="store_true", help="the problems that constants are chosen on")
    options = parser.parse_args()
    print(f"load average of the last minute: {os.getloadavg()[0]:.1f}")
    for joints in options.joints:
        pool = Pool.of(robot_of(joints))
        times: list[float] = []
        theirs: list[float] = []
        failed: list[tuple[str, int, str]] = []
        unsolved: list[tuple[str, int, str]] = []
        for problem in problems(pool, (TUNING if options.tuning else REPORTING)[: options.count]):
            begin = time.thread_time()
            world = ArmWorld(problem.robot, problem.scene)
            result = er.plan(world, problem.start, problem.goal, seconds=SECONDS)
            spent = 1e3 * (time.thread_time() - begin)
            ompl = by_ompl(world, problem, options.ompl) if options.ompl else None
            theirs += [] if ompl is None else [ompl]
            if result.solved:
                times.append(spent)
            else:
                is_solvable = ompl is not None or has_path(world, problem)
                (failed if is_solvable else unsolved).append((problem.kind, problem.seed, result.message))
        solvable = len(times) + len(failed)
        print(f"{joints} joints: {len(times)} of {solvable} solvable problems; {spread_of(times)}")
        if options.ompl:
            print(f"  OMPL's RRT-Connect: {len(theirs)} of {solvable}; {spread_of(theirs)}")
        print(f"  failed {failed}; solved by none {unsolved}", flush=True)


if __name__ == "__main__":
    main()
