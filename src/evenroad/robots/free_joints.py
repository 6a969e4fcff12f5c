"""Joints with several coordinates, planar and floating, as joints with one each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.rotation import rotation_from_z
from evenroad.robots.joint import Joint

PLANAR = ("x", "y", "theta")
"""Coordinates of a planar joint, called as MoveIt does."""
FAR = 50.0
"""Limit of such a joint's slides where a scene has none [m]."""
_FLOATING = ("x", "y", "z", "yaw", "pitch", "roll")
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_AXES |= {"theta": _AXES["z"], "yaw": _AXES["z"], "pitch": _AXES["y"], "roll": _AXES["x"]}


def coordinates(kind: str, joint: Joint) -> list[Joint]:
    """Return the joints that stand for a ``planar`` or ``floating`` one of a URDF.

    A planar joint moves along x and y of a frame whose z axis is the joint's, and turns about it: ``base/x``,
    ``base/y``, ``base/theta``.  A floating one moves and turns along all axes: ``base/x`` to ``base/roll``.
    """
    names = PLANAR if kind == "planar" else _FLOATING
    turned = Pose((0.0, 0.0, 0.0), tuple(rotation_from_z(joint.axis).ravel().tolist()))
    # Its axis is z where the file gives none: a URDF's default, x, would let a base climb.
    frame = joint.origin @ turned if kind == "planar" else joint.origin
    links = [joint.parent, *(f"{joint.name}/{name}" for name in names[:-1]), joint.child]
    found = []
    for number, name in enumerate(names):
        at = frame if number == 0 else IDENTITY
        slides = name in ("x", "y", "z")
        found.append(
            replace(
                joint,
                name=f"{joint.name}/{name}",
                kind="prismatic" if slides else "continuous",
                parent=links[number],
                child=links[number + 1],
                xyz=at.xyz,
                rotation=at.rotation,
                axis=_AXES[name],
                lower=-FAR if slides else -math.inf,
                upper=FAR if slides else math.inf,
                of=joint.name,
            )
        )
    return found


def of_base(kind: str, name: str, parent: str, child: str) -> list[Joint]:
    """Return the joints of a planar joint in the x-y plane of its parent, or of a floating one."""
    joint = Joint(name, "fixed", parent, child, (0.0, 0.0, 0.0), IDENTITY.rotation)
    return coordinates(kind, joint)


def held_note(kind: str, name: str, joints: Sequence[Joint]) -> str:
    """Return the note about a planar or floating joint that is not planned for."""
    names = ", ".join(each.name for each in joints)
    said = f"joint {name!r} is {kind}: it is held at 0"
    return f"{said}; --group {name} plans for {names}, within {FAR:g} m or the limits of a scene"


def without_moved(notes: Sequence[str], joints: Sequence[Joint], group: Sequence[str]) -> tuple[str, ...]:
    """Return notes but those that hold a joint of which a group has coordinates."""
    moved = tuple(f"joint {joint.of!r} is " for joint in joints if joint.of and joint.name in group)
    return tuple(note for note in notes if not (moved and note.startswith(moved) and "it is held at 0" in note))


def named(joint: str, joints: Sequence[Joint]) -> list[str]:
    """Return the coordinates of a joint among those of a robot, in their order; none where it has only itself."""
    return [each.name for each in joints if each.of == joint]
