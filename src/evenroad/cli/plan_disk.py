"""``evenroad plan MAP --robot-radius R``: a path for a disk on a map."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

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
from evenroad.errors import InvalidValue
from evenroad.io import plan_record, save_json, save_path_csv
from evenroad.robot.scene_file import is_scene
from evenroad.viz import save_plan_picture
from evenroad.world import GridMap, load_map
from evenroad.world.gridmap.load import map_files

if TYPE_CHECKING:
    from evenroad.cli.plan import Plan

_ARM_ONLY = ("srdf", "group", "bodies", "deg", "resolution")


def plan_disk(plan: Plan) -> int:
    """Plan, write, report; return 0 when solved, else 1."""
    assert plan.robot_radius is not None
    refuse_options(plan, _ARM_ONLY, "--robot")
    rule = chosen_rule(plan, default_k=10)
    start, goal = (_position(name, getattr(plan, name)) for name in ("start", "goal"))
    if plan.world.suffix in (".yaml", ".yml") and is_scene(plan.world):
        raise InvalidValue(f"{plan.world} is a scene, no map: give the arm that moves in it with --robot")
    gridmap = load_map(plan.world, unknown_is_free=plan.unknown_is_free)
    suffixes = ("json", "png", "csv") if plan.csv else ("json", "png")
    files = output_files(plan, map_files(plan.world), suffixes, "map")
    world = gridmap.world(plan.robot_radius, clearance=plan.clearance)
    for name, value in (("start", start), ("goal", goal)):
        _require_on_map(gridmap, name, value)
    points = draw_points(plan, 2)
    load_compiled_code(world, start, goal, points, rule)
    result = roadmap.plan(world, start, goal, points, rule=rule, shorten=not plan.raw)
    query = {
        "map": str(plan.world),
        "robot_radius": plan.robot_radius,
        "clearance": plan.clearance,
        "unknown_is_free": plan.unknown_is_free,
        **common_query(plan),
    }
    save_json(files["json"], plan_record(result, query))
    if "csv" in files:
        # An earlier run's path must not pass for this one's.
        files["csv"].unlink(missing_ok=True)
        if result.path is None:
            del files["csv"]
        else:
            save_path_csv(files["csv"], result.path, ("x", "y"))
    save_plan_picture(files["png"], result, world)
    print_plan(result, list(files.values()))
    return 0 if result.solved else 1


def _position(name: str, words: tuple[str, ...]) -> tuple[float, float]:
    text = " ".join(words)
    try:
        numbers = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)):
        raise InvalidValue(f"{name} must be two finite numbers x y, got {text!r}")
    return numbers[0], numbers[1]


def _require_on_map(gridmap: GridMap, name: str, value: tuple[float, float]) -> None:
    if gridmap.contains(np.array([value]))[0]:
        return
    corners = gridmap.space.from_cube(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    outline = ", ".join(f"({x:g}, {y:g})" for x, y in corners)
    raise InvalidValue(f"{name} {value[0]:g} {value[1]:g} lies outside the map, whose corners are {outline}")
