"""SRDFs: groups, named states, pairs of links that need no test; which joints are planned for; and writing one."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from evenroad._checks import require_known
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.robot.joint import Joint
from evenroad.robot.pairs import TOUCHING
from evenroad.robot.robot import Robot, RobotModel
from evenroad.robot.urdf import Urdf
from evenroad.robot.urdf_xml import read_xml


@dataclass(frozen=True)
class Srdf:
    """What an SRDF adds to a URDF.

    `groups`, by name, are the joints that can be planned for, in the order of the URDF: those that move, by
    themselves, and are not `passive`, without a motor.  `states` are named states, (group, name) -> joint -> value
    [rad or m]; `disabled` are pairs of links that are not tested against each other.
    """

    groups: Mapping[str, tuple[str, ...]]
    states: Mapping[tuple[str, str], Mapping[str, float]]
    disabled: frozenset[frozenset[str]]
    passive: frozenset[str] = frozenset()


def read_srdf(path: Path, urdf: Urdf) -> Srdf:
    """Read the SRDF that belongs to a URDF; what has to do with neither groups, states nor pairs is skipped.

    Virtual joints, which tie the root to the world, are skipped in groups and states, too: no URDF has them.  Raises
    BrokenFile if the file is missing, not XML or not an SRDF, an element lacks an attribute, or groups contain each
    other; UnknownName if it names a joint, link or group that there is not; InvalidValue if a joint of a state has a
    value that is not a finite number.
    """
    root = read_xml(path, "SRDF", "an SRDF")
    if root.find("joint") is not None:
        raise BrokenFile(f"{path} is a URDF, not an SRDF: it has joints")
    elements = {_attribute(group, "name", path): group for group in root.findall("group")}
    virtual = frozenset(_attribute(joint, "name", path) for joint in root.findall("virtual_joint"))
    passive = frozenset(
        _known("joint", _attribute(joint, "name", path), urdf.order, path)
        for joint in root.findall("passive_joint")
        # A virtual joint may be passive, too.
        if joint.get("name") not in virtual
    )
    reader = _Groups(elements, virtual, urdf, path)
    groups = {name: _in_order(reader.joints(name, ()) - passive, urdf) for name in elements}
    states = {}
    for state in root.findall("group_state"):
        group = _known("group", _attribute(state, "group", path), groups, path)
        states[group, _attribute(state, "name", path)] = _values(state, virtual, urdf, path)
    disabled = frozenset(
        frozenset(_known("link", _attribute(pair, end, path), urdf.links, path) for end in ("link1", "link2"))
        for pair in root.findall("disable_collisions")
    )
    return Srdf(groups, states, disabled, passive)


@dataclass(frozen=True)
class _Groups:
    elements: Mapping[str, Element]
    virtual: frozenset[str]
    urdf: Urdf
    path: Path

    def joints(self, name: str, inside: tuple[str, ...]) -> set[str]:
        """Return the joints of a group; `inside` are the groups that led to it."""
        if name in inside:
            raise BrokenFile(f"groups of {self.path} contain each other: {' -> '.join([*inside, name])}")
        by_child = {joint.child: joint for joint in self.urdf.joints}
        found: set[str] = set()
        for part in self.elements[_known("group", name, self.elements, self.path)]:
            if part.tag == "joint" and part.get("name") not in self.virtual:
                found.add(self._part(part, "joint", "name", self.urdf.order))
            elif part.tag == "link":
                link = self._part(part, "link", "name", self.urdf.links)
                found.update([by_child[link].name] if link in by_child else [])
            elif part.tag == "chain":
                base = self._part(part, "link", "base_link", self.urdf.links)
                tip = self._part(part, "link", "tip_link", self.urdf.links)
                found.update(self._chain(base, tip, by_child))
            elif part.tag == "group":
                found |= self.joints(_attribute(part, "name", self.path), (*inside, name))
        return found

    def _chain(self, base: str, tip: str, by_child: Mapping[str, Joint]) -> list[str]:
        names, link = [], tip
        while link != base:
            if link not in by_child:
                raise BrokenFile(f"the chain in {self.path}: {tip!r} does not hang on {base!r}")
            names.append(by_child[link].name)
            link = by_child[link].parent
        return names

    def _part(self, part: Element, what: str, attribute: str, known: Collection[str]) -> str:
        return _known(what, _attribute(part, attribute, self.path), known, self.path)


def _values(state: Element, virtual: frozenset[str], urdf: Urdf, path: Path) -> dict[str, float]:
    values = {}
    for joint in state.findall("joint"):
        name = _attribute(joint, "name", path)
        if name in virtual:
            continue
        _known("joint", name, urdf.order, path)
        text = _attribute(joint, "value", path)
        try:
            values[name] = float(text)
        except ValueError:
            values[name] = math.nan
        if not math.isfinite(values[name]):
            raise InvalidValue(f"joint {name!r} of a state in {path} must be a finite number, got {text!r}")
    return values


def _in_order(names: set[str], urdf: Urdf) -> tuple[str, ...]:
    free = names & urdf.free
    return tuple(name for name in urdf.order if name in free)


def _attribute(element: Element, name: str, path: Path) -> str:
    value = element.get(name)
    if not value:
        raise BrokenFile(f"<{element.tag}> in {path} lacks {name!r}")
    return value


def _known(what: str, name: str, known: Collection[str], path: Path) -> str:
    require_known(f"{what} in {path}:", name, known)
    return name


def choose_group(urdf: Urdf, srdf: Srdf | None, wanted: str | Sequence[str] | None) -> tuple[str, ...]:
    """Return the joints that are planned for.

    `wanted` are groups of the SRDF and names of joints (as a text: with commas between them), in the order that is
    wanted; of two groups that share a joint the first has it.  None: the SRDF's group where it has one, else every
    joint that moves, is no mimic and, by the SRDF, not passive.  None of a rigid body: another robot may carry it as a
    tool.  Raises UnknownName if there is no such group or joint; InvalidValue if the SRDF has several groups and none
    is wanted, a joint does not move or follows another, one is named twice, or no joint is left.
    """
    groups = {} if srdf is None else srdf.groups
    if wanted is not None:
        words = _words(wanted)
        if groups and words and not set(words) & {*urdf.order, *groups}:
            raise UnknownName.among("group", ",".join(words), groups)
        chosen: list[str] = []
        for word in words:
            if word in groups:
                own = _not_empty(groups[word], f"group {word!r}")
                chosen += [name for name in own if name not in chosen]
            else:
                _require_movable(urdf, word, chosen)
                chosen.append(word)
        return _not_empty(tuple(chosen), "the group")
    if len(groups) > 1:
        raise InvalidValue(f"the SRDF has several groups, say which one is planned for: {', '.join(groups)}")
    if groups:
        ((name, joints),) = groups.items()
        return _not_empty(joints, f"group {name!r}")
    if all(joint.kind == "fixed" for joint in urdf.joints):
        return ()
    free = urdf.free - (frozenset() if srdf is None else srdf.passive)
    said = "".join(f"; {note}" for note in urdf.notes if note.startswith("joint"))
    return _not_empty(tuple(name for name in urdf.order if name in free), f"robot {urdf.name!r}", said)


def chosen_states(
    srdf: Srdf, chosen: tuple[str, ...], wanted: str | Sequence[str] | None
) -> dict[str, dict[str, float]]:
    """Return the named states that give a value to every joint chosen: of two of a name, that of the groups wanted."""
    mine = _words(wanted or ())

    def strangeness(group_and_name: tuple[str, str]) -> tuple[bool, bool]:
        group, _ = group_and_name
        return group not in mine, srdf.groups[group] != chosen

    found: dict[str, dict[str, float]] = {}
    together: dict[str, dict[str, float]] = {}
    for group, name in sorted(srdf.states, key=strangeness):
        values = dict(srdf.states[group, name])
        if group in mine:
            # Two arms at home are so, each by the state of its own group.
            values = together[name] = values | together.get(name, {})
        if set(chosen) <= set(values):
            found.setdefault(name, values)
    return found


def _words(wanted: str | Sequence[str]) -> list[str]:
    words = wanted.split(",") if isinstance(wanted, str) else wanted
    return [word.strip() for word in words if word.strip()]


def _require_movable(urdf: Urdf, name: str, others: Sequence[str]) -> None:
    """Raise unless a joint that was named can be planned for beside others."""
    joints = {joint.name: joint for joint in urdf.joints}
    if name not in joints:
        movable = [each.name for each in urdf.joints if each.kind != "fixed" and each.mimic is None]
        raise UnknownName.among("joint of the group", name, movable)
    joint = joints[name]
    if joint.mimic is not None:
        raise InvalidValue(f"joint {name!r} cannot be planned for: it follows {joint.mimic.joint!r}")
    if joint.kind == "fixed":
        raise InvalidValue(f"joint {name!r} cannot be planned for: it is fixed")
    if name in others:
        raise InvalidValue(f"joint {name!r} is named twice in the group")


def _not_empty(joints: tuple[str, ...], what: str, said: str = "") -> tuple[str, ...]:
    if not joints:
        raise InvalidValue(f"{what} has no joint that could be planned for{said}")
    return joints


_REASONS = {"neighbours": "Adjacent", TOUCHING: "Always", "fixed to each other": "Never moves"}
"""Why a pair is not tested, in MoveIt's words where it has such."""


def srdf_text(model: RobotModel) -> str:
    """Return an SRDF of a robot: groups, named states, and the pairs that are not tested, each with the reason.

    Groups are the robot's chains without a branch, each named after the link at its end, and the group that the robot
    has where it is none of these.  Every group has a state ``home``, at 0 or the nearest to it within limits, beside
    the states that are known.  Read again with this file, the robot tests the same pairs.
    """
    robot = model.robot
    root = ElementTree.Element("robot", name=robot.name)
    groups = chains(robot)
    for name, joints in groups.items():
        group = ElementTree.SubElement(root, "group", name=name)
        ElementTree.SubElement(group, "chain", base_link=joints[0].parent, tip_link=joints[-1].child)
    names = {name: tuple(joint.name for joint in joints) for name, joints in groups.items()}
    if robot.group and robot.group not in names.values():
        names["planned"] = robot.group
        group = ElementTree.SubElement(root, "group", name="planned")
        for joint in robot.group:
            ElementTree.SubElement(group, "joint", name=joint)
    neutral = {joint.name: joint.neutral for joint in robot.joints}
    for name, members in names.items():
        for state, values in ({"home": neutral} | dict(robot.states)).items():
            if set(members) <= set(values):
                element = ElementTree.SubElement(root, "group_state", name=state, group=name)
                for joint in members:
                    ElementTree.SubElement(element, "joint", name=joint, value=repr(float(values[joint])))
    for first, second, why in model.dropped:
        reason = _REASONS.get(why, why)
        ElementTree.SubElement(root, "disable_collisions", link1=first, link2=second, reason=reason)
    ElementTree.indent(root)
    return '<?xml version="1.0"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def chains(robot: Robot) -> dict[str, list[Joint]]:
    """Return the runs of joints that move by themselves, one after the other without a branch, by their last link.

    A joint that others mimic is that of a gripper, and begins a run.
    """
    free = {
        joint.child: joint
        for joint in robot.joints
        if joint.kind != "fixed" and joint.mimic is None and joint.lower < joint.upper
    }
    parent = {joint.child: joint.parent for joint in robot.joints}
    followers: dict[str | None, list[Joint]] = {}
    for joint in free.values():
        above: str | None = joint.parent
        while above is not None and above not in free:
            above = parent.get(above)
        followers.setdefault(above, []).append(joint)
    leaders = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    following = {
        many[0].name: above
        for above, many in followers.items()
        if above is not None and len(many) == 1 and many[0].name not in leaders
    }
    runs: dict[str, list[Joint]] = {}
    for joint in free.values():
        # Every joint comes after the one that it follows.
        above = following.get(joint.name)
        run = [] if above is None else runs.pop(above)
        runs[joint.child] = [*run, joint]
    return runs
