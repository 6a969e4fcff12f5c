"""RobotDescription: what the file of a robot says, as a tree of links and joints."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from evenroad.errors import BrokenFile
from evenroad.geometry.shapes import Shape
from evenroad.robots.joint import Joint, with_direct_mimics, within_limits_of_mimics
from evenroad.robots.planes import Plane

_ANY = 1000.0
"""A range of more than this is that of a joint without limits [rad or m]."""
_MOST_LINKS, _MOST_BODIES = 1000, 500
"""Largest number of links of a robot, and of those with bodies: each pair of these is looked at."""


@dataclass(frozen=True)
class RobotDescription:
    """A robot as its file describes it: motion and collision.

    The root is the first of the `links`, and every parent comes before its children; ``joints[i]`` is the joint whose
    child is ``links[i + 1]``, and a mimic follows a joint that is no mimic, with limits that keep the mimic within its
    own.  `order` are the joints' names as the file lists them: the order of configurations.  `shapes` are the collision
    geometry, each in its link's frame; `drawn_only` are links that are drawn and have none; `notes` say what was read
    otherwise than it stands in the file.  `untested` are pairs of links that the file itself lets touch, each with the
    reason; None where it does not say, as no URDF does.  `planes` are half spaces that it has around the robot, and
    `states` are named states of an MJCF, joint -> value [rad or m].
    """

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    order: tuple[str, ...]
    shapes: tuple[Shape, ...]
    drawn_only: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    untested: tuple[tuple[str, str, str], ...] | None = None
    planes: tuple[Plane, ...] = ()
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def free(self) -> frozenset[str]:
        """Joints that move by themselves: neither fixed nor mimics, nor locked by equal limits, nor slides without."""
        return frozenset(
            joint.name
            for joint in self.joints
            if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper
            if joint.kind != "prismatic" or joint.upper - joint.lower <= _ANY
        )


def require_few_links(links: int, bodies: int, path: Path) -> None:
    """Raise BrokenFile for a robot with too many links: their pairs would take minutes and gigabytes."""
    if links > _MOST_LINKS or bodies > _MOST_BODIES:
        allowed = (
            f"a robot may have {_MOST_LINKS}, {_MOST_BODIES} of them with bodies; a scene may include larger files"
        )
        raise BrokenFile(f"{path} has {links} links, {bodies} of them with bodies: {allowed}")


def as_tree(
    name: str,
    links: Sequence[str],
    joints: Sequence[Joint],
    shapes: Sequence[Shape],
    where: str,
    drawn_only: tuple[str, ...],
    notes: list[str],
) -> RobotDescription:
    """Return a robot as the tree that its links and joints, in the file's order, form; `where` names the file."""
    ordered = in_tree_order(links, [_without_end(joint, notes) for joint in joints], where)
    return RobotDescription(
        name,
        links=(ordered[0].parent if ordered else links[0], *(joint.child for joint in ordered)),
        joints=tuple(within_limits_of_mimics(with_direct_mimics(ordered, where))),
        order=tuple(joint.name for joint in joints),
        shapes=tuple(shapes),
        drawn_only=drawn_only,
        notes=tuple(notes),
    )


def _without_end(joint: Joint, notes: list[str]) -> Joint:
    """Return a joint that turns on for ever where its limits are as good as none; what is done with it is noted."""
    if not joint.upper - joint.lower > _ANY or joint.kind == "continuous":
        return joint
    said = f"joint {joint.name!r} with the limits {joint.lower:g}, {joint.upper:g}"
    if joint.kind == "revolute":
        notes.append(f"{said} turns without end")
        return replace(joint, kind="continuous", lower=-math.inf, upper=math.inf, hard=None)
    notes.append(f"{said} slides without end: it is held, unless a scene limits it and --group names it")
    return joint


def in_tree_order(links: Sequence[str], joints: Sequence[Joint], where: str) -> list[Joint]:
    """Return the joints so that every joint's parent is the root or the child of an earlier one.

    Depth first, children in the order given. `where` names the file in errors.  Raises BrokenFile if links or joints
    share a name, a joint joins links that there are not, a link has two parents, there is more than one root, or the
    joints form a cycle; the text names them.
    """
    _require_distinct("link", links, where)
    _require_distinct("joint", (joint.name for joint in joints), where)
    parent_joint: dict[str, Joint] = {}
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                said = f"joint {joint.name!r} in {where} has the {role} {link!r}, which is no link"
                raise BrokenFile(f"{said}; links: {', '.join(links)}")
        if joint.child in parent_joint:
            raise BrokenFile(
                f"link {joint.child!r} in {where} hangs on two joints,"
                f" {parent_joint[joint.child].name!r} and {joint.name!r}: the links must form a tree"
            )
        parent_joint[joint.child] = joint
    roots = [link for link in links if link not in parent_joint]
    if len(roots) > 1:
        raise BrokenFile(f"{where} has more than one root: no joint leads to {', '.join(map(repr, roots))}")
    children: dict[str, list[Joint]] = {link: [] for link in links}
    for joint in joints:
        children[joint.parent].append(joint)
    ordered: list[Joint] = []
    pending = list(reversed(children[roots[0]])) if roots else []
    while pending:
        joint = pending.pop()
        ordered.append(joint)
        pending.extend(reversed(children[joint.child]))
    if len(ordered) < len(joints):
        reached = {joint.name for joint in ordered}
        start = next(joint for joint in joints if joint.name not in reached)
        raise BrokenFile(f"the joints of {where} form a cycle: {' -> '.join(_cycle(start, parent_joint))}")
    return ordered


def _cycle(joint: Joint, parent_joint: dict[str, Joint]) -> list[str]:
    """Return the names along the cycle that one comes to by going up from `joint`."""
    above = [joint]
    while parent_joint[above[-1].parent] not in above:
        above.append(parent_joint[above[-1].parent])
    closing = parent_joint[above[-1].parent]
    names = [each.name for each in above[above.index(closing) :]]
    return [closing.name, *reversed(names)]


def _require_distinct(what: str, names: Iterable[str], where: str) -> None:
    name, count = max(Counter(names).items(), key=lambda item: item[1], default=("", 1))
    if count > 1:
        raise BrokenFile(f"{where} has more than one {what} named {name!r}")
