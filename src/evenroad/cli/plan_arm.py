"""``evenroad plan SCENE --robot ARM``: a joint path for an arm in a scene."""

from __future__ import annotations

from dataclasses import asdict, replace
from functools import reduce
from operator import and_
from pathlib import Path
from typing import TYPE_CHECKING

from evenroad._time_limit import within
from evenroad.cli import interrupted
from evenroad.cli.outputs import require_certifiable
from evenroad.cli.plan import PlanArm
from evenroad.cli.plan_parts import (
    KEPT,
    chosen_planner,
    chosen_search,
    common_query,
    finish,
    made_of,
    output_files,
    solve_until_stopped,
)
from evenroad.cli.robot import bodiless_rows, decided_by, padding_row
from evenroad.cli.trajectory import limits_of_tip, require_trajectory_options, trajectory_rows
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.io import plan_record
from evenroad.loading.find import find_robot
from evenroad.planning.problem import Problem, Wanted
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Goal, Reading
from evenroad.planning.result import PlanResult
from evenroad.poses.constraint import Constraint, part_of
from evenroad.poses.pose_goal import as_axis, as_numbers, pose_goal_of
from evenroad.roadmap import load_roadmap
from evenroad.robots.kinematics import held_values
from evenroad.scenes.scene_file import find_scene, load_scene

if TYPE_CHECKING:
    from evenroad.trajectory.trajectory import Trajectory


def plan_arm(plan: PlanArm) -> int:
    """Plan, write, report with links without collision geometry; return 0 when solved, else 1."""
    # Wrong input is refused before any work.
    how, goals, scene = chosen_search(plan), _goals(plan), load_scene(plan.world)
    constraints = _constraints(plan)
    read = (find_scene(plan.world), *find_robot(plan.robot), plan.srdf, plan.bodies, plan.roadmap)
    inputs = [path for path in read if path is not None]
    files = output_files(plan, inputs, ("json", "csv"))
    require_trajectory_options(plan, inputs, files.values())
    require_certifiable(plan.certificate, plan.bodies, inputs, embed=plan.embed)
    if plan.roadmap is not None and (how.n is not None or plan.improve):
        raise InvalidValue("--roadmap goes without points and without --improve: it has milestones of its own")
    kept = None if plan.roadmap is None else load_roadmap(plan.roadmap)
    if plan.via and (plan.roadmap is not None or plan.improve or how.n is not None):
        raise InvalidValue("--via goes without --roadmap, --improve and points")
    wanted = Wanted(
        budget=how.budget, smooth=not plan.raw, rng=plan.seed, certified=plan.certified, constraints=constraints
    )
    with within(how.budget.seconds):
        problem = arm_problem(
            plan.robot,
            scene,
            " ".join(plan.start),
            goals,
            Reading(plan.deg, plan.tip, plan.frame),
            wanted,
            resolution=plan.resolution,
            clearance=plan.clearance,
            **plan.options(),
        )
        make, stopped = None, False
        if plan.via:
            from evenroad.cli.plan_via import plan_through

            result, make = plan_through(plan, problem, goals)
        else:
            # Constraints have a world of their own kind, with its own planner.
            own = kept is None and how.n is None and _keeps(constraints)
            by = None if own else chosen_planner(plan, how, problem.world) if kept is None else kept
            result, stopped = solve_until_stopped(problem, by)
    model, world, meshes = problem.model, problem.arm, result.meshes
    record = plan_record(result, _options(plan, problem, result) | common_query(plan, how)) | {
        "no_body": [] if model is None else list(model.bodiless),
        "drawn_only": [] if model is None else list(model.drawn_only),
        "made_of": made_of(world, robot=plan.robot, scene=str(plan.world)),
        "meshes": None if meshes is None else asdict(meshes),
    }
    source = {"plan": {name: record[name] for name in ("query", "made_of")}}
    more_rows, record["trajectory"], trajectory = trajectory_rows(plan, problem, result, constraints, make, source)
    rows = [*_rows(problem), *([] if meshes is None else [("second check", str(meshes))]), *more_rows]
    rows += _certified(plan, result, trajectory)

    def draw(file: Path) -> None:
        from evenroad.viz.arm import save_arm_picture

        save_arm_picture(file, result, world, problem.source)

    code = finish(files, result, record, world.robot.group, draw, rows, as_json=plan.json)
    return interrupted() if stopped else code


def _certified(plan: PlanArm, result: PlanResult, trajectory: Trajectory | None) -> list[tuple[str, str]]:
    """Write the certificate of a path, or of a trajectory's states, or that there is no path; return its row."""
    if plan.certificate is None:
        return []
    # Imported late: most plans are written without one.
    from evenroad.certificates.certify import certify
    from evenroad.certificates.no_path import certify_no_path
    from evenroad.infeasibility.proof import PROVED

    if not (result.solved or result.message.startswith(PROVED)):
        return []

    sources = plan.sources(plan.robot, plan.world, plan.embed)
    if result.path is not None:
        certify(result.world, result.path, sources, plan.certificate, trajectory=trajectory)
    else:
        try:
            certify_no_path(result.world, result.start, result.goals, sources, plan.certificate, result.poses)
        except NotAvailable as reason:
            # A proof may use more than a certificate: the answer of the plan stands.
            return [("certificate", str(reason))]
    of = " of the trajectory" if trajectory is not None else " of the path" if result.solved else ""
    return [("certificate", f"{plan.certificate}{of}, which evenroad-verify checks")]


def _options(plan: PlanArm, problem: Problem, result: PlanResult) -> dict[str, object]:
    """Return the options for the record."""
    world, robot, made = problem.arm, problem.arm.robot, plan.options()
    assert problem.given is not None
    return {
        "scene": str(plan.world),
        "robot": plan.robot,
        "roadmap": None if plan.roadmap is None else str(plan.roadmap),
        "srdf": None if plan.srdf is None else str(plan.srdf),
        "bodies": None if plan.bodies is None else str(plan.bodies),
        **{name: made[name] for name in ("use_visuals", "upright_meshes", "packages", "arguments", "padding")},
        "joints": list(robot.group),
        "goal_names": list(problem.goal_names),
        "held": held_values(robot),
        "holds": list(robot.holds),
        "goal_poses": problem.given.records(world, None if result.path is None else result.path[-1]),
        "resolution": world.resolution,
        "clearance": world.clearance,
        **{name: getattr(plan, name) for name in KEPT},
        "tip": problem.tip,
    }


def _rows(problem: Problem) -> list[tuple[str, str]]:
    """Return rows for the table: joints, held joints, goal poses, links without a body, and the checker."""
    robot, given = problem.arm.robot, problem.given
    assert given is not None
    held = ", ".join(f"{name} at {value:.6g}" for name, value in held_values(robot).items())
    rows = [("joints", ", ".join(robot.group)), *([("held", held)] if held else [])]
    rows += [("holds", ", ".join(robot.holds))] if robot.holds else []
    rows += padding_row(robot)
    for goal, reached in given.poses:
        postures = f"{reached.branches} postures, {reached.blocked} in collision ({reached.solver})"
        rows.append(("goal pose", f"{goal}: {postures}"))
    rows += [] if problem.model is None else bodiless_rows(problem.model)
    return [*rows, ("decided by", decided_by(robot))] if robot.shapes else rows


def _goals(plan: PlanArm) -> list[Goal]:
    """Return the goals, configurations first."""
    if not (plan.goal or plan.goal_pose):
        raise InvalidValue("missing from evenroad plan: --goal, or --goal-pose; all options: evenroad plan --help")
    for option in ("frame", "free_axis", "tolerance"):
        if getattr(plan, option) and not plan.goal_pose:
            raise InvalidValue(f"--{option.replace('_', '-')} goes with --goal-pose")
    of_tip = (plan.goal_pose, plan.straight, plan.upright, plan.constraint, plan.via, *limits_of_tip(plan))
    if plan.tip and not any(of_tip):
        raise InvalidValue("--tip goes with --goal-pose, --via, --straight, --upright, --constraint or --tip-speed")
    near, tilt = 0.0, 0.0
    if plan.tolerance is not None:
        near, tilt, *_ = (*as_numbers("--tolerance", plan.tolerance, (1, 2)), 0.0)
    axis = None if plan.free_axis is None else as_axis("--free-axis", plan.free_axis)
    goals: list[Goal] = [" ".join(words) for words in plan.goal]
    for words in plan.goal_pose:
        text = " ".join(words)
        parts = [pose_goal_of(part, plan.tip, plan.frame, degrees=plan.deg) for part in text.split("&")]
        if axis is not None and any(part.position_only for part in parts):
            raise InvalidValue(f"--free-axis needs a rotation, got the goal pose {text!r} without one")
        parts = [replace(part, free_axis=axis, position_tolerance=near, angle_tolerance=tilt) for part in parts]
        goals.append(reduce(and_, parts))
    return goals


def _constraints(plan: PlanArm) -> Constraint | None:
    if not plan.constraint and {plan.straight, plan.away, plan.upright, plan.upright_axis} == {None}:
        return None
    # Imported late, as below: most plans have no constraints.
    from evenroad.cli.plan_constraints import given_constraints

    return given_constraints(plan)


def _keeps(constraints: Constraint | None) -> bool:
    """Return whether some of the constraints hold along the whole path."""
    if constraints is None:
        return False
    from evenroad.constraints.constrained_world import keeps_of
    from evenroad.constraints.differential_drive import DifferentialDrive

    return bool(keeps_of(constraints)) or part_of(constraints, DifferentialDrive) is not None
