"""Plans to poses: to all postures or to the nearest one, upright, and straight to the goal.

    python -m studies.benchmarks.pose_plans --count 200

Random problems, by seed: an arm among 8 boxes within reach, none at its base; start and goal are poses that point
down, at random places over the ground that can be left upwards by 10 cm, the start the nearest free configuration to
zero, the goal turned as it may about the vertical.  Rows: ``all`` plans to all postures found, ``nearest`` to the one
nearest to the start alone, ``upright`` keeps the tip's z axis within --tilt of the vertical, ``straight`` comes down
the last 10 cm in a line.  "worst" is the largest tilt, or distance from the line, and for the others how many paths
tilt by more than --tilt.  Deviations are measured here, by `link_poses`, at 50 states of every motion.  Times are
processor time of one core, of the whole call; but for ``nearest`` poses are included.  Shares have Wilson's 95 %
interval.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of, write_rows

from evenroad import CartesianLine, PoseGoal
from evenroad.constraints import KeepUpright
from evenroad.geometry import Pose
from evenroad.planning import plan
from evenroad.poses.inverse_kinematics import reach
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene, link_poses, load_robot
from evenroad_studies.statistics.rates import wilson

TIPS = {"ur5": "tool0", "arm7": "flange"}
COLUMNS = ("robot", "row", "problems", "solved", "low_percent", "high_percent", "median_ms", "p95_ms", "length",
           "worst", "unit")  # fmt: skip
LINE = 0.1


def problems(robot: Robot, tip: str, count: int, seed: int) -> Iterator[tuple[Scene, np.ndarray, PoseGoal]]:
    """Yield scenes, starts and goals."""
    for number in range(count):
        rng = np.random.default_rng([seed, number])
        while True:
            boxes: list[Obstacle] = []
            while len(boxes) < 8:
                xyz, size = rng.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 0.8]), rng.uniform(0.08, 0.3, 3)
                if math.hypot(xyz[0], xyz[1]) > 0.35 + 0.5 * math.hypot(size[0], size[1]):
                    boxes.append(Obstacle.of(f"box {len(boxes)}", "box", tuple(size), tuple(xyz)))
            scene = Scene(tuple(boxes), name=f"boxes {number}")
            world, ends = ArmWorld(robot, scene), []
            zero = np.zeros(world.space.dim)
            for _ in range(40):
                place = (*rng.uniform([-0.6, -0.6], [0.6, 0.6]), rng.uniform(0.15, 0.7))
                goal = PoseGoal(Pose.from_rpy(place, (math.pi, 0.0, 0.0)), tip=tip, free_axis="z")
                found = reach(world, goal, zero).configurations
                above = replace(goal, pose=Pose((0.0, 0.0, LINE)) @ goal.pose)
                if len(found) and len(reach(world, above, zero).configurations):
                    ends.append((found[0], goal))
                if len(ends) == 2:
                    yield scene, ends[0][0], ends[1][1]
                    break
            if len(ends) == 2:
                break


def tips_along(robot: Robot, tip: str, path: np.ndarray) -> np.ndarray:
    """Return the tip's poses at 50 states of every motion."""
    dense = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(path)])
    return link_poses(robot, dense)[:, robot.links.index(tip)]


def tilt(tips: np.ndarray) -> float:
    """Return the largest angle of the z axis from straight down [rad]."""
    return float(np.arctan2(np.hypot(tips[:, 0, 2], tips[:, 1, 2]), -tips[:, 2, 2]).max())


def off_line(tips: np.ndarray) -> float:
    """Return how far the tip is from the vertical line through its end, over the last 10 cm [mm]."""
    gap = tips[:, :3, 3] - tips[-1, :3, 3]
    last = int(np.flatnonzero(np.linalg.norm(gap, axis=1) > LINE - 1e-3)[-1]) + 1
    return 1e3 * float(np.hypot(gap[last:, 0], gap[last:, 1]).max())


def rows(name: str, count: int, seed: int, largest: float, seconds: float) -> Iterator[dict[str, object]]:
    """Yield the rows of one robot."""
    robot, tip = load_robot(name), TIPS[name]
    ways = {
        "upright": dict(constraints=KeepUpright(largest)),
        "straight": dict(constraints=CartesianLine(LINE, away="up")),
    }
    taken: dict[str, list[tuple[bool, float, float, float]]] = {row: [] for row in ("all", "nearest", *ways)}
    for scene, start, goal in problems(robot, tip, count, seed):
        for row, got in taken.items():
            world = ArmWorld(robot, scene)
            asked = goal if row != "nearest" else reach(world, goal, start).configurations[0]
            if not got:
                plan(scene, start, asked, robot=robot, seconds=seconds, **ways.get(row, {}))
            began = time.process_time()
            result = plan(scene, start, asked, robot=robot, seconds=seconds, **ways.get(row, {}))
            ms = 1e3 * (time.process_time() - began)
            worst = 0.0
            if result.solved:
                tips = tips_along(robot, tip, result.path)
                worst = off_line(tips) if row == "straight" else tilt(tips)
            got.append((result.solved, ms, result.cost or 0.0, worst))
    for row, got in taken.items():
        solved = [each for each in got if each[0]]
        low, high = (float(np.ravel(end)[0]) for end in wilson(len(solved), count))
        times, tilted = [each[1] for each in got], sum(each[3] > largest for each in solved)
        yield dict(
            robot=name,
            row=row,
            problems=count,
            solved=len(solved),
            low_percent=round(100 * low, 1),
            high_percent=round(100 * high, 1),
            median_ms=round(float(np.median(times)), 2),
            p95_ms=round(float(np.percentile(times, 95)), 2),
            length=round(float(np.mean([each[2] for each in solved])), 3),
            worst=f"{max(each[3] for each in solved):.3g}" if row in ways else tilted,
            unit={"straight": "mm", "upright": "rad"}.get(row, "paths"),
        )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--tilt", type=float, default=0.1, help="radians")
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    every = []
    for name in TIPS:
        for row in rows(name, options.count, options.seed, options.tilt, options.seconds):
            every.append(row)
            print(", ".join(f"{column} {row[column]}" for column in COLUMNS), flush=True)
    write_rows(options.out, COLUMNS, every)


if __name__ == "__main__":
    main()
