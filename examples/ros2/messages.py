"""Messages of ROS 2 in and out: nothing here needs ROS, so all of it is tested without.

A message that comes in may be of any library that has its fields; one that goes out is made by
``make("nav_msgs/msg/Path", header=..., poses=...)``.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.robot import Robot, Scene, with_group
from evenroad.scenes.planning_scene import read_planning_scene
from evenroad.scenes.robot_in_scene import placed_scene
from evenroad.world import MapFrame

Make = Callable[..., Any]


def ros_message(kind: str, **fields: Any) -> Any:
    """Make a message of ROS itself, which takes lists, not arrays."""
    package, _, name = kind.split("/")
    plain = {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in fields.items()}
    return getattr(import_module(f"{package}.msg"), name)(**plain)


def grid_map(message: Any, occupied_from: int = 65, *, unknown_is_free: bool = False) -> er.GridMap:
    """Return the map of a ``nav_msgs/OccupancyGrid``: cells of `occupied_from` percent on are obstacles."""
    info = message.info
    cells = np.array(message.data, dtype=np.int8).reshape(info.height, info.width)[::-1]
    unknown = cells < 0
    place, turn = info.origin.position, info.origin.orientation
    if max(abs(turn.x), abs(turn.y)) > 1e-6:
        raise InvalidValue(f"the map must lie flat, its origin is turned by x {turn.x}, y {turn.y}")
    # The message has single precision: 0.05 is meant, not 0.05000000074505806.
    resolution = float(str(np.float32(info.resolution)))
    frame = MapFrame(
        rows=info.height,
        cols=info.width,
        resolution=resolution,
        origin=(place.x, place.y),
        yaw=heading(turn),
        y_up=True,
    )
    blocked = (cells >= occupied_from) | (unknown & (not unknown_is_free))
    return er.GridMap(blocked, frame, unknown)


def heading(quaternion: Any) -> float:
    """Return the angle about z, in (-pi, pi], of a quaternion message that turns about z."""
    angle = 2.0 * math.atan2(quaternion.z, quaternion.w)
    return math.atan2(math.sin(angle), math.cos(angle)) if abs(angle) > math.pi else angle


def path_message(
    make: Make, path: npt.NDArray[np.float64], frame: str, stamp: tuple[int, int], last_heading: float
) -> Any:
    """Return waypoints, (p, 2), as a ``nav_msgs/Path``: each pose looks to the next, the last as it is told.

    `stamp` are seconds and nanoseconds.
    """

    def header() -> Any:
        time = make("builtin_interfaces/msg/Time", sec=stamp[0], nanosec=stamp[1])
        return make("std_msgs/msg/Header", stamp=time, frame_id=frame)

    steps = np.diff(path, axis=0)
    poses = []
    for (x, y), angle in zip(
        path.tolist(), [*np.arctan2(steps[:, 1], steps[:, 0]).tolist(), last_heading], strict=True
    ):
        turn = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=math.sin(0.5 * angle), w=math.cos(0.5 * angle))
        place = make("geometry_msgs/msg/Point", x=x, y=y, z=0.0)
        pose = make("geometry_msgs/msg/Pose", position=place, orientation=turn)
        poses.append(make("geometry_msgs/msg/PoseStamped", header=header(), pose=pose))
    return make("nav_msgs/msg/Path", header=header(), poses=poses)


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
