"""Reading what ``er.plan`` is given: worlds, maps, scenes and robots, as values, by name or as files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from difflib import get_close_matches
from typing import Any

from evenroad.errors import InvalidValue, shown
from evenroad.planning.arm_request import arm_request, request_in
from evenroad.planning.request import ConfigurationLike, Goal, Reading, Request
from evenroad.roadmap.point_roadmap import Roadmap
from evenroad.roadmap.problem import Planner
from evenroad.roadmap.query import as_start_and_goals
from evenroad.robot import ArmWorld, Scene
from evenroad.robot.load import RobotOptions
from evenroad.world import GridMap, load_map

OF_MAP = ("radius", "clearance", "unknown_is_free")
OF_SCENE = ("robot", "clearance", "resolution", *RobotOptions.__annotations__)


def read_request(
    world: Any,
    start: ConfigurationLike,
    goal: Goal | Sequence[Goal],
    reading: Reading,
    planner: Planner | Roadmap | None = None,
    **of_world: Any,
) -> Request:
    """Return world, start and goals, as far as they can be read; parameters and errors as :func:`evenroad.plan`."""
    if isinstance(world, str | os.PathLike):
        # The radius tells a map from a scene: their names and suffixes are the same.
        if "radius" in of_world:
            world = load_map(world, unknown_is_free=of_world.pop("unknown_is_free", False))
        elif "robot" not in of_world:
            raise InvalidValue(
                f"{os.fspath(world)!r} needs radius=, of a disk on this map, or robot=, the arm in this scene"
            )
    if isinstance(world, GridMap):
        _require_known(of_world, OF_MAP, "a map")
        if "radius" not in of_world:
            raise InvalidValue("a map goes with radius=, that of the disk that moves on it, in map units")
        world = world.world(of_world.pop("radius"), clearance=of_world.pop("clearance", 0.0))
    if isinstance(world, Scene | str | os.PathLike):
        _require_known(of_world, OF_SCENE, "a scene")
        if "robot" not in of_world:
            raise InvalidValue("a scene goes with robot=, the arm that moves in it: a name, a file or a Robot")
        return arm_request(of_world.pop("robot"), world, start, goal, reading, **of_world)
    if of_world:
        what = "a world that is made says all of itself"
        raise InvalidValue(f"{', '.join(of_world)}: unknown arguments of plan, or {what}, got {world!r}")
    if isinstance(world, ArmWorld):
        return request_in(world, start, goal, reading)
    if not hasattr(world, "motion_valid"):
        raise InvalidValue(
            "world must be a World, a GridMap with radius=, or a Scene with robot=; or the name or file of one, got"
            f" {shown(world)}"
        )
    return Request(world, *as_start_and_goals(start, goal, world.space))  # type: ignore[arg-type]


def _require_known(given: dict[str, Any], known: Sequence[str], what: str) -> None:
    for name in given:
        if name not in known:
            near = get_close_matches(name, known, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InvalidValue(f"{name}: unknown argument of plan in {what}{hint}; known: {', '.join(known)}")
