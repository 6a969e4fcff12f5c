"""``evenroad plan SCENE --robot ARM``: a joint path for an arm in a scene."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path

from evenroad._compiled import say_if_compiling
from evenroad.arms import SEARCH, arm_query, finished, plan_on_points
from evenroad.cli.plan import PlanArm
from evenroad.cli.plan_parts import (
    chosen_budget,
    chosen_rule,
    common_query,
    draw_points,
    finish,
    load_compiled_code,
    output_files,
    wants_points,
)
from evenroad.cli.roadmap import kept_roadmap
from evenroad.cli.robot import bodiless_rows
from evenroad.cli.trajectory import require_trajectory_options, trajectory_rows
from evenroad.io import plan_record
from evenroad.roadmap import default_rule, find_path
from evenroad.robot import find_robot, find_scene, held_values, load_scene
from evenroad.robot.kernel.selftest import lanes_failure
from evenroad.robot_roadmap.cell import day_and_all
from evenroad.robot_roadmap.robot_roadmap import SceneRoadmap


def plan_arm(plan: PlanArm) -> int:
    """Plan, write, report; return 0 when solved, else 1.

    Links without a body are named, with a warning where the URDF draws them: their collisions go unseen.
    """
    budget = chosen_budget(plan)
    kept = None if plan.roadmap is None else kept_roadmap(plan)
    _say_if_compiling(plan)
    robot = kept.robot if kept is not None and plan.robot is None else plan.robot
    assert robot is not None
    query = arm_query(
        robot,
        plan.world if kept is None else day_and_all(kept.cell, load_scene(plan.world))[1],
        " ".join(plan.start),
        [" ".join(words) for words in plan.goal],
        resolution=plan.resolution,
        degrees=plan.deg,
        **({} if plan.robot is None else plan.options()),
    )
    known = None if kept is None else SceneRoadmap(kept, query.world.scene, query.world.robot)
    query = query if known is None else replace(query, world=known.world)
    of_robot = () if plan.robot is None else find_robot(plan.robot)
    inputs = (find_scene(plan.world), *of_robot, plan.srdf, plan.bodies, plan.roadmap)
    require_trajectory_options(plan, [path for path in inputs if path is not None])
    files = output_files(plan, [path for path in inputs if path is not None], ("json", "csv"), "file")
    world, start, goals = query.world, query.start, query.goals
    rule = chosen_rule(plan, default_rule(world.space).k)
    points = draw_points(plan, world.space.cube_dim) if wants_points(plan) else None
    load_compiled_code(world, start, goals, points, rule, SEARCH)
    if known is not None:
        result = known.plan(start, goals, budget=budget, shorten=not plan.raw)
    elif points is None:
        result = find_path(world, start, goals, budget=budget, shorten=not plan.raw, improve=plan.improve)
    else:
        result = plan_on_points(query, points, rule=rule, shorten=not plan.raw, budget=budget)
    result, meshes = finished(query, result, certified=plan.certified)
    more_rows, trajectory = trajectory_rows(plan, world, result)
    robot, model = world.robot, query.model
    asked = {
        "scene": str(plan.world),
        "robot": plan.robot,
        "roadmap": None if plan.roadmap is None else str(plan.roadmap),
        "srdf": None if plan.srdf is None else str(plan.srdf),
        "bodies": None if plan.bodies is None else str(plan.bodies),
        "joints": list(robot.group),
        "goal_names": list(query.goal_names),
        "held": held_values(robot),
        "resolution": world.resolution,
    }
    record = plan_record(result, asked | common_query(plan)) | {
        "no_body": [] if model is None else list(model.bodiless),
        "drawn_only": [] if model is None else list(model.drawn_only),
        "checked_with": world.checked_with,
        "trajectory": trajectory,
        "meshes": None if meshes is None else asdict(meshes),
    }
    held = ", ".join(f"{name} at {value:.6g}" for name, value in held_values(robot).items())
    rows = [("joints", ", ".join(robot.group)), *([("held", held)] if held else [])]
    rows += [] if model is None else bodiless_rows(model)
    rows += [("checked by", world.checked_with), *([] if meshes is None else [("meshes", str(meshes))])]
    rows += more_rows

    def draw(file: Path) -> None:
        from evenroad.viz.arm import save_arm_picture

        save_arm_picture(file, result, world)

    return finish(files, result, record, robot.group, draw, rows)


def _say_if_compiling(plan: PlanArm) -> None:
    kernel, points = "evenroad.robot.kernel", wants_points(plan)
    said = say_if_compiling(f"{kernel}.batch", "check_configurations", 30 if points else 20)
    if plan.roadmap is not None and lanes_failure() is None:
        said = say_if_compiling("evenroad.robot_roadmap.lane_search", "find_way", 10) or said
    # Where the lanes do not work, the trees are never compiled.
    if not (said or points) and lanes_failure() is None:
        say_if_compiling(f"{kernel}.trees", "grow", 15)
