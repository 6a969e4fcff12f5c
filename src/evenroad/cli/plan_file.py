"""A plan of ``evenroad plan`` on disk: read again with its world, its times, and what has changed since."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._files import Json, read_json_file
from evenroad._seal import has_digest
from evenroad.cli.plan import PlanArm
from evenroad.cli.plan_parts import KEPT, made_of
from evenroad.driving.car_world import CarWorld
from evenroad.driving.polygon_map import load_any_map
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.io import plan_of
from evenroad.loading.robot_file import RobotFile
from evenroad.planning.make_result import make_result
from evenroad.planning.problem import Problem
from evenroad.planning.read_problem import arm_problem
from evenroad.planning.reading import Reading
from evenroad.planning.result import PlanResult, Status
from evenroad.poses.constraint import Constraint, with_tip
from evenroad.saved.world_value import file_in
from evenroad.space.path import continued
from evenroad.trajectory.formats import Saved, saved_of
from evenroad.trajectory.trajectory import Trajectory
from evenroad.world import World, load_map
from evenroad.world.gridmap.disk_world import DiskWorld

FILES = {
    "srdf": str | None,
    "bodies": str | None,
    "use_visuals": bool | None,
    "upright_meshes": bool | None,
    "packages": dict | None,
    "arguments": dict | None,
    "padding": float | int | dict | str | None,
}
"""Fields of a plan about its robot's files, and their types; plans of earlier versions have fewer."""
_MAP = {"map": str, "clearance": float | int, "unknown_is_free": bool, "rules": str | None}
"""Fields of a plan about its map, and their types; plans of earlier versions have no rules."""
_DISK = {"robot_radius": float | int}
_CAR = {"footprint": list, "turning_radius": float | int, "forward_only": bool, "holonomic": bool}
"""Fields about what moves on the map."""


@dataclass(frozen=True)
class PlanFile:
    """A plan with its problem, its times if it has any, and what else its file says.

    `changed` are the names of what changed in its world since; `whole` says whether the file is as it was written, and
    tells what it was made of; `stops` whether the arm stops at points on the way.  `drawn` is the robot's file of a
    plan that was made in Python, which has its world itself.
    """

    problem: Problem
    result: PlanResult
    trajectory: Saved | None = None
    changed: tuple[str, ...] = ()
    whole: bool = False
    constraints: Constraint | None = None
    stops: bool = False
    drawn: RobotFile | None = None


def read_plan(file: Path, robot: str | None = None, options: dict[str, Any] | None = None) -> PlanFile:
    """Return a plan of an arm, a disk or a car; `robot` and `options` of its files stand in for those of the plan.

    Raises BrokenFile if it is damaged, and InvalidValue if it names no robot and scene, and no map.
    """
    record = read_json_file(file, "plan")
    if isinstance(record, dict) and "format" in record:
        return _of_trajectory(record, file)
    return plan_file_of(record, file, robot, options)


def _of_trajectory(record: dict[str, Json], file: Path) -> PlanFile:
    """Return a trajectory with the problem from its first to its last state, in the world of its file."""
    trajectory = saved_of(record, file)
    rows = np.ascontiguousarray(trajectory.positions)
    start, goals = rows[0].copy(), rows[-1:].copy()
    source = trajectory.source.get("plan")
    if trajectory.world is not None:
        problem, drawn = Problem(trajectory.world, start, goals), file_in(trajectory.source["world"])
    elif isinstance(source, dict) and isinstance(query := source.get("query"), dict):
        on_map = "map" in query
        problem = Problem(_world_on_map(query, file), start, goals) if on_map else problem_of(query, file, start, goals)
        drawn = problem.source
    else:
        raise InvalidValue(f"{file} does not say in which world it was made: view the plan or the task instead")
    path = trajectory.waypoints if isinstance(trajectory, Trajectory) else rows
    message = f"trajectory of {trajectory.duration:.4g} s"
    result = make_result(problem, Status.SOLVED, message, path=path, goal_index=0, proof=trajectory.proof)
    return PlanFile(problem, result, trajectory, whole=has_digest(record, file), drawn=drawn)


def plan_file_of(record: Json, file: Path, robot: str | None = None, options: dict[str, Any] | None = None) -> PlanFile:
    """Return the plan of a record of a file; errors as :func:`read_plan`."""
    result, query = plan_of(record, file)
    value = record.get("world")
    if value is not None and robot is None:
        assert result.world is not None
        problem = Problem(result.world, result.start, result.goals)
        return PlanFile(problem, result, whole=has_digest(record, file), drawn=file_in(value))
    if "map" in query:
        problem = Problem(_world_on_map(query, file), result.start, result.goals)
    else:
        problem = problem_of(query, file, result.start, result.goals, robot, options)
    path = result.path
    if path is not None and result.pieces is None:
        # Earlier versions began within one turn.
        path = continued(path, problem.world.space, result.start)
    set_fields(result, world=problem.world, path=path)
    changed = changed_since(record.get("made_of"), problem.world)
    times = record.get("trajectory")
    has_states = isinstance(times, dict) and times.get("states") is not None
    trajectory = saved_of(times["states"], file) if has_states else None
    whole = has_digest(record, file) and changed is not None
    return PlanFile(
        problem, result, trajectory, changed or (), whole, constraints_in(query, file), bool(query.get("via"))
    )


def _world_on_map(query: dict[str, Json], file: Path) -> DiskWorld | CarWorld:
    """Return the world of a plan on a map, by its query."""
    fields = _MAP | (_CAR if "footprint" in query else _DISK)
    if not all(isinstance(query.get(name), kind) for name, kind in fields.items()):
        raise BrokenFile(f"{file} is a damaged plan: of its map, radius, footprint, clearance or unknown cells")
    reading = {"unknown_is_free": query["unknown_is_free"], "rules": query.get("rules")}
    if "footprint" not in query:
        return load_map(query["map"], **reading).world(query["robot_radius"], clearance=query["clearance"])
    same = {name: query[name] for name in ("footprint", "turning_radius", "holonomic", "clearance")}
    return load_any_map(query["map"], **reading).world(**same, reverse=not query["forward_only"])


def changed_since(kept: object, world: World) -> tuple[str, ...] | None:
    """Return the names of what is another than when a plan was made; None for plans that do not say what it was."""
    if not isinstance(kept, dict) or not all(isinstance(each, dict) for each in kept.values()):
        return None
    now = made_of(world)
    if not set(now) <= set(kept):
        return None
    return tuple(name for name, each in now.items() if kept[name].get("sha256") != each["sha256"])


def problem_of(
    query: dict[str, Json],
    file: Path,
    start: Floats,
    goals: Floats,
    robot: str | None = None,
    options: dict[str, Any] | None = None,
) -> Problem:
    """Return the problem of an arm's plan from its query, with this start, (dim,), and these goals, (g, dim)."""
    options = dict(options or {})
    arm = robot or query.get("robot")
    if not isinstance(arm, str) or not isinstance(query.get("scene"), str):
        raise InvalidValue(
            f"{file} names neither a robot and its scene nor a map, and has no world itself: evenroad plan, and"
            " the save of a result that knows its world, write such plans"
        )
    _require_sound(file, query)
    for name in FILES:
        options[name] = options.get(name) or query.get(name) or options.get(name)
    options["group"] = options.get("group") or ",".join(query["joints"])
    options |= {name: bool(options[name]) for name in ("use_visuals", "upright_meshes")}
    apart = {name: query[name] for name in ("resolution", "clearance") if isinstance(query.get(name), float | int)}
    return arm_problem(arm, query["scene"], start, list(goals), Reading(held=query["held"]), **apart, **options)


def constraints_in(query: dict[str, Json], file: Path) -> Constraint | None:
    """Return what a plan keeps on its way, by its query; plans of earlier versions do not say it."""
    given = {name: query[name] for name in KEPT if name in query}
    if not given:
        return None
    sound = all(isinstance(value, KEPT[name]) for name, value in given.items())
    words = [*given.get("via", ()), *given.get("constraint", ())] if sound else []
    if not sound or not all(isinstance(each, list) and all(isinstance(word, str) for word in each) for each in words):
        raise BrokenFile(f"{file} is a damaged plan: of what its path keeps")
    # Imported late: most plans have no constraints.
    from evenroad.cli.plan_constraints import given_constraints

    return with_tip(given_constraints(PlanArm(world=file, start=(), robot="", **given)), given.get("tip", ""))


def _require_sound(file: Path, query: dict[str, Json]) -> None:
    """Raise BrokenFile where a plan does not describe its robot as `evenroad plan` does."""
    kinds = {"joints": list, "held": dict, **FILES}
    sound = all(isinstance(query.get(name), kind) for name, kind in kinds.items())
    if sound:
        pairs = [*(query.get("packages") or {}).values(), *(query.get("arguments") or {}).values()]
        sound = all(isinstance(text, str) for text in (*query["joints"], *pairs))
        sound &= all(isinstance(value, int | float) for value in query["held"].values())
    if not sound:
        raise BrokenFile(f"{file} is a damaged plan: of its robot's joints, held joints or files")
