"""A plan of ``evenroad plan`` on disk: read again with its world, its times, and what has changed since."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from evenroad._arrays import set_fields
from evenroad._files import read_json_file
from evenroad.cli.plan_parts import made_of
from evenroad.cli.roadmap import load_arm_roadmap
from evenroad.errors import BrokenFile, InvalidValue
from evenroad.io import load_plan
from evenroad.planning.read_request import arm_request
from evenroad.planning.request import Reading, Request
from evenroad.roadmap import PlanResult
from evenroad.robot import load_scene
from evenroad.robot_roadmap.static_scene import joined_scenes
from evenroad.trajectory.files import trajectory_of
from evenroad.trajectory.trajectory import Trajectory
from evenroad.world import load_map

FILES = {
    "srdf": str | None,
    "bodies": str | None,
    "use_visuals": bool | None,
    "packages": dict | None,
    "arguments": dict | None,
    "padding": float | int | dict | str | None,
}
"""Fields of a plan about its robot's files, and their types; plans of earlier versions have fewer."""
_MAP = {
    "map": str,
    "robot_radius": float | int,
    "clearance": float | int,
    "unknown_is_free": bool,
    "rules": str | None,
}
"""Fields of a plan about its map, and their types; plans of earlier versions have no rules."""


@dataclass(frozen=True)
class PlanFile:
    """A plan with its request, its times if it has any, and the names of what changed in its world since."""

    request: Request
    result: PlanResult
    trajectory: Trajectory | None = None
    changed: tuple[str, ...] = ()


def read_plan(file: Path, robot: str | None = None, options: dict[str, Any] | None = None) -> PlanFile:
    """Return a plan of an arm or of a disk; `robot` and `options` of its files stand in for those of the plan.

    Raises BrokenFile if it is damaged, and InvalidValue if it names no robot and scene, and no map.
    """
    result, query = load_plan(file)
    if "map" in query:
        if not all(isinstance(query.get(name), kind) for name, kind in _MAP.items()):
            raise BrokenFile(f"{file} is a damaged plan: of its map, radius, clearance or unknown cells")
        grid = load_map(query["map"], unknown_is_free=query["unknown_is_free"], rules=query.get("rules"))
        world: Any = grid.world(query["robot_radius"], clearance=query["clearance"])
        request = Request(world, result.start, result.goals)
    else:
        request = _of_arm(file, result, query, robot, dict(options or {}))
    set_fields(result, world=request.world)
    record = read_json_file(file, "plan")
    kept, now = record.get("made_of"), made_of(request.world)
    before = {name: each.get("sha256") for name, each in kept.items()} if _is_record(kept) else {}
    changed = tuple(name for name, each in now.items() if before.get(name, each["sha256"]) != each["sha256"])
    times = record.get("trajectory")
    has_states = isinstance(times, dict) and times.get("states") is not None
    return PlanFile(request, result, trajectory_of(times["states"], file) if has_states else None, changed)


def _is_record(kept: Any) -> bool:
    """Return whether a plan says what it was made in; those of earlier versions do not."""
    return isinstance(kept, dict) and all(isinstance(each, dict) for each in kept.values())


def _of_arm(file: Path, result: PlanResult, query: dict[str, Any], robot: Any, options: dict[str, Any]) -> Request:
    robot = robot or query.get("robot")
    kept = query.get("roadmap")
    if not isinstance(robot or kept, str) or not isinstance(query.get("scene"), str):
        raise InvalidValue(f"{file} names neither a robot and its scene nor a map: evenroad plan writes such plans")
    _require_sound(file, query)
    for name in FILES:
        options[name] = options.get(name) or query.get(name) or options.get(name)
    options["group"] = options.get("group") or ",".join(query["joints"])
    options["use_visuals"] = bool(options["use_visuals"])
    scene = load_scene(query["scene"])
    if kept is not None:
        roadmap = load_arm_roadmap(kept)
        scene = joined_scenes(roadmap.scene, scene)
        robot, options = (roadmap.robot, {}) if robot is None else (robot, options)
    apart = {name: query[name] for name in ("resolution", "clearance") if isinstance(query.get(name), float | int)}
    return arm_request(robot, scene, result.start, list(result.goals), Reading(held=query["held"]), **apart, **options)


def _require_sound(file: Path, query: dict[str, Any]) -> None:
    """Raise BrokenFile where a plan does not describe its robot as `evenroad plan` does."""
    kinds = {"joints": list, "held": dict, **FILES}
    sound = all(isinstance(query.get(name), kind) for name, kind in kinds.items())
    if sound:
        pairs = [*(query.get("packages") or {}).values(), *(query.get("arguments") or {}).values()]
        sound = all(isinstance(text, str) for text in (*query["joints"], *pairs))
        sound &= all(isinstance(value, int | float) for value in query["held"].values())
    if not sound:
        raise BrokenFile(f"{file} is a damaged plan: of its robot's joints, held joints or files")
