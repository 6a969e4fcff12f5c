"""MoveIt's planning scene as it is now: a whole scene, then differences to it, as plain values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from threading import Lock
from typing import TypeAlias

import numpy as np

from evenroad._files import Json
from evenroad.errors import InvalidValue, shown
from evenroad.robots.robot import Robot
from evenroad.robots.variants import with_group
from evenroad.ros2.messages import Message
from evenroad.scenes.planning_scene import read_planning_scene
from evenroad.scenes.robot_in_scene import placed_scene
from evenroad.scenes.scene import Scene

Document: TypeAlias = dict[str, Json]
"""A message as ``ros2 topic echo`` writes it: mappings, lists, numbers and texts."""

_REMOVE = 1
"""``moveit_msgs/CollisionObject.REMOVE``; 0 is ADD, 2 APPEND, 3 MOVE."""


def as_document(value: Message) -> Json:
    """Return a message as plain values."""
    if isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, bytes):
        # The type byte of ROS; MoveIt has no other bytes.
        return value[0] if len(value) == 1 else list(value)
    if isinstance(value, np.ndarray | np.generic):
        plain: Json = value.tolist()
        return plain
    if isinstance(value, Sequence):
        return [as_document(each) for each in value]
    if hasattr(value, "tolist"):
        return [as_document(each) for each in value.tolist()]
    own = value.get_fields_and_field_types() if hasattr(value, "get_fields_and_field_types") else vars(value)
    fields = {name: as_document(getattr(value, name)) for name in own if name[0].islower()}
    # As MoveIt takes a quaternion that nobody has filled in.
    return {**fields, "w": 1.0} if fields.keys() == {*"xyzw"} and not any(fields.values()) else fields


def planning_scene(message: Message, robot: Robot) -> Scene:
    """Return the scene of a ``moveit_msgs/PlanningScene``: objects, what the robot holds, padding, allowed contacts.

    Objects in the frames of links are placed by the state of the robot in the message.  What would be left out is
    refused (InvalidValue or UnknownName): a difference to another scene, an octomap, scaled links, planes, and objects
    in frames that neither the message nor the robot has.
    """
    return scene_of(as_mapping(as_document(message)), robot)


def scene_of(document: Document, robot: Robot) -> Scene:
    """Return the scene of a whole planning scene; errors as :func:`planning_scene`."""
    still = {"translation": [0.0] * 3, "rotation": [0.0, 0.0, 0.0, 1.0]}
    root: Json = {"child_frame_id": robot.links[0], "transform": still}
    frames = [*as_list(document.get("fixed_frame_transforms")), root]
    name = Path(str(document.get("name") or "planning scene"))
    scene = placed_scene(robot, read_planning_scene({**document, "fixed_frame_transforms": frames}, name))
    links = {*robot.links, *(each.name for each in scene.attached)}
    return replace(scene, allowed=frozenset(pair for pair in scene.allowed if pair[0] in links))


def joint_values(state: Message, robot: Robot, what: str) -> dict[str, float]:
    """Return where a ``sensor_msgs/JointState`` has the joints of a robot; other names are those of other machines."""
    names, positions = list(state.name), [float(value) for value in state.position]
    if len(names) != len(positions):
        raise InvalidValue(f"{what} has {len(names)} names and {len(positions)} positions")
    values = dict(zip(names, positions, strict=True))
    moving = {joint.name for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    found = {name: value for name, value in values.items() if name in moving}
    if wrong := [f"{name} = {value}" for name, value in found.items() if not np.isfinite(value)]:
        raise InvalidValue(f"{what} must have finite positions, got {', '.join(wrong)}")
    return found


def standing_at_values(values: Mapping[str, float], robot: Robot, what: str) -> tuple[Robot, list[float]]:
    """Return the robot with all other joints where they are, and the positions of those that it plans for."""
    if missing := [joint for joint in robot.group if joint not in values]:
        raise InvalidValue(f"{what} does not say where {', '.join(missing)} are")
    held = {name: value for name, value in values.items() if name not in robot.group}
    return with_group(robot, robot.group, {**robot.held, **held}), [values[joint] for joint in robot.group]


class SceneState:
    """The latest planning scene; threads may share it.  A whole one replaces it, a difference changes it."""

    def __init__(self, robot: Robot) -> None:
        self._robot, self._lock = robot, Lock()
        self._document: Document = {}
        self._scene: Scene | None = None

    @property
    def has_scene(self) -> bool:
        """Whether there is a scene."""
        return self._scene is not None

    def take(self, message: Message) -> Scene:
        """Take a ``moveit_msgs/PlanningScene``, and return the scene; what it refuses leaves all as it was."""
        given = as_mapping(as_document(message))
        with self._lock:
            if given.get("is_diff") and self._scene is None:
                raise InvalidValue("a difference to a planning scene came before any whole one")
            document = changed(self._document, given) if given.get("is_diff") else given
            scene = scene_of(document, self._robot)
            self._document, self._scene = document, scene
            return scene

    def scene(self) -> Scene | None:
        """Return the latest scene, None before the first."""
        return self._scene


def changed(whole: Document, difference: Document) -> Document:
    """Return a whole planning scene after a difference to it, as MoveIt applies it."""
    world, new_world = as_mapping(whole.get("world")), as_mapping(difference.get("world"))
    state, new_state = as_mapping(whole.get("robot_state")), as_mapping(difference.get("robot_state"))
    attached = as_list(new_state.get("attached_collision_objects"))
    names = {_id(as_mapping(as_mapping(each).get("object"))) for each in attached}
    kept = [
        each
        for each in as_list(state.get("attached_collision_objects"))
        if _id(as_mapping(as_mapping(each).get("object"))) not in names and "" not in names
    ]
    joints = _with_values(as_mapping(state.get("joint_state")), as_mapping(new_state.get("joint_state")))
    objects = [*as_list(world.get("collision_objects")), *as_list(new_world.get("collision_objects"))]
    after = {
        **whole,
        "world": {**world, "octomap": new_world.get("octomap") or {}, "collision_objects": _needed(objects)},
        "robot_state": {**state, "joint_state": joints, "attached_collision_objects": [*kept, *attached]},
        "link_padding": _by_link(whole, difference, "link_padding"),
        "link_scale": _by_link(whole, difference, "link_scale"),
    }
    if as_mapping(difference.get("allowed_collision_matrix")).get("entry_names"):
        after["allowed_collision_matrix"] = difference["allowed_collision_matrix"]
    if difference.get("fixed_frame_transforms"):
        after["fixed_frame_transforms"] = difference["fixed_frame_transforms"]
    return after


def _needed(objects: Iterable[Json]) -> list[Json]:
    """Return the operations without those that a later one undoes, so that their number does not grow with time."""
    kept: list[Json] = []
    for each in objects:
        name, operation = _id(as_mapping(each)), as_mapping(each).get("operation") or 0
        if operation in (0, _REMOVE):
            kept = [] if name == "" else [other for other in kept if _id(as_mapping(other)) != name]
        elif operation == 3:
            kept = [other for other in kept if not (_id(as_mapping(other)) == name and _moves(other))]
        if operation != _REMOVE:
            kept.append(each)
    return kept


def _moves(entry: Json) -> bool:
    return as_mapping(entry).get("operation") == 3


def _with_values(old: Document, new: Document) -> Document:
    """Return a joint state with the positions of a newer one."""
    values = dict(zip(as_list(old.get("name")), as_list(old.get("position")), strict=False))
    values |= dict(zip(as_list(new.get("name")), as_list(new.get("position")), strict=False))
    return {**old, "name": list(values), "position": list(values.values())}


def _by_link(whole: Document, difference: Document, kind: str) -> list[Json]:
    entries = [*as_list(whole.get(kind)), *as_list(difference.get(kind))]
    return list({as_mapping(each).get("link_name"): each for each in entries}.values())


def _id(entry: Document) -> Json:
    return entry.get("id")


def as_mapping(value: Json) -> Document:
    """Return a part of a document that is a mapping, an empty one where there is none."""
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise InvalidValue(f"a planning scene must have a mapping here, got {shown(value)}")
    return value


def as_list(value: Json) -> list[Json]:
    """Return a part of a document that is a list, an empty one where there is none."""
    if value is None:
        return []
    if not isinstance(value, list):
        raise InvalidValue(f"a planning scene must have a list here, got {shown(value)}")
    return value
