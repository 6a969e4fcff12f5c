"""Trajectories of files for ``evenroad send``, proved again in the worlds that they were made for."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import cast

import numpy as np

from evenroad._files import Json
from evenroad._seal import has_digest
from evenroad.cli.plan_file import PlanFile, changed_since, constraints_in, plan_file_of, problem_of
from evenroad.cli.run import run_task_of
from evenroad.cli.trajectory import require_meshes_free
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.differential_drive import DifferentialDrive
from evenroad.errors import BrokenFile, InvalidValue, NotAvailable
from evenroad.flight.flight_world import FlightWorld
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Reading
from evenroad.poses.constraint import Constraint, part_of
from evenroad.task.save import task_result_of
from evenroad.trajectory import Trajectory, arm_trajectory, controller_joints, limits_of, proved_in
from evenroad.trajectory.formats import saved_of
from evenroad.trajectory.make import DEVIATION

_SAME = 1e-6
"""Largest distance of the first and last states from start and goal [rad or m]."""

Given = tuple[str, str, dict[str, Json]]
"""A robot, a scene, and the options of the robot's files, as a command names them."""


def sent_plan(record: Json, file: Path, fastest: float) -> tuple[Trajectory, str]:
    """Return the trajectory of a plan's record, or one that is not `fastest` [rad/s] made of its path, and which.

    Raises InvalidValue where it is another than its robot and scene are now, or does not keep its limits; NotAvailable
    where it is not proved free; BrokenFile where it is damaged.
    """
    plan = plan_file_of(record, file)
    if not hasattr(plan.problem.world, "robot"):
        kind = "a flight" if isinstance(plan.problem.world, FlightWorld) else "a plan on a map"
        raise NotAvailable(f"{file} is {kind}; plans of arms are sent")
    _require_unchanged(plan.changed, file)
    value = record.get("world")
    if isinstance(value, dict) and (value.get("keeps") or record.get("deviation")):
        raise NotAvailable(f"{file} does not say what its path keeps on its way: send its trajectory, which was saved")
    kept = plan.trajectory if isinstance(plan.trajectory, Trajectory) else None
    is_kept = kept is not None and bool((abs(kept.velocities) <= fastest).all())
    moves = kept if kept is not None and is_kept else _made(plan, file, fastest)
    proved = _proved(moves, plan.problem, plan.constraints, file, whole=plan.whole)
    return proved, "of the plan" if is_kept else f"made for at most {fastest:g} rad/s"


def sent_task(record: Json, file: Path, fastest: float) -> tuple[Trajectory, str]:
    """Return the trajectory of a task's answer at most `fastest` [rad/s], each motion proved in its own world.

    Raises as :func:`sent_plan`; InvalidValue if a motion does not begin where the last one ended.
    """
    done, whole = task_result_of(record, file), has_digest(record, file)
    arm = [part for motion in done.motions if not motion.fingers for part in motion.parts]
    if not done.solved or not arm:
        raise NotAvailable(f"{file} holds no path: {done.message}")
    for before, after in pairwise(arm):
        if before.path is None or after.path is None or np.abs(before.path[-1] - after.path[0]).max() > _SAME:
            raise InvalidValue(f"the motions of {file} do not begin where those before them end: plan again")
    limits = limits_of(cast(ArmWorld, arm[0].world).robot)
    slow = tuple(min(each, 0.999 * fastest) for each in limits.velocity)
    made = done.trajectory(limits=replace(limits, velocity=slow))
    if not whole:
        _say_unsealed(file)
    if done.fingers:
        _say_alone(done.fingers)
        made = replace(made.only([name for name in made.names if name not in done.fingers]), proof=made.proof)
    return made, f"made for at most {fastest:g} rad/s"


def sent_trajectory(record: Json, file: Path, given: Given | None) -> Trajectory:
    """Return the trajectory of a record, proved where the file says that it was planned, or in what is `given`.

    Raises as :func:`sent_plan`.
    """
    trajectory = saved_of(record, file)
    if not isinstance(trajectory, Trajectory):
        raise NotAvailable(f"{file} is a trajectory of a car; those of arms are sent")
    whole = has_digest(record, file)
    if given is None and "task" in trajectory.source:
        return _planned_again(trajectory, file)
    first, last = trajectory.positions[[0, -1]]
    if trajectory.world is not None and not hasattr(trajectory.world, "robot"):
        raise NotAvailable(f"{file} is a trajectory on a map; those of arms are sent")
    if given is not None:
        robot, scene, options = given
        options["group"] = options["group"] or ",".join(trajectory.names)
        problem = arm_problem(robot, scene, first, [last], Reading(held=trajectory.held), **options)
        return _proved(trajectory, problem, None, file, whole=whole)
    if trajectory.world is not None:
        return _proved(trajectory, Problem(trajectory.world, first, last[np.newaxis]), None, file, whole=whole)
    source = trajectory.source.get("plan")
    if not isinstance(source, dict) or not isinstance(source.get("query"), dict):
        raise InvalidValue(
            f"{file} does not say in which robot and scene it is free: name these with --robot and --scene, or send the"
            " answer of its task, as TaskResult.save writes it"
        )
    try:
        start, goals = (np.array(source["query"][name], dtype=np.float64) for name in ("start", "goals"))
    except (KeyError, TypeError, ValueError) as error:
        raise BrokenFile(f"{file} is a damaged trajectory: of the plan that it was made of: {error}") from error
    problem = problem_of(source["query"], file, start, goals)
    changed = changed_since(source.get("made_of"), problem.world)
    _require_unchanged(changed or (), file)
    whole = whole and changed is not None
    return _proved(trajectory, problem, constraints_in(source["query"], file), file, whole=whole)


def _require_unchanged(changed: tuple[str, ...], file: Path) -> None:
    if changed:
        raise InvalidValue(f"the {' and '.join(changed)} of {file} changed since it was planned: plan again")


def _proved(
    trajectory: Trajectory, problem: Problem, constraints: Constraint | None, file: Path, *, whole: bool
) -> Trajectory:
    """Return a trajectory from start to goal of a problem with the proof of its world.

    If the file may have been changed, a message says so, and limits and order of joints are those of the robot.
    """
    world = problem.arm
    if not whole:
        limits, least = trajectory.limits, limits_of(world.robot)
        velocity, acceleration = (
            tuple(map(min, getattr(limits, kind), getattr(least, kind))) for kind in ("velocity", "acceleration")
        )
        limits = replace(limits, velocity=velocity, acceleration=acceleration)
        known = set(trajectory.names) | set(trajectory.held)
        order = tuple(name for name in controller_joints(world.robot) if name in known)
        trajectory = replace(trajectory, limits=limits, controller=order)
    first, last = trajectory.positions[[0, -1]]
    if np.abs(first - problem.start).max() > _SAME:
        raise InvalidValue("the trajectory does not begin at the start of its plan: plan again")
    if world.space.distance(np.broadcast_to(last, problem.goals.shape), problem.goals).min() > _SAME:
        raise InvalidValue("the trajectory does not end at a goal of its plan: plan again")
    proved = proved_in(trajectory, world, constraints)
    require_meshes_free(problem, proved)
    if not whole:
        _say_unsealed(file)
    return proved


def _say_unsealed(file: Path) -> None:
    text = "has no digest, or does not say of what it was made: only what is proved anew is known of it"
    print(f"evenroad: {file} {text}", file=sys.stderr)


def _say_alone(fingers: tuple[str, ...]) -> None:
    print(f"evenroad: the arm alone is sent: it waits while {', '.join(fingers)} should move", file=sys.stderr)


def _made(plan: PlanFile, file: Path, fastest: float) -> Trajectory:
    """Return a trajectory along the path of a plan that is not faster."""
    world, path = plan.problem.arm, plan.result.path
    if not plan.result.solved or path is None:
        raise NotAvailable(f"{file} holds no path: {plan.result.message}")
    limits = limits_of(world.robot)
    # Positions are sent rounded to steps: a hair below what is allowed.
    slow = tuple(min(each, 0.999 * fastest) for each in limits.velocity)
    stops = plan.stops or part_of(plan.constraints, DifferentialDrive) is not None
    deviation = 0.0 if stops else DEVIATION
    return arm_trajectory(
        world, path, replace(limits, velocity=slow), deviation=deviation, constraints=plan.constraints
    )


def _planned_again(trajectory: Trajectory, file: Path) -> Trajectory:
    """Return the trajectory of a task that is planned again, and so proved: it must have the same states.

    Each step has other held objects and other contacts, which the file does not say.
    """
    task = run_task_of(trajectory.source["task"], file)
    done = task.planned()
    if not done.solved:
        raise NotAvailable(f"the task of {file} cannot be done as it is now: {done.message}")
    again = task.timed(done)
    same = again.names == trajectory.names and dict(again.held) == dict(trajectory.held)
    same = same and all(
        np.array_equal(getattr(again, name), getattr(trajectory, name))
        for name in ("times", "positions", "velocities", "accelerations")
    )
    if not same:
        raise InvalidValue(f"the task of {file} leads to other motions now: give the command that made it again")
    if not done.fingers:
        return again
    _say_alone(done.fingers)
    return replace(again.only([name for name in again.names if name not in done.fingers]), proof=again.proof)
