"""HeldObject: a body that a link carries for a while, as a gripper carries a box."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.fit import fit_capsules
from evenroad.geometry.hulls import Hull, piece_of
from evenroad.geometry.inner import inner_of
from evenroad.geometry.parts import Parts, parts_of
from evenroad.geometry.pose import IDENTITY
from evenroad.geometry.shapes import Capsule, Shape
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import KinematicTree
from evenroad.robots.pairs import bodied_above, rigid_links


@dataclass(frozen=True)
class HeldObject:
    """A body that a link carries.

    Parameters
    ----------
    name : str
        Its name in messages.  It becomes a link of the robot, with the body's own frame: goal poses may be of it.
    body : Shape
        The body, with its pose in the frame of the link that carries it.
    link : str
        The link that carries it.
    touches : sequence of str
        Links that it may touch, such as fingers.  Links that no joint moves against `link` are never tested.
    """

    name: str
    body: Shape
    link: str
    touches: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.body, Shape):
            raise InvalidValue(f"what is held must be a Shape, got {shown(self.body)}")
        if not self.name or not isinstance(self.name, str):
            raise InvalidValue(f"what is held must have a name, got {self.name!r}")
        touches = (self.touches,) if isinstance(self.touches, str) else tuple(self.touches)
        object.__setattr__(self, "touches", touches)
        object.__setattr__(self, "body", replace(self.body, link=self.name))


class HeldParts(NamedTuple):
    """The parts that a held body adds to a robot."""

    joint: Joint
    capsules: tuple[Capsule, ...]
    hull: Hull
    pairs: tuple[tuple[str, str], ...]
    inner: tuple[Capsule, ...] | None
    shapes: tuple[Parts, ...]


def held_parts(robot: KinematicTree, held: HeldObject, *, neighbours: bool) -> HeldParts:
    """Return the parts that a held body adds to a robot; it is tested against all links that may come near.

    Allowed contacts are not tested.  Where pairs were computed and not given, neighbours in the tree are not tested, as
    for the robot itself.  Raises UnknownName if a link does not exist, InvalidValue if the name is taken.
    """
    what = f"link of the robot that holds {held.name!r}:"
    for link in (held.link, *held.touches):
        require_known(what, link, robot.links)
    name = f"{held.link}-{held.name}"
    if held.name in robot.links or name in [joint.name for joint in robot.joints]:
        raise InvalidValue(f"{held.name!r} is a link already: nothing can be attached twice under one name")
    pose, body = held.body.pose, replace(held.body, pose=IDENTITY)
    joint = Joint(name, "fixed", held.link, held.name, pose.xyz, pose.rotation)
    rigid = rigid_links(robot)
    bodied = {capsule.link for capsule in robot.capsules}
    spared = {*held.touches, *(link for link in bodied if rigid[link] == rigid[held.link])}
    if neighbours:
        above, joints = (held.link, 0) if held.link in bodied else bodied_above(robot, bodied)[held.link]
        if joints == 1:
            spared.add(above)
    pairs = tuple((link, held.name) for link in robot.links if link in bodied - spared)
    return HeldParts(joint, fit_capsules(body), piece_of(body).hull, pairs, inner_of([body]), parts_of([body]))


def same_bodies(robot: KinematicTree, held: HeldObject) -> bool:
    """Return whether the object that a robot holds under this name is this one."""
    pose, body = held.body.pose, replace(held.body, pose=IDENTITY)
    joint = next(joint for joint in robot.joints if joint.child == held.name)
    capsules = tuple(capsule for capsule in robot.capsules if capsule.link == held.name)
    return (joint.parent, joint.origin, capsules) == (held.link, pose, fit_capsules(body))


def inner_of_both(
    ours: tuple[Capsule, ...] | None,
    capsules: tuple[Capsule, ...],
    theirs: tuple[Capsule, ...] | None,
    their_capsules: tuple[Capsule, ...],
) -> tuple[Capsule, ...] | None:
    """Return the inner capsules of a robot and of what is fixed to it, see `Robot.inner`."""
    if ours is None and theirs is None:
        return None
    return (*(capsules if ours is None else ours), *(their_capsules if theirs is None else theirs))
