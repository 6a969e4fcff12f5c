"""Timing of an arm's paths: how long it takes to find, how long the robot drives, how near to its limits it comes.

    python -m studies.benchmarks.trajectories [--problems 40]

Plans, shortens and times paths of a UR5 on the reporting problems; toppra, on the same rounded path with a grid as
fine, is beside it where it is installed.  So is Ruckig, with limits of jerk, of `JERK` times the acceleration: from
waypoint to waypoint on straight lines, and at rest at each, since its free version has no others.  The share of its
duration is that of evenroad's trajectory with a stop at each corner, and of the one with rounded corners.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib import import_module
from itertools import chain, pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from studies.benchmarks.arm_problems import REPORTING, Pool, arm_named, problems

from evenroad._native.trajectory import rounded
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import NotAvailable
from evenroad.loading.masses import Mass
from evenroad.planning import plan
from evenroad.planning.arm_trees import shorten
from evenroad.planning.read_problem import arm_problem
from evenroad.robot import Scene
from evenroad.trajectory import Dynamics, InMotion, Limits, TipLimits, arm_trajectory, limits_of
from evenroad.trajectory.make import DEVIATION
from evenroad.trajectory.timing import TimeLaw

REPEATS = 3
INTERVALS = 600
"""Of the grid along a path, about as many as evenroad takes."""
JERK = 20.0
"""Jerk that joints may have, as a multiple of their acceleration [1/s]."""
UR5_MASSES = (
    *(("shoulder_link", 3.7, 0.0), ("upper_arm_link", 8.393, 0.28), ("forearm_link", 2.275, 0.25)),
    *(("wrist_1_link", 1.219, 0.0), ("wrist_2_link", 1.219, 0.0), ("wrist_3_link", 0.1879, 0.0)),
)
"""Of links: masses [kg] about as Universal Robots states them, and centres along z [m]; the shipped URDF has none."""
EFFORTS, WEAK = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0), (40.0, 72.0, 28.0, 6.0, 6.0, 6.0)
"""Torques of the UR5's joints [N m], and less, which limits the motions."""
Path = npt.NDArray[np.float64]


def best_ms(task: Callable[[], Any]) -> float:
    """Return the least CPU time of some runs [ms]."""
    times = []
    for _ in range(REPEATS):
        began = time.process_time()
        task()
        times.append(1e3 * (time.process_time() - began))
    return min(times)


def bound(path: Path, limits: Limits) -> float:
    """Return the time that the slowest joint needs alone for its way, bang-bang with rest where it turns back [s]."""
    most = 0.0
    for way, velocity, push in zip(path.T, limits.velocity, limits.acceleration, strict=True):
        steps = np.diff(way)
        turns = np.flatnonzero(np.diff(np.sign(steps[steps != 0.0])) != 0.0)
        runs = np.add.reduceat(steps[steps != 0.0], np.concatenate([[0], turns + 1])) if np.any(steps) else [0.0]
        times = [
            2.0 * np.sqrt(run / push) if run < velocity**2 / push else run / velocity + velocity / push
            for run in np.abs(runs)
        ]
        most = max(most, float(sum(times)))
    return most


def toppra_ms(path: Path, limits: Limits) -> float:
    """Return the CPU time that toppra takes for the same rounded path [ms]; NaN where it is not installed."""
    try:
        toppra = import_module("toppra")
    except ImportError:
        return float("nan")
    velocity, push = np.array(limits.velocity), np.array(limits.acceleration)

    def run() -> None:
        curve = rounded(path, np.full(len(path), 0.05))
        s = np.linspace(0.0, curve.length, INTERVALS)
        constraints = [
            toppra.constraint.JointVelocityConstraint(np.column_stack([-velocity, velocity])),
            toppra.constraint.JointAccelerationConstraint(np.column_stack([-push, push])),
        ]
        # At speed 1 times are lengths.
        along = TimeLaw(curve, curve.starts, curve.starts, np.ones(len(curve.starts)), np.zeros(len(curve.bend)))
        spline = toppra.SplineInterpolator(s, along.at(s).positions)
        toppra.algorithm.TOPPRA(constraints, spline, gridpoints=s).compute_trajectory()

    return best_ms(run)


def ruckig_times(path: Path, limits: Limits) -> tuple[float, float]:
    """Return the duration of Ruckig's motions from waypoint to waypoint [s], and the CPU time that they take [ms]; NaN
    where it is not installed.
    """
    try:
        ruckig = import_module("ruckig")
    except ImportError:
        return float("nan"), float("nan")
    assert limits.jerk is not None, "given by `measure`"

    def run() -> float:
        total, engine = 0.0, ruckig.Ruckig(path.shape[1])
        for a, b in pairwise(path):
            asked, found = ruckig.InputParameter(path.shape[1]), ruckig.Trajectory(path.shape[1])
            asked.current_position, asked.target_position = list(a), list(b)
            asked.max_velocity, asked.max_acceleration = list(limits.velocity), list(limits.acceleration)
            asked.max_jerk = list(limits.jerk)
            # All joints in the same phase: a straight line.
            asked.synchronization = ruckig.Synchronization.Phase
            engine.calculate(asked, found)
            total += found.duration
        return total

    return run(), best_ms(run)


def measure(name: str, world: ArmWorld, start: Path, goal: Path) -> dict[str, Any] | None:
    """Return a row of one problem; None where there is no path, or none to drive."""
    result = plan(world, start, goal[np.newaxis], seconds=5.0)
    if not (result.solved and result.cost) or result.path is None or result.milestone_path is None:
        return None
    raw, path, limits = result.milestone_path, result.path, limits_of(world.robot)
    try:
        made = arm_trajectory(world, path, limits)
    except NotAvailable as reason:
        return {"name": name, "refused": str(reason)}
    smooth = replace(limits, jerk=tuple(JERK * push for push in limits.acceleration))
    ruckig_s, ruckig_ms = ruckig_times(path, smooth)
    rounded_s, stopping_s = (
        arm_trajectory(world, path, smooth, deviation=deviation).duration for deviation in (DEVIATION, 0.0)
    )
    shares = np.linspace(0.0, 1.0, 10)[:-1, None, None]
    between = made.positions[:-1] + shares * np.diff(made.positions, axis=0)
    return {
        "name": name,
        "refused": "",
        "touching": int(np.sum(~world.valid(between.reshape(-1, path.shape[1])))),
        "shorten_ms": best_ms(lambda: shorten(world, raw)),
        "timing_ms": best_ms(lambda: arm_trajectory(world, path, limits)),
        "toppra_ms": toppra_ms(path, limits),
        "jerk_ms": best_ms(lambda: arm_trajectory(world, path, smooth)),
        "ruckig_ms": ruckig_ms,
        "by ruckig": rounded_s / ruckig_s,
        "stop/ruckig": stopping_s / ruckig_s,
        "seconds": made.duration,
        "stopping": arm_trajectory(world, path, limits, deviation=0.0).duration / made.duration,
        "bound": made.duration / bound(path, limits),
        "stops": made.stops,
        "deviation": made.deviation,
        "velocity": made.highest["velocity"],
        "acceleration": made.highest["acceleration"],
    }


def ten_waypoints() -> None:
    """Print how long trajectories of random paths of ten waypoints take in free space, proved free."""
    world, rng = ArmWorld("ur5", Scene([])), np.random.default_rng(0)
    limits = limits_of(world.robot)
    tip = replace(limits, tip=TipLimits(world.robot, "tool0", speed=1.0, acceleration=5.0))
    masses = tuple(Mass(link, mass, (0.0, 0.0, along)) for link, mass, along in UR5_MASSES)
    dynamics = Dynamics(world.robot, masses, EFFORTS)
    heavy = replace(limits, torque=dynamics), replace(limits, torque=replace(dynamics, efforts=WEAK))
    moving = 0.2 * np.array(limits.velocity)
    rows: dict[str, list[float]] = {}
    while len(rows.get("plain", [])) < 20:
        path = np.array([0.0, -1.5, 1.2, -1.2, -1.5, 0.0]) + np.cumsum(rng.uniform(-0.3, 0.3, (10, 6)), axis=0)
        with suppress(NotAvailable):
            asked = {"plain": (path, limits), "in motion": (InMotion(path, moving, moving), limits)}
            asked |= {"limits of the tip": (path, tip), "torques": (path, heavy[0]), "small torques": (path, heavy[1])}
            times = {name: best_ms(lambda each=each: arm_trajectory(world, *each)) for name, each in asked.items()}
            for name, value in times.items():
                rows.setdefault(name, []).append(value)
    for name, each in rows.items():
        print(f"ten waypoints, {name}: {np.median(each):.2f} ms in the median, {np.max(each):.2f} at most")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--problems", type=int, default=40, help="of each kind")
    count = parser.parse_args().problems
    query = arm_problem("ur5", "box-reach", "home", "inside")
    scene_c = [("scene c", query.world, query.start, query.goals[0])]
    ten_waypoints()
    pool = Pool(arm_named("ur5"))
    random = (
        (f"{each.kind} {each.seed}", ArmWorld(each.robot, each.scene, resolution=0.05), each.start, each.goal)
        for each in problems(pool, REPORTING[:count])
    )
    measure(*scene_c[0])
    rows = [measure(*each) for each in chain(scene_c, random)]
    solved = [row for row in rows if row is not None]
    made = [row for row in solved if not row["refused"]]
    print(f"{len(rows)} problems, {len(solved)} solved, {len(made)} with a trajectory")
    for row in solved:
        if row["refused"]:
            print(f"  {row['name']}: {row['refused']}")
    print(f"{'':14} {'scene c':>9} {'median':>9} {'95 %':>9} {'worst':>9}")

    for name in list(made[0])[2:]:
        values = np.array([row[name] for row in made], dtype=float)
        numbers = (values[0], np.median(values[1:]), np.quantile(values[1:], 0.95), np.max(values))
        print(f"{name:14} " + " ".join(f"{value:9.4g}" for value in numbers))


if __name__ == "__main__":
    main()
