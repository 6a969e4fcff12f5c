"""How many poses inverse kinematics solves, how exactly and how fast.

    python -m studies.benchmarks.pose_goals --count 5000
    python -m studies.benchmarks.pose_goals --count 2000 --foreign FILE.urdf[,TIP[,JOINT,...]] ...

Poses are those of random configurations, uniform within the limits, that are free of self-collision.  A pose is solved
if a free configuration was found; errors are those of forward kinematics by `link_poses`, which shares no code with
the solver.  "own" are poses of which the configuration that made them is among the postures found (of six joints).
The share of solved poses has Wilson's 95 % interval; times are wall times of `reach`, which ends with a list of free
goals, whole turns added.  With ``--numeric`` EAIK is left out where it is installed.
"""

from __future__ import annotations

import time
import warnings
from pathlib import Path

import numpy as np
from studies.benchmarks.rows import parser_of, write_rows

from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry import Pose
from evenroad.loading.load import load_robot
from evenroad.poses import inverse_kinematics
from evenroad.poses.chain import TURN, default_tip
from evenroad.poses.inverse_kinematics import reach
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.kinematics import link_poses
from evenroad.scenes.scene import Scene
from evenroad_studies.statistics.rates import wilson

COLUMNS = ("robot", "joints", "solver", "poses", "solved", "low_percent", "high_percent", "own", "error",
           "median_ms", "p95_ms", "postures")  # fmt: skip


def row(source: str, count: int, seed: int) -> dict[str, object]:
    """Return the figures of one robot, ``FILE[,TIP[,JOINT,...]]``."""
    file, tip, *group = (source + ",").split(",")
    joints = ",".join(name for name in group if name)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = load_robot(file, group=joints or None)
    world = ArmWorld(robot, Scene(name="empty space"))
    tip = tip or default_tip(robot)
    rng, low, high = np.random.default_rng(seed), np.array(world.space.low), np.array(world.space.high)
    rows: list[np.ndarray] = []
    while sum(map(len, rows)) < count:
        q = low + rng.random((count, len(low))) * (high - low)
        rows.append(q[world.valid(q)])
    own = np.concatenate(rows)[:count]
    link = robot.links.index(tip)
    poses = link_poses(robot, own)[:, link]
    start = np.clip(np.zeros(len(low)), low, high)
    reach(world, PoseGoal(Pose.from_matrix(poses[0]), tip), start)
    times, solved, found, worst, postures, solver = [], 0, 0, 0.0, [], set()
    for q, pose in zip(own, poses, strict=True):
        goal = PoseGoal(Pose.from_matrix(pose), tip)
        began = time.perf_counter()
        reached = reach(world, goal, start)
        times.append(1e3 * (time.perf_counter() - began))
        solver.add(reached.solver)
        postures.append(reached.branches)
        if len(reached.configurations):
            solved += 1
            worst = max(worst, float(np.abs(link_poses(robot, reached.configurations)[:, link] - pose).max()))
            gap = reached.configurations - q
            found += bool(np.abs(gap - TURN * np.round(gap / TURN)).max(axis=1).min() < 1e-6)
    low_share, high_share = (float(np.ravel(end)[0]) for end in wilson(solved, count))
    return dict(
        robot=robot.name,
        joints=len(low),
        solver=" or ".join(sorted(solver)),
        poses=count,
        solved=solved,
        low_percent=round(100 * low_share, 2),
        high_percent=round(100 * high_share, 2),
        own=found if len(low) == 6 else "",
        error=f"{worst:.1e}",
        median_ms=round(float(np.median(times)), 3),
        p95_ms=round(float(np.percentile(times, 95)), 3),
        postures=round(float(np.mean(postures)), 1),
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--foreign", nargs="*", default=[])
    parser.add_argument("--numeric", action="store_true")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    if options.numeric:
        inverse_kinematics.closed_form = lambda chain: None
    rows = []
    for source in ("ur5", "arm7", *options.foreign):
        rows.append(row(source, options.count, options.seed))
        print(", ".join(f"{name} {rows[-1][name]}" for name in COLUMNS), flush=True)
    write_rows(options.out, COLUMNS, rows)


if __name__ == "__main__":
    main()
