"""``evenroad plan MAP --robot-radius R``: a path for a disk on a map."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from evenroad._time_limit import within
from evenroad.cli import interrupted
from evenroad.cli.plan import PlanDisk
from evenroad.cli.plan_parts import (
    chosen_planner,
    chosen_search,
    common_query,
    finish,
    made_of,
    output_files,
    solve_until_stopped,
)
from evenroad.errors import InvalidValue
from evenroad.io import plan_record
from evenroad.planning.problem import Wanted
from evenroad.planning.read_problem import read_problem
from evenroad.planning.reading import Reading
from evenroad.world import GridMap, load_map
from evenroad.world.gridmap.load import map_files


def plan_disk(plan: PlanDisk) -> int:
    """Plan, write, report; return 0 when solved, else 1."""
    how = chosen_search(plan)
    if plan.guarantees and how.n is None:
        raise InvalidValue("--guarantees goes with a roadmap of points: give their number with -n")
    start = _position("start", plan.start)
    goals = [_position("goal", goal) for goal in plan.goal]
    if plan.world.suffix in (".yaml", ".yml"):
        # Imported late: plans on images do not need robots.
        from evenroad.scenes.scene_file import is_scene

        if is_scene(plan.world):
            raise InvalidValue(f"{plan.world} is a scene, no map: give the arm that moves in it with --robot")
    gridmap = load_map(plan.world, unknown_is_free=plan.unknown_is_free, rules=plan.rules)
    suffixes = ("json", "csv") if plan.csv else ("json",)
    files = output_files(plan, map_files(plan.world), suffixes)
    plan.require_times(map_files(plan.world), files.values())
    for name, value in (("start", start), *(("goal", goal) for goal in goals)):
        _require_on_map(gridmap, name, value)
    made = made_of(gridmap.world(plan.robot_radius, clearance=plan.clearance), map=str(plan.world))
    if how.n is not None and gridmap.unknown.any():
        # Points are drawn over the rectangle, most of which may be unknown.
        gridmap = gridmap.cropped()
    world = gridmap.world(plan.robot_radius, clearance=plan.clearance)
    planner = chosen_planner(plan, how, world, search="full", certify=plan.guarantees)
    wanted = Wanted(
        budget=how.budget,
        smooth=not plan.raw,
        certified=plan.certified,
        prefer_clearance=plan.prefer_clearance,
    )
    with within(how.budget.seconds):
        problem = read_problem(world, start, goals, Reading(), wanted)
        result, stopped = solve_until_stopped(problem, planner)
    query = {
        "map": str(plan.world),
        "robot_radius": plan.robot_radius,
        "clearance": plan.clearance,
        "prefer_clearance": plan.prefer_clearance,
        "unknown_is_free": plan.unknown_is_free,
        "rules": plan.rules,
        **common_query(plan, how),
    }

    def draw(file: Path) -> None:
        from evenroad.viz.plan import save_plan_picture

        save_plan_picture(file, result, world)

    record, more = plan_record(result, query) | {"made_of": made}, []
    if result.certificate is not None:
        from evenroad.cli.certify import guarantee_rows, guarantees

        record["certificate"] = guarantees(result.certificate)
        more = guarantee_rows(result.certificate)
    rows, times = plan.with_times(result, {"plan": {name: record[name] for name in ("query", "made_of")}})
    code = finish(files, result, record | times, ("x", "y"), draw, [*more, *rows], as_json=plan.json)
    return interrupted() if stopped else code


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
