"""Plans of arms in shelves, boxes, cages and on tables, with the makers' shapes and with capsules.

    python -m studies.benchmarks.true_shapes OUT.csv ROBOT.urdf ... [--each 25]

Ends are near obstacles and free by `CLEAR` in coal, on the triangles of the files.  For each robot and family: how
many problems either solves, how many ends it refuses, how many states of its paths touch an obstacle in coal by more
than `DEEP`, and how long a plan with shapes takes in parts of the same with capsules, where both solve it.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from studies.benchmarks.obstacle_truth import CLEAR, DEEP, touching
from studies.benchmarks.robot_truth import Truth
from studies.benchmarks.rows import parser_of, write_rows

import evenroad as er
from evenroad.robot import ArmWorld, Robot, Scene, load_robot
from evenroad.robot.scene import Obstacle
from evenroad.space.path import resample

NEAR = 0.04
"""Ends are those that are blocked for capsules with this clearance [m]."""
COLUMNS = (
    *("robot", "family", "problems", "solved", "solved_capsules", "refused", "refused_capsules"),
    *("states", "states_that_touch", "ms", "ms_capsules", "ratio_median", "ratio_95"),
)


def box(name: str, size: tuple[float, ...], *xyz: float) -> Obstacle:
    """Return a box along the axes."""
    return Obstacle.of(name, "box", size, xyz)


def shelves(rng: np.random.Generator) -> list[Obstacle]:
    """Return three boards with a back and sides, and cans on them."""
    x, gap = rng.uniform(0.5, 0.65), rng.uniform(0.28, 0.4)
    boards = [box(f"board{i}", (0.3, 0.8, 0.02), x, 0.0, 0.05 + gap * i) for i in range(3)]
    sides = [box(f"side{i}", (0.3, 0.02, 0.8), x, side, 0.4) for i, side in enumerate((-0.4, 0.4))]
    cans = [
        Obstacle.of(f"can{i}", "cylinder", (0.035, 0.12), (x, rng.uniform(-0.35, 0.35), 0.12 + gap * (i % 2)))
        for i in range(4)
    ]
    return [*boards, *sides, box("back", (0.02, 0.8, 0.8), x + 0.16, 0.0, 0.4), *cans]


def box_with_lid(rng: np.random.Generator) -> list[Obstacle]:
    """Return a box that a lid covers by half."""
    x, y, side, high = rng.uniform(0.4, 0.5), rng.uniform(-0.3, 0.3), rng.uniform(0.35, 0.45), rng.uniform(0.2, 0.35)
    walls = [
        box(f"wall{i}", size, x + dx * side / 2, y + dy * side / 2, high / 2)
        for i, (dx, dy) in enumerate(((1, 0), (-1, 0), (0, 1), (0, -1)))
        for size in [(0.02, side, high) if dx else (side, 0.02, high)]
    ]
    return [
        *walls,
        box("bottom", (side, side, 0.02), x, y, 0.0),
        box("lid", (side, side / 2, 0.02), x, y + side / 4, high),
    ]


def cage(rng: np.random.Generator) -> list[Obstacle]:
    """Return upright bars around the robot, and a ring of beams."""
    radius, count = rng.uniform(0.5, 0.6), 9
    turn = np.arange(count) * 2.0 * np.pi / count + rng.uniform(0.0, 1.0)
    bars = [
        Obstacle.of(f"bar{i}", "cylinder", (0.02, 1.0), (radius * np.cos(a), radius * np.sin(a), 0.5))
        for i, a in enumerate(turn)
    ]
    beams = [box(f"beam{i}", size, *place, 0.45) for i, (size, place) in enumerate((
        ((1.2, 0.04, 0.04), (0.0, radius)), ((1.2, 0.04, 0.04), (0.0, -radius)), ((0.04, 1.2, 0.04), (radius, 0.0)),
    ))]  # fmt: skip
    return [*bars, *beams]


def table(rng: np.random.Generator) -> list[Obstacle]:
    """Return a table top at the robot's shoulder with its legs, and things on it."""
    x, z = rng.uniform(0.45, 0.6), rng.uniform(0.2, 0.35)
    legs = [
        box(f"leg{i}", (0.04, 0.04, z), x + dx, dy, z / 2) for i, (dx, dy) in enumerate(((-0.2, 0.4), (-0.2, -0.4)))
    ]
    things = [
        Obstacle.of(f"thing{i}", *(("box", (0.08, 0.06, 0.2)) if i % 2 else ("sphere", (0.06,))),
                    (x + rng.uniform(-0.2, 0.2), rng.uniform(-0.4, 0.4), z + 0.1))
        for i in range(5)
    ]  # fmt: skip
    return [box("top", (0.5, 1.0, 0.03), x, 0.0, z), *legs, *things]


FAMILIES = {each.__name__: each for each in (shelves, box_with_lid, cage, table)}


def problems(robot: Robot, truth: Truth, family: str, each: int) -> list[tuple[Scene, np.ndarray, np.ndarray]]:
    """Return scenes of a family, each with a start and a goal that coal calls free."""
    found, rng = [], np.random.default_rng(sorted(FAMILIES).index(family))
    while len(found) < each:
        scene = Scene(tuple(FAMILIES[family](rng)), name=family)
        lean = ArmWorld(robot, Scene((), name="empty"))
        near = ArmWorld(replace(robot, shapes=()), scene, clearance=NEAR)
        q = lean.space.from_cube(rng.random((3000, lean.space.cube_dim)))
        q = q[lean.valid(q) & ~near.valid(q)][:60]
        q = q[~touching(truth, scene, q, CLEAR)]
        found += [(scene, q[i], q[i + 1]) for i in range(0, min(len(q) - 1, 8), 2)]
    return found[:each]


def planned(robot: Robot, scene: Scene, start: np.ndarray, goal: np.ndarray) -> tuple[er.PlanResult, float]:
    """Return a plan, and the least of its processor's seconds of three tries after the first."""
    world, least = ArmWorld(robot, scene), np.inf
    result = er.plan(world, start, goal)
    for _ in range(3 if result.solved else 0):
        began = time.process_time()
        er.plan(world, start, goal)
        least = min(least, time.process_time() - began)
    return result, least


def measured(file: Path, each: int) -> list[dict[str, object]]:
    """Return the rows of one robot."""
    robot = load_robot(file)
    arm = [name for name in robot.group if not any(word in name for word in ("finger", "robotiq", "gripper", "drive"))]
    robot = load_robot(file, group=arm)
    held = {
        joint.name: robot.held.get(joint.name, joint.neutral)
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.name not in robot.group
    }
    truth, rows = Truth(file, robot.group, held), []
    for family in FAMILIES:
        count = dict.fromkeys(COLUMNS[2:9], 0)
        seconds = []
        for scene, start, goal in problems(robot, truth, family, each):
            count["problems"] += 1
            took = []
            for of, end in ((robot, ""), (replace(robot, shapes=()), "_capsules")):
                result, spent = planned(of, scene, start, goal)
                count["solved" + end] += result.solved
                count["refused" + end] += str(result.status).endswith("invalid")
                took.append(spent if result.solved else np.nan)
                if result.solved and not end:
                    states = resample(
                        result.path, result.space if hasattr(result, "space") else ArmWorld(of).space, 0.05
                    )[0]
                    count["states"] += len(states)
                    count["states_that_touch"] += int(touching(truth, scene, states, -DEEP).sum())
            seconds.append(took)
        both = np.array(seconds)[~np.isnan(seconds).any(axis=1)]
        ratio = both[:, 0] / both[:, 1] if len(both) else np.array([np.nan])
        times = dict(zip(("ms", "ms_capsules"), (1e3 * np.median(both, axis=0)).round(2), strict=True))
        rows.append({
            "robot": file.stem, "family": family, **count, **times,
            "ratio_median": round(float(np.median(ratio)), 3), "ratio_95": round(float(np.quantile(ratio, 0.95)), 3),
        })  # fmt: skip
        print(rows[-1], flush=True)
    return rows


def main() -> None:
    """Write a row for each robot and family."""
    parser = parser_of(__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("robots", type=Path, nargs="+")
    parser.add_argument("--each", type=int, default=25)
    given = parser.parse_args()
    write_rows(given.out, COLUMNS, [row for file in given.robots for row in measured(file, given.each)])


if __name__ == "__main__":
    main()
