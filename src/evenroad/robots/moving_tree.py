"""MovingTree: a robot reduced to the frames that move when the planned joints do.

Fixed joints and held ones are folded into constants, mimics follow their joint, and every frame that is left
turns about, or slides along, its own z axis: one rule for all of them in the compiled code.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.rotation import rotation_from_z
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import Robot

Matrix = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MovingFrame:
    """A frame that a planned joint moves on its parent frame, about or along the frame's own z axis.

    Attributes
    ----------
    parent : int
        Number of the parent frame; 0 is the root link's, which does not move.
    rotation : ndarray, shape (3, 3)
        From this frame at value 0 to the parent frame.
    translation : ndarray, shape (3,)
        Origin of this frame at value 0 in the parent frame [m].
    slides : bool
        Whether it slides along z; else it turns about z.
    coordinate : int
        The coordinate of the configuration that moves it.
    multiplier, offset : float
        Its value is ``multiplier * coordinate + offset``.
    """

    parent: int
    rotation: Matrix
    translation: Matrix
    slides: bool
    coordinate: int
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class Placement:
    """The frame that a link is fixed to, by its number, and rotation (3, 3) and translation (3,) [m] into it."""

    frame: int
    rotation: Matrix
    translation: Matrix


@dataclass(frozen=True, eq=False)
class MovingTree:
    """Moving frames, parents first, and where the links are fixed to them.

    Attributes
    ----------
    frames : tuple of MovingFrame
        ``frames[i]`` has the number i + 1; number 0 is the root link's frame.
    links : mapping of str to Placement
        Of every link.
    """

    frames: tuple[MovingFrame, ...]
    links: dict[str, Placement]


def moving_tree(robot: Robot) -> MovingTree:
    """Return the frames of `robot` that the joints of its group move, and its links' places on them.

    Raises InvalidValue if a mimic follows itself, or a continuous joint at no whole multiple, or a number is not
    finite; and UnknownName if a mimic, the group or the held values name a joint that is not there.
    """
    joints = {joint.name: joint for joint in robot.joints}
    for name in (*robot.group, *robot.held):
        if name not in joints:
            raise UnknownName.among("joint", name, joints)
    frames: list[MovingFrame] = []
    links = {robot.links[0]: Placement(0, np.eye(3), np.zeros(3))}
    for joint in robot.joints:
        base = links[joint.parent]
        rotation = base.rotation @ np.array(joint.rotation).reshape(3, 3)
        translation = base.translation + base.rotation @ np.array(joint.xyz)
        coordinate, multiplier, offset = _value(joint, joints, robot)
        if not np.isfinite([*rotation.ravel(), *translation, multiplier, offset]).all():
            raise InvalidValue(f"joint {joint.name!r} must have finite numbers, got {joint!r}")
        if multiplier == 0.0 or joint.kind == "fixed":
            links[joint.child] = _moved(Placement(base.frame, rotation, translation), joint, offset)
            continue
        to_z = rotation_from_z(joint.axis)
        slides = joint.kind == "prismatic"
        frames.append(MovingFrame(base.frame, rotation @ to_z, translation, slides, coordinate, multiplier, offset))
        links[joint.child] = Placement(len(frames), to_z.T, np.zeros(3))
    return MovingTree(tuple(frames), links)


def _value(joint: Joint, joints: dict[str, Joint], robot: Robot) -> tuple[int, float, float]:
    """Return coordinate, multiplier and offset of a joint's value; the multiplier is 0 where it is constant."""
    multiplier, offset, follower = 1.0, 0.0, joint
    for _ in range(len(joints) + 1):
        if joint.kind == "fixed":
            return 0, 0.0, offset
        if joint.mimic is None:
            if joint.name in robot.group:
                _require_whole_turns(follower, joint, multiplier)
                return robot.group.index(joint.name), multiplier, offset
            return 0, 0.0, multiplier * held_values(robot)[joint.name] + offset
        offset += multiplier * joint.mimic.offset
        multiplier *= joint.mimic.multiplier
        if joint.mimic.joint not in joints:
            raise UnknownName.among("joint", joint.mimic.joint, joints)
        joint = joints[joint.mimic.joint]
    raise InvalidValue(f"joint {joint.name!r} mimics itself")


def _require_whole_turns(follower: Joint, joint: Joint, multiplier: float) -> None:
    """Refuse a mimic that is elsewhere after a full turn of the continuous joint that it follows."""
    if joint.kind == "continuous" and (follower.kind == "prismatic" or multiplier != round(multiplier)):
        raise InvalidValue(
            f"joint {follower.name!r} follows the continuous joint {joint.name!r}: it must turn, by a whole"
            f" multiple, got a {follower.kind} joint and {multiplier!r}"
        )


def _moved(placement: Placement, joint: Joint, value: float) -> Placement:
    """Return the place of the child of a joint that keeps one value."""
    if joint.kind == "fixed":
        return placement
    to_z = rotation_from_z(joint.axis)
    if joint.kind == "prismatic":
        translation = placement.translation + placement.rotation @ to_z[:, 2] * value
        return Placement(placement.frame, placement.rotation, translation)
    cosine, sine = math.cos(value), math.sin(value)
    about_z = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return Placement(placement.frame, placement.rotation @ to_z @ about_z @ to_z.T, placement.translation)
