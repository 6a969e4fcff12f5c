"""What an arm is asked: robot, scene, start and goals, read from names, files and values."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Unpack

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.arms.ways import Ends
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose
from evenroad.roadmap import PlanResult, Status
from evenroad.robot import (
    ArmWorld,
    Robot,
    RobotModel,
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
from evenroad.robot.reference.recheck import MeshCheck, has_meshes, recheck, unseen_pairs
from evenroad.robot.robot import with_group
from evenroad.robot.scan import allowed_near_ends, open_everywhere
from evenroad.robot.states import as_configuration
from evenroad.robot.urdf_xml import RobotFile

PathLike = str | os.PathLike[str]
Place = str | Mapping[str, float] | npt.ArrayLike
"""A configuration: numbers in the order of the group, joint -> value, or a text as
:func:`evenroad.robot.configuration` takes it."""

Goal = Place | Pose | PoseGoal
"""A configuration, or where a link is to be."""

RESOLUTION = 0.05
"""Largest step of a motion check when none is given [rad]."""


@dataclass(frozen=True, eq=False)
class ArmQuery:
    """An arm in its scene, with where it is to go from and to.

    The world's robot is held where named states have the joints that are not planned for, within the scene's ranges.
    Start, (dim,), and goals, (g, dim), are in rad or m; `given` says what the goals were made of.
    `source`, where the robot was read, and `model`, how it was made, are None for a robot that was given as a value.
    """

    world: ArmWorld
    start: Floats
    goals: Floats
    given: Goals
    source: RobotFile | None = None
    model: RobotModel | None = None

    @property
    def goal_names(self) -> tuple[str, ...]:
        """By which texts the caller called the goals, or nothing."""
        return self.given.names

    @property
    def ends(self) -> Ends:
        """World, start and goals, and the tip that goal poses are of."""
        tip = self.given.poses[0][0].tip if self.given.poses else ""
        return Ends(self.world, self.start, self.goals, tip)


def arm_query(
    robot: PathLike | Robot,
    scene: PathLike | Scene,
    start: Place,
    goal: Goal | Sequence[Goal],
    *,
    resolution: float = RESOLUTION,
    clearance: float = 0.0,
    degrees: bool = False,
    tip: str = "",
    frame: str = "",
    held: Mapping[str, float] | None = None,
    **options: Unpack[RobotOptions],
) -> ArmQuery:
    """Read robot, scene and configurations, and put them together; parameters and errors as :func:`plan_arm`.

    Joints outside of the group are held at `held`, else where the named states of start and goal have them.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    source, model = None, None
    if isinstance(robot, Robot):
        if options:
            raise InvalidValue(f"{', '.join(options)} must go with the file of a robot, not with a Robot")
    else:
        model = load_model(robot, **options)
        source, robot = model.file, model.robot
    goals = _places(goal)
    texts = [place for place in (start, *goals) if isinstance(place, str)]
    robot = at_states(in_scene(robot, scene), texts, scene)
    if held:
        robot = with_group(robot, robot.group, {**robot.held, **held})
    scene = scene_seen_by(robot, scene)
    first = _configuration(robot, scene, "start", start, degrees)

    def read(place: Place) -> Floats:
        return _configuration(robot, scene, "goal", place, degrees)

    # What is no configuration is refused before a world is compiled.
    for place in goals:
        if not isinstance(place, Pose | PoseGoal):
            read(place)
    require_tips(robot, goals, tip, frame)
    # Where a goal pose is reached is known only once it is: till then what is allowed near the ends is allowed.
    world = ArmWorld(robot, open_everywhere(scene), resolution=resolution, clearance=clearance)
    given = goals_of(world, first, goals, read, tip, frame)
    if scene.near_ends and not given.unreached:
        ends = np.concatenate([first[np.newaxis], given.configurations])
        world = replace(world, scene=allowed_near_ends(robot, scene, ends))
        given = replace(given, whole=not given.poses)
    return ArmQuery(world, first, given.configurations, given, source, model)


def unreached(query: ArmQuery) -> PlanResult | None:
    """Return the result where no goal pose can be reached and there is no other goal; else None."""
    given = query.given
    if not given.unreached:
        return None
    status = Status.GOAL_INVALID if given.in_collision else Status.GOAL_UNREACHABLE
    return replace(query.ends.refused(status, given.unreached), timings={"goals": given.seconds})


def mesh_check(query: ArmQuery, path: Floats) -> MeshCheck | None:
    """Return what the meshes of the robot's file say of a path, (p, dim); None where there is nothing to ask."""
    world, source, model = query.world, query.source, query.model
    if source is None or model is None:
        return None
    unseen = unseen_pairs(model)
    if not (has_meshes(model) or unseen):
        return None
    return recheck(source, world.robot, world.scene, path, world.resolution, unseen)


def _places(goal: Goal | Sequence[Goal]) -> list[Goal]:
    """Return one goal or several as a list."""
    if isinstance(goal, str | Mapping | Pose | PoseGoal):
        return [goal]
    if isinstance(goal, np.ndarray):
        return list(goal) if goal.ndim == 2 else [goal]
    several = isinstance(goal, Sequence) and any(
        isinstance(each, str | Mapping | Pose | PoseGoal) or np.ndim(each) > 0 for each in goal
    )
    return list(goal) if several else [goal]  # type: ignore[arg-type, list-item]


def _configuration(robot: Robot, scene: Scene, name: str, place: Place, degrees: bool) -> Floats:
    """Return a configuration, (dim,), from a text, joint values or numbers; `name` says what it is in an error."""
    if isinstance(place, str):
        return configuration(robot, place, scene, degrees=degrees)
    return as_configuration(robot, place, scene, name=name)
