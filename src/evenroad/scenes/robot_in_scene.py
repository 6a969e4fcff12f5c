"""A robot and a scene as they are together: its ranges to plan in, what it holds there, and its planes around it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from evenroad._checks import require_known
from evenroad.errors import InvalidValue
from evenroad.robots.held import same_bodies
from evenroad.robots.planes import Plane
from evenroad.robots.robot import Robot, require_robot
from evenroad.robots.variants import with_limits
from evenroad.scenes.scene import Obstacle, Scene


def in_scene(robot: Robot, scene: Scene) -> Robot:
    """Return the robot as it is in a scene: with the ranges to plan in, where narrower, and what it holds there.

    Raises UnknownName if the scene names a joint or a link that the robot does not have; InvalidValue if no value is
    within both ranges, or the robot holds something else of the same name.
    """
    require_robot(robot)
    for held in scene.attached:
        if held.name in robot.holds:
            if not same_bodies(robot, held):
                both = f"scene {scene.name!r} and robot {robot.name!r}"
                raise InvalidValue(f"{held.name!r} is attached twice: {both} have two bodies of that name")
            continue
        robot = robot.holding(held)
    return within_scene(robot, scene)


def within_scene(robot: Robot, scene: Scene) -> Robot:
    """Return the robot with the scene's ranges to plan in, itself where none is narrower.  Raises as `in_scene`."""
    require_robot(robot)
    limits = {}
    joints = {joint.name: joint for joint in robot.joints} if scene.limits else {}
    for name, (lower, upper) in scene.limits.items():
        require_known(f"joint in the limits of scene {scene.name!r}:", name, joints)
        own = joints[name].lower, joints[name].upper
        narrowed = max(lower, own[0]), min(upper, own[1])
        if narrowed != own:
            limits[name] = narrowed
    # The same object: its cached tables are then found without comparing all values.
    return with_limits(robot, limits) if limits else robot


def with_planes(scene: Scene, planes: Sequence[Plane], links: Collection[str]) -> Scene:
    """Return the scene with the planes around a robot of these links, where it does not have them yet.

    Raises InvalidValue if another obstacle of the scene has the name of one.
    """
    if not planes:
        return scene
    bodies = {obstacle.name: obstacle.body for obstacle in scene.obstacles}
    missing = []
    for obstacle in (Obstacle(plane.name, plane.body, cell=True) for plane in planes):
        if bodies.get(obstacle.name, obstacle.body) != obstacle.body:
            raise InvalidValue(
                f"scene {scene.name!r} has an obstacle {obstacle.name!r}, which is the name of a plane in the robot's"
                " file: give it another"
            )
        if obstacle.name not in bodies:
            missing.append(obstacle)
    allowed = {(link, plane.name) for plane in planes for link in plane.untested if link in links}
    return replace(scene, obstacles=(*scene.obstacles, *missing), allowed=scene.allowed | allowed)
