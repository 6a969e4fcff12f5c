"""Paths of OMPL, checked at states as its users do: how many are proved free, and how many touch.

    python -m studies.benchmarks.other_paths [--count 12] [--robot ur5]     # needs the extras [ompl], [mesh]

OMPL plans with RRT-Connect and simplifies the path, at its default resolution: states 1 % of the space's extent apart.
coal tests each state with the shapes of the robot's file.  The problems are those of `arm_problems`: shelves, boxes,
cages and tables at random.  `certify_path` then proves each path free or finds its first touch, by the same shapes.
A row counts the paths that touch where coal, too, sees the contact, at states around it; and the problems in which the
straight line from start to goal first touches where coal sees it, at states 1e-3 of the line apart.
"""

from __future__ import annotations

import time
from collections import Counter

import numpy as np
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou
from studies.benchmarks.arm_problems import KINDS, REPORTING, Pool, Problem, Vector, problems
from studies.benchmarks.rows import parser_of

import evenroad as er
from evenroad.certificates.certify_path import PathCheck, certify_path
from evenroad.collision.coal_world import CoalWorld, original_shapes

SECONDS = 5.0
APART = 1e-3


def theirs(problem: Problem, judge: CoalWorld, rng: int) -> Vector | None:
    """Return OMPL's simplified path, None where it finds none."""
    low, high = problem.robot.limits.T
    dim = len(low)
    space = ob.RealVectorStateSpace(dim)
    bounds = ob.RealVectorBounds(dim)
    for i in range(dim):
        bounds.setLow(i, float(low[i]))
        bounds.setHigh(i, float(high[i]))
    space.setBounds(bounds)
    ou.RNG.setSeed(rng)
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: bool(judge.valid(_numbers(state, dim)[np.newaxis])[0]))
    ends = [space.allocState(), space.allocState()]
    for state, q in zip(ends, (problem.start, problem.goal), strict=True):
        for i in range(dim):
            state[i] = float(q[i])
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(og.RRTConnect(setup.getSpaceInformation()))
    if not setup.solve(SECONDS) or not setup.haveExactSolutionPath():
        return None
    setup.simplifySolution()
    return np.array([_numbers(state, dim) for state in setup.getSolutionPath().getStates()])


def _numbers(state: ob.State, dim: int) -> Vector:
    return np.array([state[i] for i in range(dim)])


def seen_by(judge: CoalWorld, path: Vector, check: PathCheck) -> bool:
    """Return whether coal, too, sees the contact of a path: somewhere in the thousandth part after its first touch."""
    assert check.touch is not None
    a, b = path[check.touch.waypoint : check.touch.waypoint + 2]
    shares = np.minimum(check.touch.share + np.linspace(0.0, 0.02, 41), 1.0)[:, np.newaxis]
    return not judge.valid(a + shares * (b - a)).all()


def same_touch(judge: CoalWorld, problem: Problem, name: str) -> bool:
    """Return whether coal first sees a contact of the straight line where `certify_path` does, or none as it does."""
    line = np.array([problem.start, problem.goal])
    touch = certify_path(line, er.ArmWorld(problem.robot, problem.scene), robot=name).touch
    shares = np.arange(0.0, 1.0, APART)
    blocked = np.flatnonzero(~judge.valid(line[0] + shares[:, np.newaxis] * (line[1] - line[0])))
    if touch is None or not len(blocked):
        return touch is None and not len(blocked)
    return bool(touch.share <= shares[blocked[0]] <= touch.share + 5.0 * APART)


def main() -> None:
    """Print a row for each kind of scene."""
    parser = parser_of(__doc__)
    parser.add_argument("--count", type=int, default=12, help="seeds, a problem of each kind for each")
    parser.add_argument("--robot", default="panda")
    given = parser.parse_args()
    ou.setLogLevel(ou.LOG_NONE)
    robot = er.load_robot(given.robot)
    shapes = original_shapes(given.robot, robot)
    pool = Pool(robot)
    counts: dict[str, Counter[str]] = {kind: Counter() for kind in KINDS}
    took = []
    for problem in problems(pool, REPORTING[: given.count]):
        judge = CoalWorld(robot, problem.scene, shapes)
        row = counts[problem.kind]
        row["problems"] += 1
        row["same line"] += same_touch(judge, problem, given.robot)
        path = theirs(problem, judge, problem.seed)
        if path is None:
            continue
        begin = time.process_time()
        check = certify_path(path, er.ArmWorld(robot, problem.scene), robot=given.robot)
        took.append(1e3 * (time.process_time() - begin))
        row["paths"] += 1
        row[check.status] += 1
        row["seen by coal"] += check.status == "touches" and seen_by(judge, path, check)
    for name, row in {**counts, "all": sum(counts.values(), Counter())}.items():
        said = ("problems", "paths", "free", "touches", "undecided", "seen by coal", "same line")
        print(f"{name:6}" + "".join(f"  {each} {row[each]}" for each in said))
    print(f"certify_path: {np.median(took):.0f} ms in the median, {max(took):.0f} at most")


if __name__ == "__main__":
    main()
