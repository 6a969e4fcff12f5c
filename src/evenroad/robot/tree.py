"""The tree that the joints of a robot make, or what keeps them from being one."""

from __future__ import annotations

from collections.abc import Sequence

from evenroad.errors import BrokenFile
from evenroad.robot.joint import Joint


def in_tree_order(links: Sequence[str], joints: Sequence[Joint], where: str) -> list[Joint]:
    """Return the joints so that every joint's parent is the root or the child of an earlier one.

    Depth first, children in the order given.  `where` names the file in errors.

    Raises
    ------
    BrokenFile
        If links or joints share a name, a joint joins links that there are not, a link has two parents, there
        is more than one root, or the joints form a cycle; the text names them.
    """
    _require_distinct("link", list(links), where)
    _require_distinct("joint", [joint.name for joint in joints], where)
    parent_joint: dict[str, Joint] = {}
    for joint in joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in links:
                raise BrokenFile(
                    f"joint {joint.name!r} in {where} has the {role} {link!r}, which is no link; "
                    f"links: {', '.join(links)}"
                )
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


def _require_distinct(what: str, names: list[str], where: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise BrokenFile(f"{where} has more than one {what} named {name!r}")
