"""Messages of MoveIt: nothing here needs ROS, so all of it is tested without."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.robot import Robot, Scene, with_group
from evenroad.scenes.planning_scene import read_planning_scene
from evenroad.scenes.robot_in_scene import placed_scene


def planning_scene(message: Any, robot: Robot) -> Scene:
    """Return the scene of a ``moveit_msgs/PlanningScene``: objects, what the robot holds, padding, allowed contacts.

    Objects in the frames of links are placed by the state of the robot in the message.  What would be left out is
    refused (InvalidValue or UnknownName): a difference to another scene, an octomap, scaled links, planes, and objects
    in frames that neither the message nor the robot has.
    """
    document = _plain(message)
    root = {"child_frame_id": robot.links[0], "transform": {"translation": [0.0] * 3, "rotation": [0.0, 0.0, 0.0, 1.0]}}
    document["fixed_frame_transforms"].append(root)
    scene = placed_scene(robot, read_planning_scene(document, Path(message.name or "planning scene")))
    links = {*robot.links, *(each.name for each in scene.attached)}
    return replace(scene, allowed=frozenset(pair for pair in scene.allowed if pair[0] in links))


def _plain(value: Any) -> Any:
    """Return a message as the YAML of ``ros2 topic echo`` has it: mappings, lists, numbers and texts."""
    if isinstance(value, str | bytes | bool | int | float):
        return value
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Sequence):
        return [_plain(each) for each in value]
    own = value.get_fields_and_field_types() if hasattr(value, "get_fields_and_field_types") else vars(value)
    plain = {name: _plain(getattr(value, name)) for name in own if name[0].islower()}
    # As MoveIt takes a quaternion that nobody has filled in.
    return {**plain, "w": 1.0} if plain.keys() == {*"xyzw"} and not any(plain.values()) else plain


def standing(message: Any, robot: Robot) -> tuple[Robot, list[float]]:
    """Return the robot with all other joints where a ``moveit_msgs/PlanningScene`` has them, and those it plans for."""
    state = message.robot_state.joint_state
    values = dict(zip(state.name, (float(value) for value in state.position), strict=True))
    if missing := [joint for joint in robot.group if joint not in values]:
        raise InvalidValue(f"the planning scene does not say where {', '.join(missing)} are")
    moving = {joint.name for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    held = {name: value for name, value in values.items() if name in moving - set(robot.group)}
    return with_group(robot, robot.group, {**robot.held, **held}), [values[joint] for joint in robot.group]
