"""A robot and a scene as they are together: ranges to plan in, padding, what is held, planes, and frames of links."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._checks import require_known
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.loading.padding import padding_of
from evenroad.robots.held import HeldObject, same_bodies
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import poses_at, with_mimics
from evenroad.robots.robot import Robot, require_robot
from evenroad.robots.variants import with_limits
from evenroad.scenes.robot_setup import LinkFrames
from evenroad.scenes.scene import Obstacle, Scene


def in_scene(robot: Robot, scene: Scene) -> Robot:
    """Return the robot as it is in a scene: with its ranges, where narrower, its padding, and what it holds there.

    Raises UnknownName if the scene names a joint or a link that the robot does not have; InvalidValue if no value is
    within both ranges, or the robot holds something else of the same name.
    """
    require_robot(robot)
    for held in placed_scene(robot, scene).attached:
        if held.name in robot.holds:
            if not same_bodies(robot, held):
                both = f"scene {scene.name!r} and robot {robot.name!r}"
                raise InvalidValue(f"{held.name!r} is attached twice: {both} have two bodies of that name")
            continue
        robot = robot.holding(held)
    return within_scene(robot, scene)


def within_scene(robot: Robot, scene: Scene) -> Robot:
    """Return the robot with the scene's ranges and padding, itself where they change nothing.  Raises as `in_scene`."""
    require_robot(robot)
    limits = {}
    joints = {joint.name: joint for joint in robot.joints} if scene.limits else {}
    for name, (lower, upper) in scene.limits.items():
        require_known(f"joint in the limits of scene {scene.name!r}:", name, joints)
        own = joints[name].lower, joints[name].upper
        narrowed = max(lower, own[0]), min(upper, own[1])
        if narrowed != own:
            limits[name] = narrowed
    if scene.padding:
        own_padding = dict(robot.padding)
        said = padding_of(robot, scene.padding).items()
        wider = {link: metres for link, metres in said if metres > own_padding.get(link, 0.0)}
        robot = robot.with_padding(wider) if wider else robot
    # The same object: its cached tables are then found without comparing all values.
    return with_limits(robot, limits) if limits else robot


def scene_around(robot: Robot, scene: Scene) -> Scene:
    """Return the scene as it is around a robot: objects in the frames of links are placed, and its planes are there.

    Its padding is the robot's from then on, see `within_scene`.  Raises InvalidValue if an obstacle has the name of a
    plane that is another body; else as `placed_scene`.
    """
    scene = placed_scene(robot, scene)
    if scene.padding:
        scene = replace(scene, setup=replace(scene.setup, padding={}))
    if not robot.planes:
        return scene
    bodies = {obstacle.name: obstacle.body for obstacle in scene.obstacles}
    missing = []
    for obstacle in (Obstacle(plane.name, plane.body, cell=True) for plane in robot.planes):
        if bodies.get(obstacle.name, obstacle.body) != obstacle.body:
            raise InvalidValue(
                f"scene {scene.name!r} has an obstacle {obstacle.name!r}, which is the name of a plane in the robot's"
                " file: give it another"
            )
        if obstacle.name not in bodies:
            missing.append(obstacle)
    allowed = {(link, plane.name) for plane in robot.planes for link in plane.untested if link in robot.links}
    return replace(scene, obstacles=(*scene.obstacles, *missing), allowed=scene.allowed | allowed)


def placed_scene(robot: Robot, scene: Scene) -> Scene:
    """Return the scene with all objects in the frames that they have in every scene; itself where they are.

    Objects in the frame of a link are placed as MoveIt does it: by the state of the robot that the scene has, and they
    stay there when the robot moves.  Raises UnknownName if a frame, or a joint of that state, is none of the robot's.
    """
    frames = scene.setup.frames
    if frames is None:
        return scene
    poses = _link_poses(robot, frames, scene.name)
    origins = {name: poses.get(link, IDENTITY) for name, link in frames.links.items()}
    obstacles = [
        each.at(origins[each.name] @ each.body.pose) if each.name in origins else each for each in scene.obstacles
    ]
    attached = []
    for held in scene.attached:
        if held.name in origins:
            require_known(f"link that carries {held.name!r} in scene {scene.name!r}:", held.link, robot.links)
            pose = poses[held.link].inverse() @ origins[held.name] @ held.body.pose
            held = HeldObject(held.name, replace(held.body, pose=pose), held.link, held.touches)
        attached.append(held)
    return replace(scene, obstacles=obstacles, setup=replace(scene.setup, attached=tuple(attached), frames=None))


def _link_poses(robot: Robot, frames: LinkFrames, scene: str) -> dict[str, Pose]:
    """Return the pose of each link in the state that a scene has; a frame that may be the root link has none."""
    unknown = sorted({link for link in frames.links.values() if link} - {*robot.links})
    if unknown and (frames.are_links or len(unknown) > 1):
        which = next(name for name, link in frames.links.items() if link == unknown[0])
        error = UnknownName.among(f"frame of object {which!r} in scene {scene!r}:", unknown[0], robot.links)
        raise UnknownName(f"{error}; the place of another frame is said by fixed_frame_transforms")
    joints = {joint.name: joint for joint in robot.joints}
    for name in frames.joints:
        require_known(f"joint in the state of scene {scene!r}:", name, joints)
    free = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None]
    said = {**robot.held, **frames.joints}
    values = {joint.name: np.array([said.get(joint.name, _default(joint))]) for joint in free}
    (poses,) = poses_at(robot, with_mimics(robot, values), 1)
    return {link: Pose.from_matrix(pose) for link, pose in zip(robot.links, poses, strict=True)}


def _default(joint: Joint) -> float:
    """Return where MoveIt has a joint of which it knows nothing: at 0, or in the middle of limits without it."""
    within = joint.kind == "continuous" or joint.lower <= 0.0 <= joint.upper
    return 0.0 if within else 0.5 * (joint.lower + joint.upper)
