"""``evenroad plan --trajectory``: the path of an arm with times, in files for controllers."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_known, require_positive
from evenroad.cli.outputs import require_output
from evenroad.cli.plan import PlanArm
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.planning.finish import mesh_check
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult
from evenroad.poses.constraint import Constraint, part_of, with_tip
from evenroad.poses.pose_goal import as_numbers
from evenroad.robots.robot import Robot

if TYPE_CHECKING:
    from evenroad.trajectory import Limits, Trajectory

_MOVEJ = ".movej.script"
_TIMES = (
    *("speed", "limits", "torque", "tip_speed", "tip_acceleration", "start_velocity", "goal_velocity"),
    *("deviation", "step", "controller_joints"),
)
_PAIR = re.compile(r"\s*([^=]+?)\s*=\s*([^=]+)")


def limits_of_tip(plan: PlanArm) -> tuple[float | None, float | None]:
    """Return the largest speed and acceleration of the tip, where the command says so."""
    return plan.tip_speed, plan.tip_acceleration


def require_trajectory_options(plan: PlanArm, inputs: Iterable[Path], outputs: Iterable[Path]) -> None:
    """Raise InvalidValue for options that would fail after planning, or overwrite an input or another result."""
    if not (plan.trajectory or plan.timed):
        for option in _TIMES:
            if getattr(plan, option) != type(plan).__dataclass_fields__[option].default:
                raise InvalidValue(f"--{option.replace('_', '-')} goes with --trajectory or --timed only")
        return
    # Imported late: plans without times do not need SciPy's linear algebra.
    from evenroad.trajectory import format_of

    require_positive("speed", plan.speed, at_most=1.0)
    require_positive("deviation", plan.deviation, or_zero=True)
    require_positive("step", plan.step)
    for name, most in zip(("tip-speed", "tip-acceleration"), limits_of_tip(plan), strict=True):
        if most is not None:
            require_positive(f"--{name}", most)
    if plan.torque and plan.robot is None:
        raise InvalidValue("--torque needs --robot: its file says what the links weigh")
    for end in ("start", "goal"):
        if plan.via and getattr(plan, f"{end}_velocity") is not None:
            raise InvalidValue(
                f"--{end}-velocity goes without --via: a plan of several motions begins and ends at rest"
            )
    results = {output.resolve() for output in outputs}
    for file in plan.trajectory:
        format_of(file)
        if plan.via and file.name.lower().endswith(_MOVEJ):
            raise InvalidValue(f"--via goes without {file}: a controller would round the path where it is to pass")
        require_output("--trajectory", file, [*inputs, plan.limits])
        if file.resolve() in results:
            raise InvalidValue(f"--trajectory {file} is a file of another result of this plan; name another one")
        results.add(file.resolve())


def _remove_earlier(plan: PlanArm) -> None:
    """Remove the trajectories of an earlier run."""
    for file in plan.trajectory:
        file.unlink(missing_ok=True)


def _drives(constraints: Constraint) -> bool:
    from evenroad.constraints.differential_drive import DifferentialDrive

    return part_of(constraints, DifferentialDrive) is not None


def _limits(plan: PlanArm, problem: Problem) -> Limits:
    """Return the limits that the command says."""
    from evenroad.loading.find import find_robot
    from evenroad.poses.chain import default_tip
    from evenroad.trajectory import TipLimits, limits_of, load_dynamics

    robot, limits = problem.arm.robot, limits_of(problem.arm.robot, plan.limits)
    if plan.torque:
        assert plan.robot is not None, "refused before"
        limits = replace(limits, torque=load_dynamics(robot, find_robot(plan.robot)[0]))
    if any(limits_of_tip(plan)):
        speed, push = (math.inf if most is None else most for most in limits_of_tip(plan))
        limits = replace(limits, tip=TipLimits(robot, problem.tip or default_tip(robot), speed, push))
    return limits


def _velocity(robot: Robot, option: str, text: str | None) -> Floats | None:
    """Return velocities of the planned joints: one number each, or some by their names; InvalidValue for others."""
    if text is None:
        return None
    if "=" not in text:
        return np.array(as_numbers(f"--{option}", text, (len(robot.group),)))
    values = dict.fromkeys(robot.group, 0.0)
    for word in text.split(","):
        if (pair := _PAIR.fullmatch(word)) is None:
            raise InvalidValue(f"--{option} must be numbers or name=value,..., got {text!r}")
        require_known(f"joint in --{option}:", pair[1], values)
        (values[pair[1]],) = as_numbers(f"--{option} of {pair[1]!r}", pair[2], (1,))
    return np.array([*values.values()])


def trajectory_rows(
    plan: PlanArm,
    problem: Problem,
    result: PlanResult,
    constraints: Constraint | None,
    make: Callable[..., Trajectory] | None,
    source: Mapping[str, object],
) -> tuple[list[tuple[str, str]], dict[str, object] | None, Trajectory | None]:
    """Write the trajectory of a solved plan, with its `source`; return rows for the table, its record, and itself.

    `make` makes it in place of :func:`evenroad.trajectory.arm_trajectory`, from the options.
    """
    if not (plan.trajectory or plan.timed):
        return [], None, None
    stays = result.path is not None and bool(np.all(result.path == result.path[0]))
    if not result.solved or result.path is None or stays:
        _remove_earlier(plan)
        return [("trajectory", "none: the start is the goal")] if stays else [], None, None
    from evenroad.trajectory.formats import save_trajectories, trajectory_record

    try:
        options = _options(plan, problem, constraints)
        trajectory = _timed(plan, problem, result.path, constraints, options) if make is None else make(**options)
        require_meshes_free(problem, trajectory)
    except NotAvailable:
        _remove_earlier(plan)
        raise
    joints = plan.controller_joints
    order = None if joints is None else [*map(str.strip, joints.split(","))]
    save_trajectories(plan.trajectory, replace(trajectory, source=source), order)
    record = {
        "files": [str(file) for file in plan.trajectory],
        **{name: getattr(trajectory, name) for name in ("duration", "deviation", "stops", "proof")},
        "highest": dict(trajectory.highest),
        "states": trajectory_record(trajectory, order),
    }
    files = [("", ", ".join(map(str, plan.trajectory)))] if plan.trajectory else []
    return [("trajectory", _about(trajectory)), *files], record, trajectory


def _options(plan: PlanArm, problem: Problem, constraints: Constraint | None) -> dict[str, Any]:
    """Return the arguments of what makes a trajectory."""
    is_default = plan.deviation == type(plan).__dataclass_fields__["deviation"].default
    # A rounded corner would take a base that cannot go sideways off its way.
    keeps_corners = is_default and constraints is not None and _drives(constraints)
    return {
        "limits": _limits(plan, problem),
        "speed": plan.speed,
        "deviation": 0.0 if keeps_corners else plan.deviation,
        "step": plan.step,
    }


def _timed(
    plan: PlanArm, problem: Problem, path: Floats, constraints: Constraint | None, options: dict[str, Any]
) -> Trajectory:
    """Return the trajectory along a path; NotAvailable where there is none that is free."""
    from evenroad.trajectory import InMotion, arm_trajectory

    robot = problem.arm.robot
    start = _velocity(robot, "start-velocity", plan.start_velocity)
    goal = _velocity(robot, "goal-velocity", plan.goal_velocity)
    return arm_trajectory(
        problem.arm,
        InMotion(path, start, goal),
        rounded_by_controller=any(file.name.lower().endswith(_MOVEJ) for file in plan.trajectory),
        constraints=with_tip(constraints, problem.tip),
        **options,
    )


def require_meshes_free(problem: Problem, trajectory: Trajectory) -> None:
    """Raise NotAvailable if a trajectory is in collision with the robot's meshes."""
    meshes = mesh_check(problem, trajectory.positions)
    if meshes is not None and meshes.verdict == "in collision":
        raise NotAvailable(
            "the trajectory is free for the bodies of the plan, but not for the shapes that they stand for:"
            f" in collision {meshes.message}; a smaller --deviation may help"
        )


def _about(trajectory: Trajectory) -> str:
    used = ", ".join(f"{100 * share:.0f} % of {kind}" for kind, share in trajectory.highest.items())
    stops = f", {trajectory.stops} stops" if trajectory.stops else ""
    off = f"{trajectory.deviation:.2g} off the path{stops}"
    return f"{trajectory.duration:.3f} s, at most {used}; {off}; {trajectory.proof}"
