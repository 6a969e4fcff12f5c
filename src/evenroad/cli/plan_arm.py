"""``evenroad plan SCENE --robot ARM``: a joint path for an arm in a scene."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from evenroad import roadmap
from evenroad.cli.plan_parts import (
    chosen_rule,
    common_query,
    draw_points,
    load_compiled_code,
    output_files,
    refuse_options,
)
from evenroad.cli.plan_table import print_plan
from evenroad.cli.robot_tables import bodiless_rows
from evenroad.io import plan_record, save_json, save_path_csv
from evenroad.roadmap import PlanResult, Status, default_rule
from evenroad.robot import (
    ArmWorld,
    at_states,
    configuration,
    find_robot,
    find_scene,
    held_values,
    in_scene,
    load_model,
    load_scene,
)
from evenroad.robot.reference.recheck import MeshCheck, has_meshes, recheck, unseen_pairs

if TYPE_CHECKING:
    from evenroad.cli.plan import Plan

RESOLUTION = 0.05
"""Largest step of a motion check when none is given [rad]."""

SEARCH = "lazy"
"""The same path as by the full search; of an arm, checks of motions are the dear part."""


def plan_arm(plan: Plan) -> int:
    """Plan, write, report; return 0 when solved, else 1.

    Links without a body are named, with a warning where the URDF draws them: their collisions go unseen.
    """
    assert plan.robot is not None
    refuse_options(plan, ("clearance", "unknown_is_free"), "--robot-radius")
    scene = load_scene(plan.world)
    model = load_model(plan.robot, srdf=plan.srdf, group=plan.group, bodies=plan.bodies)
    files = output_files(plan, _inputs(plan), ("json", "csv", "png"), "file")
    ends = [" ".join(words) for words in (plan.start, plan.goal)]
    robot = at_states(in_scene(model.robot, scene), ends, scene)
    start, goal = (configuration(robot, end, scene, degrees=plan.deg) for end in ends)
    world = ArmWorld(robot, scene, resolution=RESOLUTION if plan.resolution is None else plan.resolution)
    rule = chosen_rule(plan, default_rule(world.space).k)
    points = draw_points(plan, world.space.cube_dim)
    load_compiled_code(world, start, goal, points, rule, SEARCH)
    result = roadmap.plan(world, start, goal, points, rule=rule, search=SEARCH, shorten=not plan.raw)
    meshes = None
    unseen = unseen_pairs(model)
    if result.path is not None and (has_meshes(model) or unseen):
        meshes = recheck(plan.robot, robot, scene, result.path, world.resolution, unseen)
        result = _judged(result, meshes)
    query = {
        "scene": str(plan.world),
        "robot": plan.robot,
        "srdf": None if plan.srdf is None else str(plan.srdf),
        "bodies": None if plan.bodies is None else str(plan.bodies),
        "joints": list(robot.group),
        "held": held_values(robot),
        "resolution": world.resolution,
        **common_query(plan),
    }
    record = plan_record(result, query) | {
        "no_body": list(model.bodiless),
        "drawn_only": list(model.drawn_only),
        "checked_with": world.checked_with,
        "meshes": None if meshes is None else asdict(meshes),
    }
    save_json(files["json"], record)
    # An earlier run's path must not pass for this one's, nor one in collision for a free one.
    files["csv"].unlink(missing_ok=True)
    if result.path is None or not result.solved:
        del files["csv"]
    else:
        save_path_csv(files["csv"], result.path, robot.group)
    from evenroad.viz.arm import save_arm_picture

    save_arm_picture(files["png"], result, world)
    rows = [("joints", ", ".join(robot.group))]
    held = ", ".join(f"{name} at {value:.6g}" for name, value in held_values(robot).items())
    if held:
        rows.append(("held", held))
    rows += bodiless_rows(model)
    rows.append(("checked with", world.checked_with))
    if meshes is not None:
        rows.append(("meshes", str(meshes)))
    print_plan(result, list(files.values()), rows)
    return 0 if result.solved else 1


def _judged(result: PlanResult, meshes: MeshCheck) -> PlanResult:
    """Return a plan with the status that its path has when the meshes are asked, too."""
    if meshes.verdict != "in collision":
        return result
    message = (
        "the path is free for the robot's capsules, but not for the shapes that they stand for: in collision"
        f" {meshes.message}"
    )
    return replace(result, status=Status.MESH_COLLISION, message=message)


def _inputs(plan: Plan) -> list[Path]:
    assert plan.robot is not None
    given = (find_scene(plan.world), *find_robot(plan.robot), plan.srdf, plan.bodies)
    return [path for path in given if path is not None]
