"""Messages of ROS 2 in and out: nothing here needs ROS, so all of it is tested without.

A message that comes in may be of any library that has its fields; one that goes out is made by
``make("nav_msgs/msg/Path", header=..., poses=...)``.
"""

import math
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import evenroad as er
from evenroad.errors import InvalidValue
from evenroad.robot import HeldObject, Robot, Scene, with_group
from evenroad.scenes.moveit_scene import read_planning_scene
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
    """Return the scene of a ``moveit_msgs/PlanningScene``: objects, what the robot holds, and allowed contacts.

    What would be left out is refused (InvalidValue): a difference to another scene, an octomap, padded or scaled
    links, planes, and objects in frames other than the robot's root link.
    """
    if message.is_diff:
        raise InvalidValue("the planning scene must be whole, not a difference to another")
    if len(message.world.octomap.octomap.data):
        raise InvalidValue("the planning scene has an octomap: give its points as a cloud")
    if any(each.padding != 0.0 for each in message.link_padding):
        raise InvalidValue("the planning scene has padded links: give clearance to the robot's capsules")
    if any(each.scale != 1.0 for each in message.link_scale):
        raise InvalidValue("the planning scene has scaled links")
    objects = message.world.collision_objects
    scene = _scene(objects, message.name or "planning scene", robot.links[0])
    held = []
    for each in message.robot_state.attached_collision_objects:
        parts = _scene([each.object], "held", each.link_name).obstacles
        held += [HeldObject(part.name, part.body, each.link_name, tuple(each.touch_links)) for part in parts]
    allowed = _allowed(message.allowed_collision_matrix, robot, [each.id for each in objects])
    pairs = [(link, part.name) for part in scene.obstacles for link, name in allowed if part.name.split("/")[0] == name]
    return Scene(scene.obstacles, name=scene.name, allowed=frozenset(pairs), attached=tuple(held))


def _scene(objects: Sequence[Any], name: str, frame: str) -> Scene:
    for each in objects:
        if each.header.frame_id not in ("", frame):
            raise InvalidValue(f"object {each.id!r} must be in the frame {frame!r}, got {each.header.frame_id!r}")
    document = {"name": name, "world": {"collision_objects": [_object(each) for each in objects]}}
    return read_planning_scene(document, Path(name))


def _object(message: Any) -> dict[str, Any]:
    """Return a ``moveit_msgs/CollisionObject`` as the YAML that evenroad reads."""
    return {
        "id": message.id,
        "pose": _pose(message.pose),
        "primitives": [
            {"type": int(each.type), "dimensions": [float(size) for size in each.dimensions]}
            for each in message.primitives
        ],
        "primitive_poses": [_pose(each) for each in message.primitive_poses],
        "meshes": [
            {
                "vertices": [[each.x, each.y, each.z] for each in mesh.vertices],
                "triangles": [[int(corner) for corner in each.vertex_indices] for each in mesh.triangles],
            }
            for mesh in message.meshes
        ],
        "mesh_poses": [_pose(each) for each in message.mesh_poses],
        "planes": len(message.planes) > 0,
    }


def _pose(message: Any) -> dict[str, list[float]]:
    place, turn = message.position, message.orientation
    quaternion = [turn.x, turn.y, turn.z, turn.w]
    # As MoveIt takes a pose that nobody has filled in.
    quaternion = quaternion if any(quaternion) else [0.0, 0.0, 0.0, 1.0]
    return {"position": [place.x, place.y, place.z], "orientation": quaternion}


def _allowed(matrix: Any, robot: Robot, objects: Sequence[str]) -> list[tuple[str, str]]:
    """Return the pairs of a link and an object that may touch."""
    names, links = list(matrix.entry_names), set(robot.links)
    enabled = {
        (one, other)
        for one, row in zip(names, matrix.entry_values, strict=True)
        for other, may in zip(names, row.enabled, strict=True)
        if may
    }
    return [(link, name) for link in links for name in objects if {(link, name), (name, link)} & enabled]


def standing(message: Any, robot: Robot) -> tuple[Robot, list[float]]:
    """Return the robot with all other joints where a ``moveit_msgs/PlanningScene`` has them, and those it plans for."""
    state = message.robot_state.joint_state
    values = dict(zip(state.name, (float(value) for value in state.position), strict=True))
    if missing := [joint for joint in robot.group if joint not in values]:
        raise InvalidValue(f"the planning scene does not say where {', '.join(missing)} are")
    moving = {joint.name for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    held = {name: value for name, value in values.items() if name in moving - set(robot.group)}
    return with_group(robot, robot.group, {**robot.held, **held}), [values[joint] for joint in robot.group]
