"""``evenroad plan MAP --footprint "[[x, y], ...]"``: a path for a car on a map."""

from __future__ import annotations

import math
from ast import literal_eval
from pathlib import Path

import numpy as np

from evenroad._time_limit import within
from evenroad.cli import interrupted
from evenroad.cli.plan import PlanCar
from evenroad.cli.plan_parts import chosen_search, common_query, finish, made_of, output_files, solve_until_stopped
from evenroad.driving.car_world import LARGEST_ANGLE
from evenroad.driving.footprint import FootprintLike
from evenroad.driving.goal_region import GoalRegion
from evenroad.driving.polygon_map import load_any_map
from evenroad.errors import InvalidValue, shown
from evenroad.io import plan_record
from evenroad.planning.planners.car import CarSearch
from evenroad.planning.planners.trees import default_planner
from evenroad.planning.problem import Planner, Wanted
from evenroad.planning.read_problem import read_problem
from evenroad.planning.reading import Reading
from evenroad.world.gridmap.load import map_files

LARGEST_TEXT = 20_000
"""Largest number of characters of a footprint on the command line."""


def plan_car(plan: PlanCar) -> int:
    """Plan, write, report; return 0 when solved, else 1."""
    how = chosen_search(plan)
    if how.n is not None or plan.improve:
        raise InvalidValue("a car is planned without points and --improve: only --time, --seed, --raw and --cusp-cost")
    start, goals = _pose("start", plan.start, plan.deg), [_goal(goal, plan) for goal in plan.goal]
    gridmap = load_any_map(plan.world, unknown_is_free=plan.unknown_is_free, rules=plan.rules)
    world = gridmap.world(
        footprint=_footprint(plan.footprint),
        turning_radius=plan.turning_radius,
        reverse=not plan.forward_only,
        holonomic=plan.holonomic,
        clearance=plan.clearance,
    )
    files = output_files(plan, map_files(plan.world), ("json", "csv") if plan.csv else ("json",))
    plan.require_times(map_files(plan.world), files.values())
    made = made_of(world, map=str(plan.world))
    planner: Planner = default_planner(world)
    if plan.cusp_cost is not None:
        planner = CarSearch(cusp_cost=plan.cusp_cost)
    wanted = Wanted(
        budget=how.budget,
        smooth=not plan.raw,
        certified=plan.certified,
        rng=plan.seed,
        prefer_clearance=plan.prefer_clearance,
    )
    with within(how.budget.seconds):
        problem = read_problem(world, start, goals, Reading(), wanted)
        result, stopped = solve_until_stopped(problem, planner)
    of_car = ("turning_radius", "forward_only", "holonomic", "cusp_cost", "unknown_is_free", "rules")
    kept = ("clearance", "prefer_clearance", "goal_radius", "goal_within")
    query = {
        "map": str(plan.world),
        "footprint": [outline.tolist() for outline in world.footprint.outlines],
        **{name: getattr(plan, name) for name in (*of_car, *kept)},
        **common_query(plan, how),
    }

    def draw(file: Path) -> None:
        result.plot(file)

    record = plan_record(result, query) | {"made_of": made}
    more = []
    if result.pieces is not None:
        more = [("drive", f"{len(result.pieces)} pieces, {result.cusps} changes between forwards and backwards")]
    rows, times = plan.with_times(result, {"plan": {"query": query, "made_of": made}})
    code = finish(files, result, record | times, ("x", "y", "angle"), draw, [*more, *rows], as_json=plan.json)
    return interrupted() if stopped else code


def _footprint(text: str) -> FootprintLike:
    """Return the corners that a text such as "[[0, 0], [1, 0], [1, 1]]" lists."""
    try:
        # Only numbers and brackets are read; JSON would refuse ".3" and brackets of Python.
        corners: FootprintLike | None = literal_eval(text.strip()) if len(text) <= LARGEST_TEXT else None
    except (ValueError, TypeError, SyntaxError, RecursionError, MemoryError):
        corners = None
    if not isinstance(corners, list | tuple):
        raise InvalidValue(f'--footprint must be corners as "[[x, y], [x, y], ...]", got {shown(text)}')
    return corners


def _goal(words: tuple[str, ...], plan: PlanCar) -> tuple[float, float, float] | GoalRegion:
    """Return a goal, or with --goal-radius a region."""
    if plan.goal_radius is None:
        if plan.goal_within != 0.0:
            raise InvalidValue("--goal-within goes with --goal-radius, which may be 0")
        return _pose("goal", words, plan.deg)
    has_angle = len(" ".join(words).replace(",", " ").split()) != 2
    x, y, angle = _pose("goal", words if has_angle else (*words, "0"), plan.deg)
    within = math.radians(plan.goal_within) if plan.deg else plan.goal_within
    return GoalRegion((x, y), plan.goal_radius, angle=angle if has_angle else None, within=within)


def _pose(name: str, words: tuple[str, ...], in_degrees: bool) -> tuple[float, float, float]:
    text = " ".join(words)
    try:
        numbers = [float(word) for word in text.replace(",", " ").split()]
    except ValueError:
        numbers = []
    if len(numbers) != 3 or not np.isfinite(numbers).all():
        raise InvalidValue(f"{name} must be three finite numbers x y angle, got {text!r}")
    x, y, angle = numbers
    if not in_degrees and abs(angle) > LARGEST_ANGLE:
        raise InvalidValue(f"the angle of the {name} must be at most 4 pi in radians, got {angle:g}; --deg for degrees")
    return x, y, math.radians(angle) if in_degrees else angle
