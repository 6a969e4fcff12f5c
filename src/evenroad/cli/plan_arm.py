"""``evenroad plan SCENE --robot ARM``: a joint path for an arm in a scene."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

from evenroad._compiled import say_if_compiling
from evenroad.arms import SEARCH, ArmQuery, arm_query, finished, plan_on_points
from evenroad.cli.plan_options import ArmOptions
from evenroad.cli.plan_parts import (
    chosen_budget,
    chosen_rule,
    common_query,
    draw_points,
    load_compiled_code,
    output_files,
    print_plan,
    save_plan,
    wants_points,
)
from evenroad.cli.robot_tables import bodiless_rows
from evenroad.io import plan_record
from evenroad.roadmap import default_rule, find_path
from evenroad.robot import RobotModel, find_robot, find_scene, held_values
from evenroad.robot.kernel.selftest import lanes_failure
from evenroad.robot.reference.recheck import MeshCheck


def plan_arm(plan: ArmOptions) -> int:
    """Plan, write, report; return 0 when solved, else 1.

    Links without a body are named, with a warning where the URDF draws them: their collisions go unseen.
    """
    budget = chosen_budget(plan)
    _say_if_compiling(plan)
    query = arm_query(
        plan.robot,
        plan.world,
        " ".join(plan.start),
        [" ".join(words) for words in plan.goal],
        resolution=plan.resolution,
        degrees=plan.deg,
        **plan.options(),
    )
    assert query.model is not None
    files = output_files(plan, _inputs(plan), ("json", "csv"), "file")
    world, start, goals = query.world, query.start, query.goals
    rule = chosen_rule(plan, default_rule(world.space).k)
    points = draw_points(plan, world.space.cube_dim) if wants_points(plan) else None
    load_compiled_code(world, start, goals, points, rule, SEARCH)
    if points is None:
        result = find_path(world, start, goals, budget=budget, shorten=not plan.raw, improve=plan.improve)
    else:
        result = plan_on_points(query, points, rule=rule, shorten=not plan.raw, budget=budget)
    result, meshes = finished(query, result, certified=plan.certified)
    record = plan_record(result, _asked(plan, query)) | {
        "no_body": list(query.model.bodiless),
        "drawn_only": list(query.model.drawn_only),
        "checked_with": world.checked_with,
        "meshes": None if meshes is None else asdict(meshes),
    }
    save_plan(files, result, record, world.robot.group)
    print_plan(result, files.values(), _rows(query, query.model, meshes))
    if "png" in files:
        # Last, and loaded only now: nobody waits for the picture.
        from evenroad.viz.arm import save_arm_picture

        save_arm_picture(files["png"], result, world)
    return 0 if result.solved else 1


def _say_if_compiling(plan: ArmOptions) -> None:
    kernel, points = "evenroad.robot.kernel", wants_points(plan)
    said = say_if_compiling(f"{kernel}.batch", "configurations_free", 30 if points else 20)
    # Where the lanes do not work, the trees are never compiled.
    if not (said or points) and lanes_failure() is None:
        say_if_compiling(f"{kernel}.trees", "grow", 15)


def _asked(plan: ArmOptions, query: ArmQuery) -> dict[str, object]:
    robot = query.world.robot
    return {
        "scene": str(plan.world),
        "robot": plan.robot,
        "srdf": None if plan.srdf is None else str(plan.srdf),
        "bodies": None if plan.bodies is None else str(plan.bodies),
        "joints": list(robot.group),
        "goal_names": list(query.goal_names),
        "held": held_values(robot),
        "resolution": query.world.resolution,
        **common_query(plan),
    }


def _rows(query: ArmQuery, model: RobotModel, meshes: MeshCheck | None) -> list[tuple[str, str]]:
    world = query.world
    rows = [("joints", ", ".join(world.robot.group))]
    held = ", ".join(f"{name} at {value:.6g}" for name, value in held_values(world.robot).items())
    if held:
        rows.append(("held", held))
    rows += bodiless_rows(model)
    rows.append(("checked with", world.checked_with))
    if meshes is not None:
        rows.append(("meshes", str(meshes)))
    return rows


def _inputs(plan: ArmOptions) -> list[Path]:
    given = (find_scene(plan.world), *find_robot(plan.robot), plan.srdf, plan.bodies)
    return [path for path in given if path is not None]
