"""Reads a request for an arm: robot, scene, start and goals, from names, files and values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.planning.request import ConfigurationLike, Goal, PathLike, Reading, Request
from evenroad.robot import (
    ArmWorld,
    Robot,
    Scene,
    at_states,
    configuration,
    in_scene,
    load_model,
    load_scene,
    scene_seen_by,
)
from evenroad.robot.goals import Goals, goals_of, require_tips
from evenroad.robot.load import RobotOptions
from evenroad.robot.pose_goal import PoseGoal
from evenroad.robot.reference.validate import MeshCheck, has_meshes, unseen_pairs, validate
from evenroad.robot.robot import with_group
from evenroad.robot.scan import allowed_near_ends, open_everywhere
from evenroad.robot.states import as_configuration

RESOLUTION = 0.05
"""Largest step of a motion check when none is given [rad]."""


def arm_request(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: ConfigurationLike,
    goal: Goal | Sequence[Goal],
    reading: Reading = Reading(),
    *,
    resolution: float = RESOLUTION,
    clearance: float = 0.0,
    **options: Unpack[RobotOptions],
) -> Request:
    """Read robot, scene and configurations into one request; parameters and errors as :func:`evenroad.plan`.

    Joints outside the group keep the values of `reading.held`, else those of the named states of start and goal.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    source, model = None, None
    if isinstance(robot, Robot):
        if options:
            raise InvalidValue(f"{', '.join(options)} must go with the file of a robot, not with a Robot")
    else:
        model = load_model(robot, **options)
        source, robot = model.file, model.robot
    goals = _goal_list(goal)
    texts = [target for target in (start, *goals) if isinstance(target, str)]
    robot = at_states(in_scene(robot, scene), texts, scene)
    if reading.held:
        robot = with_group(robot, robot.group, {**robot.held, **reading.held})
    scene = scene_seen_by(robot, scene)
    first = _configuration(robot, scene, "start", start, reading)
    _refuse_what_is_none(robot, scene, goals, reading)
    # Where a goal pose is not reached, contacts near the endpoints stay allowed.
    world = ArmWorld(robot, open_everywhere(scene), resolution=resolution, clearance=clearance)
    given = _goals_in(world, first, goals, reading)
    if scene.near_ends and not given.unreached:
        start_and_goals = np.concatenate([first[np.newaxis], given.configurations])
        world = replace(world, scene=allowed_near_ends(robot, scene, start_and_goals))
        given = replace(given, whole=not given.poses)
    return Request(world, first, given.configurations, given, source, model)


def request_in(world: ArmWorld, start: ConfigurationLike, goal: Goal | Sequence[Goal], reading: Reading) -> Request:
    """Read start and goals of an arm whose world exists; parameters and errors as :func:`evenroad.plan`."""
    goals = _goal_list(goal)
    first = _configuration(world.robot, world.scene, "start", start, reading)
    _refuse_what_is_none(world.robot, world.scene, goals, reading)
    given = _goals_in(world, first, goals, reading)
    return Request(world, first, given.configurations, given)


def mesh_check(request: Request, path: Floats) -> MeshCheck | None:
    """Check a path, (p, dim), with the meshes of the robot's file; None where there are none to check."""
    world, source, model = request.world, request.source, request.model
    if source is None or model is None:
        return None
    unseen = unseen_pairs(model)
    if not (has_meshes(model) or unseen):
        return None
    return validate(source, world.robot, world.scene, path, world.resolution, unseen)


def _goals_in(world: ArmWorld, start: Floats, goals: list[Goal], reading: Reading) -> Goals:
    def read(target: ConfigurationLike) -> Floats:
        return _configuration(world.robot, world.scene, "goal", target, reading)

    return goals_of(world, start, goals, read, reading.tip, reading.frame)


def _refuse_what_is_none(robot: Robot, scene: Scene, goals: list[Goal], reading: Reading) -> None:
    """Refuse values that are neither a configuration nor a pose, before a world is compiled."""
    for target in goals:
        if not isinstance(target, Pose | PoseGoal):
            _configuration(robot, scene, "goal", target, reading)
    require_tips(robot, goals, reading.tip, reading.frame)


def _goal_list(goal: Goal | Sequence[Goal]) -> list[Goal]:
    if isinstance(goal, str | Mapping | Pose | PoseGoal):
        return [goal]
    if isinstance(goal, np.ndarray):
        return list(goal) if goal.ndim == 2 else [goal]
    several = isinstance(goal, Sequence) and any(
        isinstance(each, str | Mapping | Pose | PoseGoal) or np.ndim(each) > 0 for each in goal
    )
    return list(goal) if several else [goal]  # type: ignore[arg-type, list-item]


def _configuration(robot: Robot, scene: Scene, name: str, target: ConfigurationLike, reading: Reading) -> Floats:
    """Return a configuration, (dim,), from a text, joint values or numbers; `name` names it in errors."""
    if isinstance(target, str):
        return configuration(robot, target, scene, degrees=reading.degrees)
    return as_configuration(robot, target, scene, name=name)
