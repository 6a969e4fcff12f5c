"""Reading MoveIt's planning scenes in YAML, as MotionBenchMaker and ``ros2 topic echo`` write them.

Of the world boxes, spheres, cylinders and meshes are read, in the order of their operations; what is attached; which
contacts of objects are allowed; and the padding of links.  Objects may be in the frames of links: they are placed when
the robot is known, by the joints of ``robot_state``.  What else a planning scene may say is refused where it could be
an obstacle, and passes where it is none.  Quaternions are (x, y, z, w), lengths metres.  An object of several shapes
becomes obstacles ``NAME/0``, ``NAME/1``, ...
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.geometry.pose import IDENTITY
from evenroad.loading.bodies_file import padded
from evenroad.scenes.planning_objects import (
    PLANNING_FRAMES,
    ROOT,
    attached_object,
    given_frames,
    objects_after_all,
    transform_of,
)
from evenroad.scenes.robot_setup import LinkFrames, RobotSetup
from evenroad.scenes.scene import Obstacle, Scene

_XYZ = Kind(("x", "y", "z"))
_XYZW = Kind(("x", "y", "z", "w"))
_POSE = Kind(parts={"position": _XYZ, "orientation": _XYZW})
_TRANSFORM = Kind(parts={"translation": _XYZ, "rotation": _XYZW})
_HEADER = Kind(("frame_id",), harmless={"stamp", "seq"})
_OBJECT = Kind(
    ("id", "operation", "subframe_names"),
    {
        "header": _HEADER,
        "pose": _POSE,
        "primitives": Kind(("type", "dimensions"), harmless={"polygon"}),
        "meshes": Kind(parts={"vertices": _XYZ, "triangles": Kind(("vertex_indices",))}, harmless={"resource"}),
        "planes": Kind(("coef",)),
        "primitive_poses": _POSE,
        "mesh_poses": _POSE,
        "plane_poses": _POSE,
        "subframe_poses": _POSE,
    },
    harmless={"type"},
)
_ATTACHED = Kind(("link_name", "touch_links"), {"object": _OBJECT}, harmless={"detach_posture", "weight"})
_OCTOMAP = Kind(
    parts={"header": _HEADER, "octomap": Kind(("data",), {"header": _HEADER}, harmless={"binary", "id", "resolution"})},
    harmless={"origin"},
)
_SCENE = Kind(
    ("name", "is_diff"),
    {
        "world": Kind(parts={"collision_objects": _OBJECT, "octomap": _OCTOMAP}),
        "robot_state": Kind(
            parts={
                "attached_collision_objects": _ATTACHED,
                "joint_state": Kind(("name", "position"), {"header": _HEADER}, harmless={"velocity", "effort"}),
                "multi_dof_joint_state": Kind(
                    ("joint_names",), {"header": _HEADER, "transforms": _TRANSFORM}, harmless={"twist", "wrench"}
                ),
            },
            harmless={"is_diff"},
        ),
        "link_padding": Kind(("link_name", "padding")),
        "link_scale": Kind(("link_name", "scale")),
        "allowed_collision_matrix": Kind(
            ("entry_names", "default_entry_names", "default_entry_values"), {"entry_values": Kind(("enabled",))}
        ),
        "fixed_frame_transforms": Kind(
            ("child_frame_id",),
            {"header": _HEADER, "transform": _TRANSFORM},
        ),
    },
    harmless={"robot_model_name", "object_colors"},
)


def read_planning_scene(document: Mapping[str, Any], path: Path) -> Scene:
    """Return the scene of a planning scene that was read from YAML.

    Raises UnknownName for what a planning scene does not have, and a shape that is not read; BrokenFile for a part of
    another type, and where numbers of shapes and poses differ; InvalidValue for a value out of its range, a plane, an
    octomap that is not empty, and links that are scaled.  A frame that the file does not place is that of a link, or
    refused when the robot is known.
    """
    where = f"the planning scene {path}"
    _require_lists(document, _SCENE, where)
    require_understood(document, _SCENE, where)
    if document.get("is_diff") is True:
        raise InvalidValue(f"{where} is a difference (is_diff: true) from another one: write the whole scene")
    _require_plain_links(document, where)
    world, state = document["world"], document.get("robot_state") or {}
    if ((world.get("octomap") or {}).get("octomap") or {}).get("data"):
        raise InvalidValue(f"{where} has an octomap: write it with octomap's tools and include it, include: FILE.bt")
    frames = given_frames(document, path)
    attached = [attached_object(each, frames, path) for each in state.get("attached_collision_objects") or []]
    held = [each for each in attached if each is not None]
    known = frames | {name: frame for each in held for name, frame in each.frames.items()}
    objects = objects_after_all(world.get("collision_objects") or [], known, path)
    _require_base_at_root(state, [name for name, each in objects.items() if each.frame.link == ROOT], where)
    groups = {name: each.named(name) for name, each in objects.items()}
    links = {own: objects[name].frame.link for name, group in groups.items() for own in group}
    links = {own: link for own, link in links.items() if link != ROOT}
    links |= {body.name: each.link for each in held for body in each.bodies if each.link != body.link}
    bodies = tuple(body for each in held for body in each.bodies)
    unplaced = {*links.values()} - {body.link for body in bodies} - {ROOT}
    are_links = len(frames) > len(PLANNING_FRAMES) or len(unplaced) > 1
    if unplaced and not are_links:
        alone = f"{path}: frame {unplaced.pop()!r} is taken as the robot's root link, unless a link has this name"
        warnings.warn(alone, stacklevel=4)
    joints = _joints(state, where)
    return Scene(
        [Obstacle(own, body) for group in groups.values() for own, body in group.items()],
        name=str(document.get("name") or path.stem),
        allowed=frozenset(_allowed(document.get("allowed_collision_matrix") or {}, groups, where)),
        setup=RobotSetup(
            attached=bodies,
            padding=_padding(document, where),
            frames=LinkFrames(links, joints, are_links) if links else None,
        ),
    )


def _require_lists(document: Mapping[str, Any], kind: Kind, where: str) -> None:
    """Raise BrokenFile where something that has parts is neither a mapping nor a list of mappings or numbers."""
    waiting: list[tuple[Any, Kind]] = [(document, kind)]
    while waiting:
        value, kind = waiting.pop()
        for name, inner in kind.parts.items():
            part = value.get(name)
            if part is None and name != "world":
                continue
            entries = part if isinstance(part, list) else [part]
            if name in ("position", "orientation", "vertices", "triangles", "translation", "rotation"):
                continue  # Numbers by their letters or as a list: their readers say what is wrong.
            if name == "world" and not isinstance(part, Mapping):
                raise BrokenFile(f"'world' in {where} must consist of 'key: value' entries, got {shown(part)}")
            for each in entries:
                if not isinstance(each, Mapping):
                    raise BrokenFile(f"{name!r} in {where} must consist of 'key: value' entries, got {shown(each)}")
                waiting.append((each, inner))


def _require_plain_links(document: Mapping[str, Any], where: str) -> None:
    """Raise InvalidValue where links are scaled: that depends on their shapes, which a scene does not have."""
    for each in document.get("link_scale") or []:
        link = each.get("link_name")
        (scale,) = numbers(each.get("scale"), 1, f"scale of link {link!r} in {where}")
        if scale != 1.0:
            raise InvalidValue(
                f"{where} has link_scale {scale:g} of link {link!r}, which a scene does not hold; give it to the robot,"
                f" load_robot(file, padding=FILE) or --padding FILE: default_robot_link_scale: {{{link}: {scale:g}}}"
            )


def _padding(document: Mapping[str, Any], where: str) -> dict[str, float]:
    """Return by how much links are padded, link -> metres, of those that are."""
    padding = {}
    for each in document.get("link_padding") or []:
        what = f"padding of link {each.get('link_name')!r} in {where}"
        (metres,) = numbers(each.get("padding"), 1, what)
        if padded(f"the {what}", metres):
            padding[str(each.get("link_name"))] = metres
    return padding


def _joints(state: Mapping[str, Any], where: str) -> dict[str, float]:
    """Return where the robot stands, joint -> value."""
    said = state.get("joint_state") or {}
    names, position = said.get("name") or [], said.get("position") or []
    values = numbers(position, len(names), f"the position of joint_state in {where}, one a name,")
    return dict(zip(map(str, names), values, strict=True))


def _require_base_at_root(state: Mapping[str, Any], objects: list[str], where: str) -> None:
    """Raise InvalidValue if the robot's base is away from the planning frame, and objects are in that."""
    said = state.get("multi_dof_joint_state") or {}
    names, transforms = said.get("joint_names") or [], said.get("transforms") or []
    for name, each in zip(names, transforms, strict=False):
        if objects and transform_of(each, f"joint {name!r} of {where}") != IDENTITY:
            raise InvalidValue(
                f"{where} has joint {name!r} away from the planning frame, which object {objects[0]!r} is in: write"
                " objects in the frame of the robot's root link"
            )


def _allowed(matrix: Mapping[str, Any], groups: Mapping[str, Collection[str]], where: str) -> set[tuple[str, str]]:
    """Return contacts of links and obstacles that a matrix allows; of two links the robot's own file says that."""
    names, rows = matrix.get("entry_names") or [], matrix.get("entry_values") or []
    enabled = [each.get("enabled") or [] for each in rows]
    if [len(names)] * len(names) != [len(row) for row in enabled]:
        raise BrokenFile(f"allowed_collision_matrix in {where} must have a row and a column for each of its names")
    for name, value in zip(
        matrix.get("default_entry_names") or [], matrix.get("default_entry_values") or [], strict=False
    ):
        if value and name in groups:
            raise InvalidValue(f"{where} allows {name!r} to touch everything by default: name the links that may")
    return {
        (str(link), obstacle)
        for i, link in enumerate(names)
        for k, name in enumerate(names)
        if enabled[i][k] is True and link not in groups and name in groups
        for obstacle in groups[name]
    }
