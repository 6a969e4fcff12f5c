"""Readers of the arguments of ``er.plan``: worlds, maps, scenes and robots, as values, names or files."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeGuard, Unpack, cast

import numpy as np

from evenroad._arrays import Floats
from evenroad._hints import keyword_hint
from evenroad._shared import recent
from evenroad._time_limit import off_the_clock
from evenroad.collision.arm_world import ArmWorld
from evenroad.driving.goal_region import GoalRegion
from evenroad.errors import InvalidValue, listed, near, shown
from evenroad.geometry.pose import Pose
from evenroad.loading.load import RobotOptions, load_model
from evenroad.planning.problem import Problem, Wanted
from evenroad.planning.reading import Goal, PathLike, Reading
from evenroad.planning.terminals import as_start_and_goals
from evenroad.poses.goals import Goals, goals_of, require_tips
from evenroad.poses.pose_goal import PoseGoal
from evenroad.robots.robot import ConfigurationLike, Robot
from evenroad.robots.variants import standing_at, with_group
from evenroad.scenes.robot_in_scene import in_scene, placed_scene
from evenroad.scenes.scan import allowed_near_ends, open_everywhere, scene_seen_by
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import load_scene
from evenroad.scenes.states import as_configuration, at_states
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.driving import PolygonMap
    from evenroad.world import GridMap

_ANY_PATH: Wanted = {}
_NAMED = str, Pose, PoseGoal
"""Types of goals that can be shown as text."""
OF_CAR = ("footprint", "turning_radius", "reverse", "holonomic")
OF_MAP = ("radius", *OF_CAR, "clearance", "unknown_is_free", "rules")
_OF_WORLD = ("radius", *OF_CAR, "clearance")
OF_PLAN = (
    *("planner", "seconds", "limits", "smooth", "rng"),
    *("certified", "constraints", "degrees", "tip", "frame"),
)
"""Keywords of plan in any world."""
OF_SCENE = ("robot", "clearance", "resolution", *RobotOptions.__annotations__)


def read_problem(
    world: World | GridMap | PolygonMap | Scene | PathLike,
    start: ConfigurationLike,
    goal: Goal | GoalRegion | Sequence[Goal | GoalRegion],
    reading: Reading,
    wanted: Wanted = _ANY_PATH,
    **of_world: Any,
) -> Problem:
    """Return the problem of going from start to goal in a world; parameters and errors as :func:`evenroad.plan`."""
    if isinstance(world, ArmWorld) and not of_world:
        if "checker" not in vars(world):
            with off_the_clock():
                _ = world.checker
        return problem_in(world, start, goal_of_arm(goal), reading, wanted)
    if isinstance(world, str | os.PathLike):
        # Names and suffixes of maps and scenes are the same, so the radius or the footprint decides.
        if "radius" in of_world or "footprint" in of_world:
            # Imported late: a plan of an arm reads no image.
            from evenroad.driving.polygon_map import load_any_map

            reading_of_map = {name: of_world.pop(name) for name in ("unknown_is_free", "rules") if name in of_world}
            with off_the_clock():
                world = load_any_map(world, **reading_of_map)
        elif "robot" not in of_world:
            raise InvalidValue(
                f"{os.fspath(world)!r} needs radius=, of a disk on this map, or robot=, the arm in this scene;"
                " or footprint=, of a car on this map"
            )
    if _is_map(world):
        _require_known(of_world, OF_MAP, "a map")
        if "radius" not in of_world and "footprint" not in of_world:
            raise InvalidValue("a map goes with radius=, that of the disk that moves on it, in map units")
        with off_the_clock():
            world = world.world(**{name: of_world.pop(name) for name in tuple(of_world) if name in _OF_WORLD})
    if isinstance(world, Scene | str | os.PathLike):
        _require_known(of_world, OF_SCENE, "a scene")
        if "robot" not in of_world:
            raise InvalidValue("a scene goes with robot=, the arm that moves in it: a name, a file or a Robot")
        return arm_problem(of_world.pop("robot"), world, start, goal_of_arm(goal), reading, wanted, **of_world)
    if of_world:
        unknown = f"unknown keyword of plan in {shown(world)}: {next(iter(of_world))!r}"
        name = next(iter(of_world))
        if isinstance(world, ArmWorld) and name in OF_SCENE:
            makes = "ArmWorld(robot, scene" if name in ("clearance", "resolution") else "load_robot(file"
            raise InvalidValue(f"{unknown}; this world has its own: {makes}, {name}=...) takes it")
        hint = keyword_hint(name, OF_PLAN) or near(name, OF_PLAN)
        others = "the time limit is seconds=5, others are limits={'motions': 1000}, and er.PRM(512) draws points"
        raise InvalidValue(f"{unknown}; {f'{hint}; {others}' if hint else others}")
    if not is_world(world):
        raise InvalidValue(
            "world must be a World, a GridMap with radius=, or a Scene with robot=; or the name or file of one, got"
            f" {shown(world)}"
        )
    given = list(goal) if isinstance(goal, Sequence) else [goal]
    if any(isinstance(each, GoalRegion) for each in given):
        return _into_regions(world, start, given, wanted)
    return Problem(world, *as_start_and_goals(start, goal, world.space), **wanted)


def goal_of_arm(goal: Goal | GoalRegion | Sequence[Goal | GoalRegion]) -> Goal | Sequence[Goal]:
    """Return the goal of an arm; InvalidValue for a region."""
    given = goal if isinstance(goal, list | tuple) else [goal]
    if any(isinstance(each, GoalRegion) for each in given):
        raise InvalidValue("a goal region is of a car or a disk on a map, and none of an arm")
    return cast("Goal | Sequence[Goal]", goal)


def _into_regions(world: World, start: object, goals: Sequence[object], wanted: Wanted) -> Problem:
    """Return the problem of going to one of several goals, of which some are regions of a map."""
    # Imported late: few plans have regions.
    from evenroad.driving.region_goals import as_regions, goals_in

    regions = as_regions(goals, world)
    first, poses = as_start_and_goals(start, np.concatenate([goals_in(world, each) for each in regions]), world.space)
    return Problem(world, first, poses, regions=regions, **wanted)


def is_world(world: object) -> TypeGuard[World]:
    """Return whether a value checks motions."""
    return hasattr(world, "motion_valid")


def _is_map(world: object) -> TypeGuard[GridMap | PolygonMap]:
    if isinstance(world, Scene | ArmWorld | str | os.PathLike):
        return False
    # Imported late: a plan of an arm has no map.
    from evenroad.driving import PolygonMap
    from evenroad.world import GridMap

    return isinstance(world, GridMap | PolygonMap)


def _require_known(given: Mapping[str, object], known: Sequence[str], what: str) -> None:
    for name in given:
        if name not in known:
            hint = keyword_hint(name, (*known, *OF_PLAN)) or near(name, (*known, *OF_PLAN)) or f"known: {listed(known)}"
            raise InvalidValue(f"{name}: unknown argument of plan in {what}; {hint}")


RESOLUTION = 0.05
"""Default of the largest step of a motion check [rad]."""


def arm_problem(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: ConfigurationLike,
    goal: Goal | Sequence[Goal],
    reading: Reading = Reading(),
    wanted: Wanted = _ANY_PATH,
    *,
    resolution: float = RESOLUTION,
    clearance: float = 0.0,
    **options: Unpack[RobotOptions],
) -> Problem:
    """Return the problem of an arm in a scene; parameters and errors as :func:`evenroad.plan`.

    Joints outside the group keep the values of `reading.held`, else those of the named states of start and goal.
    """
    with off_the_clock():
        scene = scene if isinstance(scene, Scene) else load_scene(scene)
        model = None
        if isinstance(robot, Robot):
            if options:
                raise InvalidValue(f"{', '.join(options)} must go with the file of a robot, not with a Robot")
        else:
            model = load_model(robot, **options)
            robot = model.robot
        goals = goal_list(goal, len(robot.group))
        texts = [target for target in (start, *goals) if isinstance(target, str)]
        scene = placed_scene(robot, scene)
        robot = at_states(in_scene(robot, scene), texts, scene)
        if reading.held:
            robot = with_group(robot, robot.group, {**robot.held, **reading.held})
        scene = scene_seen_by(robot, scene)
        first = as_configuration(robot, start, scene, name="start", degrees=reading.degrees)
        _refuse_what_is_none(robot, scene, goals, reading)
        robot = standing_at(robot, first)
        # If no posture reaches a goal pose, contacts near the endpoints stay allowed.
        around = open_everywhere(scene)
        # Dictionaries may change, so what they decide is no key.
        make = _new_world if around.limits or around.padding else _recent_world
        world = make(robot, around, resolution, clearance, tuple(sorted(robot.held.items())))
    given = _goals_in(world, first, goals, reading)
    if scene.near_ends and not given.unreached:
        start_and_goals = np.concatenate([first[np.newaxis], given.configurations])
        world = replace(world, scene=allowed_near_ends(robot, scene, start_and_goals))
        given = replace(given, whole=not given.poses)
    return Problem(world, first, given.configurations, given=given, model=model, **wanted)


def _new_world(
    robot: Robot, scene: Scene, resolution: float, clearance: float, held: tuple[tuple[str, float], ...]
) -> ArmWorld:
    """Return the world of a robot in a scene, with its checks; `held` are the values of joints outside the group."""
    world = ArmWorld(robot, scene, resolution=resolution, clearance=clearance)
    _ = world.checker
    return world


_recent_world = recent(most=4)(_new_world)


def problem_in(
    world: ArmWorld,
    start: ConfigurationLike,
    goal: Goal | Sequence[Goal],
    reading: Reading,
    wanted: Wanted = _ANY_PATH,
) -> Problem:
    """Return the problem of an arm whose world exists; parameters and errors as :func:`evenroad.plan`."""
    robot, scene = world.robot, world.scene
    goals = goal_list(goal, len(robot.group))
    first = as_configuration(robot, start, scene, name="start", degrees=reading.degrees)
    world = reaching(world, first)
    if len(goals) == 1 and not isinstance(goals[0], _NAMED):
        # Most goals are numbers: they have no name, and mean only this posture.
        last = as_configuration(robot, goals[0], scene, name="goal")
        return Problem(world, first, last.reshape(1, -1), **wanted)
    given = _goals_in(world, first, goals, reading)
    return Problem(world, first, given.configurations, given=given, **wanted)


def reaching(world: ArmWorld, start: Floats) -> ArmWorld:
    """Return a world that allows the start, (dim,), beyond soft limits; the same world if it is within them."""
    robot = standing_at(world.robot, start)
    return world if robot is world.robot else replace(world, robot=robot)


def _goals_in(world: ArmWorld, start: Floats, goals: list[Goal], reading: Reading) -> Goals:
    def read(target: ConfigurationLike) -> Floats:
        return as_configuration(world.robot, target, world.scene, name="goal", degrees=reading.degrees)

    return goals_of(world, start, goals, read, reading.tip, reading.frame)


def _refuse_what_is_none(robot: Robot, scene: Scene, goals: list[Goal], reading: Reading) -> None:
    """Refuse values that are neither a configuration nor a pose, before a world is made."""
    for target in goals:
        if not isinstance(target, Pose | PoseGoal):
            as_configuration(robot, target, scene, name="goal", degrees=reading.degrees)
    require_tips(robot, goals, reading.tip, reading.frame)


def goal_list(goal: Goal | Sequence[Goal], dim: int) -> list[Goal]:
    """Return a list of the goals; a (4, 4) array is the matrix of a pose, unless the arm has four joints."""
    if type(goal) is list and all(type(each) is float for each in goal):
        return [goal]
    if isinstance(goal, np.ndarray):
        if goal.shape == (4, 4) and dim != 4:
            return [Pose.from_matrix(goal)]
        return [each for part in goal for each in goal_list(part, dim)] if goal.ndim in (2, 3) else [goal]
    if isinstance(goal, str | Mapping | Pose | PoseGoal):
        return [goal]
    if not isinstance(goal, Sequence) or not any(
        isinstance(each, str | Mapping | Pose | PoseGoal) or np.ndim(each) > 0 for each in goal
    ):
        return [goal]  # type: ignore[list-item]
    return [each for part in goal for each in (goal_list(part, dim) if isinstance(part, np.ndarray) else [part])]
