"""Reading MoveIt's planning scenes in YAML, as MotionBenchMaker and ``ros2 topic echo`` write them.

The reader takes boxes, spheres, cylinders and meshes, in the order of their operations; attached objects; allowed
contacts of objects; and the padding of links.  Objects may be in the frames of links: they are placed when the robot is
known, by the joints of ``robot_state``.  Anything else is refused if it could be an obstacle, and skipped if it cannot.
Quaternions are (x, y, z, w), lengths metres.  An object of several shapes becomes obstacles ``NAME/0``, ``NAME/1``, ...
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Mapping
from pathlib import Path

from evenroad._understood import Kind, require_understood
from evenroad._yaml import numbers
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.geometry.pose import IDENTITY
from evenroad.loading.padding import padded
from evenroad.scenes.entry import Entry
from evenroad.scenes.planning_objects import (
    PLANNING_FRAMES,
    ROOT,
    attached_object,
    given_frames,
    message_pose,
    objects_after_all,
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
        **dict.fromkeys(("primitive_poses", "mesh_poses", "plane_poses", "subframe_poses"), _POSE),
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


def read_planning_scene(document: Mapping[str, object], path: Path) -> Scene:
    """Return the scene of a planning scene that was read from YAML.

    Raises UnknownName for what a planning scene does not have, and a shape that is not read; BrokenFile for a part of
    another type, and where numbers of shapes and poses differ; InvalidValue for a value out of its range, a plane, an
    octomap that is not empty, and links that are scaled.  A frame that the file does not place is that of a link, or
    refused when the robot is known.
    """
    scene = Entry(document, f"the planning scene {path}")
    require_understood(document, _SCENE, scene.where)
    _require_honoured(scene)
    frames, state = given_frames(scene), scene.part("robot_state")
    attached = [attached_object(each, frames) for each in state.parts("attached_collision_objects")]
    held = [each for each in attached if each is not None]
    known = frames | {name: frame for each in held for name, frame in each.frames.items()}
    objects = objects_after_all(scene.part("world").parts("collision_objects"), known)
    _require_base_at_root(state, [name for name, each in objects.items() if each.frame.link == ROOT])
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
    joints = _joints(state.part("joint_state"))
    return Scene(
        [Obstacle(own, body) for group in groups.values() for own, body in group.items()],
        name=str(document.get("name") or path.stem),
        allowed=frozenset(_allowed(scene.part("allowed_collision_matrix"), groups)),
        setup=RobotSetup(
            attached=bodies, padding=_padding(scene), frames=LinkFrames(links, joints, are_links) if links else None
        ),
    )


def _require_honoured(scene: Entry) -> None:
    """Raise InvalidValue where a planning scene has what a scene cannot hold, and BrokenFile if it has no world."""
    if not isinstance(scene.get("world"), Mapping):
        raise BrokenFile(
            f"'world' in {scene.where} must consist of 'key: value' entries, got {shown(scene.get('world'))}"
        )
    if scene.get("is_diff") is True:
        raise InvalidValue(f"{scene.where} is a difference (is_diff: true) from another one: write the whole scene")
    if scene.part("world").part("octomap").part("octomap").get("data"):
        advice = "write it with octomap's tools and include it, include: FILE.bt"
        raise InvalidValue(f"{scene.where} has an octomap: {advice}")
    for each in scene.parts("link_scale"):
        link = each.get("link_name")
        if (scale := each.number("scale", what=f"scale of link {link!r}")) != 1.0:
            raise InvalidValue(
                f"{scene.where} has link_scale {scale:g} of link {link!r}, which a scene does not hold; give it to the"
                " robot, load_robot(file, padding=FILE) or --padding FILE: default_robot_link_scale:"
                f" {{{link}: {scale:g}}}"
            )


def _padding(scene: Entry) -> dict[str, float]:
    """Return by how much links are padded, link -> metres, of those that are."""
    padding = {}
    for each in scene.parts("link_padding"):
        link = str(each.get("link_name"))
        what = f"padding of link {link!r}"
        padding[link] = padded(f"the {what} in {scene.where}", each.number("padding", what=what))
    return {link: metres for link, metres in padding.items() if metres}


def _joints(state: Entry) -> dict[str, float]:
    """Return where the robot stands, joint -> value."""
    names = state.entries("name")
    values = numbers(
        state.entries("position"), len(names), f"the position of joint_state in {state.where}, one a name,"
    )
    return dict(zip(map(str, names), values, strict=True))


def _require_base_at_root(state: Entry, objects: list[str]) -> None:
    """Raise InvalidValue if the robot's base is away from the planning frame, and objects are in that."""
    if objects and any(
        message_pose(each) != IDENTITY for each in state.part("multi_dof_joint_state").parts("transforms")
    ):
        raise InvalidValue(
            f"{state.where} has the robot's base away from the planning frame, which object {objects[0]!r} is in: write"
            " objects in the frame of the root link"
        )


def _allowed(matrix: Entry, groups: Mapping[str, Collection[str]]) -> set[tuple[str, str]]:
    """Return contacts of links and obstacles that a matrix allows; of two links the robot's own file says that."""
    names, rows = matrix.entries("entry_names"), [each.entries("enabled") for each in matrix.parts("entry_values")]
    if [len(names)] * len(names) != [len(row) for row in rows]:
        raise BrokenFile(
            f"allowed_collision_matrix in {matrix.where} must have a row and a column for each of its names"
        )
    by_default = zip(matrix.entries("default_entry_names"), matrix.entries("default_entry_values"), strict=False)
    if open_ := [name for name, value in by_default if value and name in groups]:
        raise InvalidValue(
            f"{matrix.where} allows {open_[0]!r} to touch everything by default: name the links that may"
        )
    return {
        (str(link), obstacle)
        for link, row in zip(names, rows, strict=True)
        for name, enabled in zip(map(str, names), row, strict=True)
        if enabled is True and link not in groups and name in groups
        for obstacle in groups[name]
    }
