"""OMPL's and RoboPlan's planning under constraints beside `er.plan`, on the problems of `kept` that it solves.

    python -m studies.benchmarks.kept_rivals --count 20       # needs the extra [ompl], and the wheel roboplan-rrt

OMPL's ProjectedStateSpace with RRT-Connect asks evenroad's residuals, their derivatives, and evenroad's checks of
states, through Python, as anybody does who uses OMPL from Python; a part of its time is Python's.  Its steps along a
constraint are as long as evenroad's, but 0.05 rad at most.  RoboPlan's RRT-Connect has constraints of its own, boxes of
poses, and asks coal; a door and two hands are no such box.  Both get the posture of the goal that `er.plan` has chosen,
which makes theirs the simpler problem.  Each plans once, in `SECONDS` at most.  `kept` are the paths that stay within
the tolerance, and `free` those that touch nothing, at twenty states of each motion.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou
from roboplan.core import JointConfiguration
from roboplan.rrt import RRT, ConstraintProjectorOptions, PoseConstraint, RRTOptions
from studies.benchmarks.arm_problems import Problem
from studies.benchmarks.kept import FORWARD, TUNING, Kept, given_options, problems
from studies.benchmarks.roboplan_arm import GROUP, MOST_NODES, STEP, scene_of

import evenroad as er
from evenroad.constraints.constrained_world import KeptWorld, keeps_of, kept_world

SECONDS, BUSY = 2.0, 4.0
"""Processor time that a plan gets, and how much longer that may take by the clock, which alone RoboPlan reads."""
LONGEST = 0.05
"""Longest step along a constraint [rad]."""
URDF = Path(er.__file__).parent / "loading" / "data" / "ur5.urdf"
RANKS = {"tray": 1, "line": 5, "door": 5, "box": 6}
"""Number of coordinates that a constraint takes away."""
ROWS = {"tray": (3,), "line": (3, 9), "door": (11,), "box": (12,)}
"""Number of the residuals of each constraint."""
Path_ = npt.NDArray[np.float64]


class Residuals(ob.Constraint):  # type: ignore[misc]
    """Residuals of evenroad as shares of their limits, in as many coordinates as they take away."""

    def __init__(self, world: KeptWorld, kind: str) -> None:
        super().__init__(world.world.dim, RANKS[kind], 0.5)
        self.world, self.rank = world, RANKS[kind]
        limits = [keep.limit for keep in world.keeps]
        self.scale = np.concatenate([np.full(n, 1.0 / limit) for n, limit in zip(ROWS[kind], limits, strict=True)])

    def _parts(self, given: Any) -> tuple[Path_, Path_]:
        q = np.array(given, dtype=np.float64)
        residual = self.world.native.residuals(q[np.newaxis])[0] * self.scale
        derivative = self.world.native.derivative(q) * self.scale[:, np.newaxis]
        if self.rank > 1:
            basis = np.linalg.svd(derivative, full_matrices=False)[0][:, : self.rank]
            return basis.T @ residual, basis.T @ derivative
        # A tilt is allowed: what it has too much of counts.
        length = float(np.linalg.norm(residual))
        over = max(0.0, length - 0.4)
        return np.array([over]), (residual / max(length, 1e-12) @ derivative)[np.newaxis] * (over > 0.0)

    def function(self, q: Any, out: Any) -> None:
        """Write the residual."""
        out[:] = self._parts(q)[0]

    def jacobian(self, q: Any, out: Any) -> None:
        """Write its derivative."""
        out[:, :] = self._parts(q)[1]


def by_ompl(kind: str, problem: Kept, kept: KeptWorld, goal: Path_) -> Path_ | None:
    """Plan in OMPL's projected space."""
    dim = kept.world.dim
    plain, bounds = ob.RealVectorStateSpace(dim), ob.RealVectorBounds(dim)
    for k, (low, high) in enumerate(zip(kept.world.space.low, kept.world.space.high, strict=True)):
        bounds.setLow(k, float(low))
        bounds.setHigh(k, float(high))
    plain.setBounds(bounds)
    space = ob.ProjectedStateSpace(plain, Residuals(kept, kind))
    information = ob.ConstrainedSpaceInformation(space)
    space.setDelta(min(LONGEST, kept.step))
    space.setup()
    setup = og.SimpleSetup(information)
    setup.setStateValidityChecker(lambda state: bool(kept.world.valid(np.array([[state[k] for k in range(dim)]]))[0]))
    first, last = space.allocState(), space.allocState()
    first.copy(list(map(float, problem.start)))
    last.copy(list(map(float, goal)))
    setup.setStartAndGoalStates(first, last)
    setup.setPlanner(og.RRTConnect(information))
    until = time.process_time() + SECONDS
    setup.solve(ob.PlannerTerminationCondition(lambda: time.process_time() > until))
    if not setup.haveExactSolutionPath():
        return None
    path = setup.getSolutionPath()
    path.interpolate()
    return np.array([[path.getState(i)[k] for k in range(dim)] for i in range(path.getStateCount())])


def by_roboplan(kind: str, problem: Kept, kept: KeptWorld, goal: Path_) -> Path_ | None:
    """Plan with RoboPlan's constraints."""
    robot = kept.world.robot
    scene = scene_of(Problem("kept", 0, robot, problem.world.scene, problem.start, goal), URDF)
    options, projecting = RRTOptions(), ConstraintProjectorOptions()
    options.group_name, options.rrt_connect, options.max_nodes = GROUP, True, MOST_NODES
    options.max_planning_time, options.collision_check_step_size = BUSY * SECONDS, STEP
    projecting.path_step_size = min(LONGEST, kept.step)
    options.constraint_projection = projecting
    frame = np.eye(4)
    free = np.full(6, np.inf)
    if kind == "tray":
        frame[:3, :3] = er.Pose(rpy=(np.pi, 0.0, 0.0)).rotation_matrix
        free[3:5] = 0.1 / np.sqrt(2.0)
        within = 1e-3, 1e-3
    else:
        frame[:3, :3] = er.Pose(rpy=FORWARD).rotation_matrix
        frame[:3, 3] = kept.chains["tool0"].tip_poses(problem.start[np.newaxis])[0, 9:]
        along = np.abs(frame[:3, :3].T @ [0.0, 1.0, 0.0]) > 0.5
        free[:3] = np.where(along, np.inf, 0.0)
        free[3:] = 0.0
        within = 7e-5, 7e-4
    constraint = PoseConstraint(scene, GROUP, "tool0", -free, free, np.asfortranarray(frame), "", *within)
    planner = RRT(scene, options)
    planner.setRngSeed(1)
    names = list(robot.group)
    try:
        path = planner.plan(JointConfiguration(names, problem.start), JointConfiguration(names, goal), [constraint])
    except RuntimeError:
        return None
    return np.array(path.positions)


def main() -> None:
    """Plan all, print a row a kind and a planner."""
    kinds, count, seed = given_options(__doc__, 20)
    ou.setLogLevel(ou.LOG_ERROR)
    for kind in kinds:
        asked: dict[str, Callable[..., Path_ | None]] = {"OMPL": by_ompl}
        if kind in ("tray", "line"):
            asked["RoboPlan"] = by_roboplan
        rows: dict[str, list[tuple[float, bool, bool, bool]]] = {name: [] for name in ("evenroad", *asked)}
        first = next(problems(kind, 1, TUNING))
        er.plan(first.world, first.start, first.goal, constraints=first.constraints)
        for problem in problems(kind, count, seed):
            begin = time.process_time()
            result = er.plan(problem.world, problem.start, problem.goal, constraints=problem.constraints, seconds=60)
            spent = time.process_time() - begin
            if result.path is None:
                continue
            kept = kept_world(problem.world, keeps_of(problem.constraints), problem.start, "")
            rows["evenroad"].append((spent, *_verdict(kept, result.path)))
            for name, plan in asked.items():
                begin = time.process_time()
                path = plan(kind, problem, kept, result.path[-1])
                rows[name].append((time.process_time() - begin, *_verdict(kept, path)))
        for name, each in rows.items():
            times, solved, keeps, free = (np.array(column) for column in zip(*each, strict=True))
            some = 1e3 * times[solved] if solved.any() else np.array([np.nan])
            print(
                f"{kind}, {name}: {solved.sum()} of {len(each)} solved, {(keeps & solved).sum()} kept,"
                f" {(free & solved).sum()} free; {np.median(some):.1f} ms in the median,"
                f" {np.quantile(some, 0.95):.1f} at 95 %",
                flush=True,
            )


def _verdict(kept: KeptWorld, path: Path_ | None) -> tuple[bool, bool, bool]:
    """Return whether there is a path, keeps its constraints, and touches nothing, at twenty states of each motion."""
    if path is None or len(path) < 2:
        return False, False, False
    states = np.linspace(path[:-1], path[1:], 20).reshape(-1, kept.world.dim)
    return True, bool((kept.shares(states) <= 1.0 + 1e-9).all()), bool(kept.world.valid(states).all())


if __name__ == "__main__":
    main()
