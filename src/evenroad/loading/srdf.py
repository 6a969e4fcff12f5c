"""Reading an SRDF: groups, named states, and pairs of links that need no test."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree.ElementTree import Element

from evenroad._checks import require_known
from evenroad._understood import Kind, require_understood
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.loading.description import RobotDescription
from evenroad.loading.xml_file import read_xml
from evenroad.robots.free_joints import held_note, named, of_base
from evenroad.robots.joint import Joint

_NAMED = Kind(("name",))
_GROUP = Kind(
    ("name",),
    {
        **dict.fromkeys(("joint", "link", "group"), _NAMED),
        "chain": Kind(("base_link", "tip_link")),
    },
)
_PAIR = Kind(("link1", "link2"), harmless={"reason"})
_FILE = Kind(
    ("name",),
    {
        "group": _GROUP,
        "group_state": Kind(("name", "group"), {"joint": Kind(("name", "value"))}),
        "virtual_joint": Kind(("name", "type", "parent_frame", "child_link")),
        "passive_joint": _NAMED,
        "disable_collisions": _PAIR,
        "enable_collisions": _PAIR,
        "disable_default_collisions": Kind(("link",)),
    },
    # Hands and feet by their names, motors, and other bodies of links for other planners.
    harmless={
        *("version", "end_effector", "gripper", "rotor_params", "specificities", "joint_property"),
        "link_sphere_approximation",
    },
)
"""Elements and attributes of an SRDF that are read."""
_MOST_NAMED = 8
"""Largest number of names in one line."""


@dataclass(frozen=True)
class Srdf:
    """Groups, states and pairs of links that an SRDF adds to a URDF.

    `groups`, by name, are the joints that can be planned for, in the order of the URDF: those that move, by
    themselves, and are not `passive`, without a motor.  `states` are named states, (group, name) -> joint -> value
    [rad or m]; `disabled` are pairs of links that are not tested against each other.  `notes` say which joints and
    links it names that the URDF lacks; these are skipped.
    """

    groups: Mapping[str, tuple[str, ...]]
    states: Mapping[tuple[str, str], Mapping[str, float]]
    disabled: frozenset[frozenset[str]]
    passive: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()


def read_srdf(path: Path, urdf: RobotDescription) -> Srdf:
    """Read the SRDF that belongs to a URDF.

    Of a link whose collisions are off by default, ``disable_default_collisions``, no pair with another link is tested,
    unless ``enable_collisions`` names it and ``disable_collisions`` does not; obstacles are.

    Virtual joints, which tie the root to the world, are skipped in groups and states, too, unless the robot has them
    (:func:`with_moving_base`).  So are joints and links that this URDF lacks, as makers write one SRDF for several
    robots; the notes name them.  Raises BrokenFile if the file is missing, not XML or not an SRDF, an element lacks an
    attribute, or groups contain each other; UnknownName if it names a group that there is not; InvalidValue if a joint
    of a state has a value that is not a finite number.
    """
    root = read_xml(path, "SRDF", "an SRDF")
    if root.find("joint") is not None:
        raise BrokenFile(f"{path} is a URDF, not an SRDF: it has joints")
    notes: list[str] = []
    require_understood(root, _FILE, str(path), notes)
    elements: dict[str, Element] = {}
    for group in root.findall("group"):
        name = _attribute(group, "name", path)
        if name in elements and not _same(group, elements[name]):
            raise BrokenFile(f"{path} has two groups {name!r}, which differ")
        elements[name] = group
    virtual = frozenset(_attribute(joint, "name", path) for joint in root.findall("virtual_joint"))
    known = _Model(urdf, virtual)
    passive = frozenset(
        name for joint in root.findall("passive_joint") if known.joint(name := _attribute(joint, "name", path))
    )
    reader = _Groups(elements, known, path, {joint.child: joint for joint in urdf.joints})
    groups = {name: _in_order(reader.joints(name, ()) - passive, urdf) for name in elements}
    states: dict[tuple[str, str], dict[str, float]] = {}
    for state in root.findall("group_state"):
        if state.get("group") is None:
            # Kinova's own SRDF has one; nothing says which joints it is about.
            known.missing["state of no group"][_attribute(state, "name", path)] = None
            continue
        owner = _attribute(state, "group", path)
        require_known(f"group in {path}:", owner, groups)
        both, values = (owner, _attribute(state, "name", path)), _values(state, known, path)
        if states.setdefault(both, values) != values:
            raise BrokenFile(f"{path} has two states {both[1]!r} of the group {owner!r}, which differ")
    disabled = _pairs(root, "disable_collisions", known, path)
    by_default = [_attribute(each, "link", path) for each in root.findall("disable_default_collisions")]
    if by_default := [link for link in by_default if known.links([link])]:
        every = {frozenset((link, other)) for link in by_default for other in urdf.links if other != link}
        disabled |= every - _pairs(root, "enable_collisions", known, path)
        notes.append(
            "not tested against other links, only against obstacles, by disable_default_collisions:"
            f" {few_of(by_default)}"
        )
    return Srdf(groups, states, disabled, passive, (*known.notes, *notes))


def _pairs(root: Element, tag: str, known: _Model, path: Path) -> frozenset[frozenset[str]]:
    """Return the pairs of links that elements name."""
    pairs = [[_attribute(pair, end, path) for end in ("link1", "link2")] for pair in root.findall(tag)]
    return frozenset(frozenset(pair) for pair in pairs if known.links(pair))


def _same(first: Element, second: Element) -> bool:
    """Return whether two elements say the same."""
    said = [[(each.tag, each.attrib) for each in element.iter()] for element in (first, second)]
    return said[0] == said[1]


def with_moving_base(urdf: RobotDescription, srdf: Path) -> RobotDescription:
    """Return a robot whose root moves, in the plane or in all ways, where a virtual joint of its SRDF says so."""
    root = urdf.links[0]
    for element in read_xml(srdf, "SRDF", "an SRDF").findall("virtual_joint"):
        name, frame = element.get("name", ""), element.get("parent_frame", "world")
        kind = element.get("type", "")
        if kind not in ("planar", "floating") or element.get("child_link") != root or not name:
            continue
        joints = of_base(kind, name, frame if frame not in urdf.links else f"{name}/{frame}", root)
        if {name, *(joint.name for joint in joints)} & set(urdf.order):
            # The robot's own joint of that name is meant.
            continue
        links = (joints[0].parent, *(joint.child for joint in joints), *urdf.links[1:])
        order = (*(joint.name for joint in joints), *urdf.order)
        notes = (*urdf.notes, held_note(kind, name, joints))
        return replace(urdf, links=links, joints=(*joints, *urdf.joints), order=order, notes=notes)
    return urdf


def few_of(names: Sequence[str]) -> str:
    """Return the first names as a text of one line, and the number of others."""
    said = ", ".join(shown(name)[1:-1] for name in names[:_MOST_NAMED])
    return said if len(names) <= _MOST_NAMED else f"{said} and {len(names) - _MOST_NAMED} more"


_DEEPEST = 100
"""Largest number of groups of an SRDF inside of each other."""
_MISSING = {
    "joint": "joints that the robot lacks",
    "link": "links that the robot lacks",
    "state of no group": "states without a group",
}
"""Kinds of skipped names, in words."""


@dataclass(frozen=True)
class _Model:
    """Names of the URDF, and those of the SRDF that it lacks."""

    urdf: RobotDescription
    virtual: frozenset[str]
    missing: dict[str, dict[str, None]] = field(default_factory=lambda: defaultdict(dict))

    def joint(self, name: str) -> bool:
        """Return whether the URDF has a joint; a virtual one that it lacks is not noted."""
        return name not in self.virtual and self._has("joint", name, self.urdf.order)

    def links(self, names: Sequence[str]) -> bool:
        """Return whether the URDF has all of these links."""
        found = [self._has("link", name, self.urdf.links) for name in names]
        return all(found)

    @property
    def notes(self) -> tuple[str, ...]:
        """A line about each kind of skipped names, if there are any."""
        return tuple(
            f"the SRDF names {_MISSING[what]}, which are skipped: {few_of(list(names))}"
            for what, names in self.missing.items()
        )

    def _has(self, what: str, name: str, known: Collection[str]) -> bool:
        if name not in known:
            self.missing[what][name] = None
        return name in known


@dataclass(frozen=True)
class _Groups:
    elements: Mapping[str, Element]
    known: _Model
    path: Path
    by_child: Mapping[str, Joint]
    done: dict[str, set[str]] = field(default_factory=dict)

    def joints(self, name: str, inside: tuple[str, ...]) -> set[str]:
        """Return the joints of a group; `inside` are the groups that led to it.

        A group is read once: nested ones that repeat each other would be exponentially many.
        """
        if name in inside:
            raise BrokenFile(f"groups of {self.path} contain each other: {' -> '.join([*inside, name])}")
        if len(inside) > _DEEPEST:
            raise BrokenFile(f"groups of {self.path} are nested more than {_DEEPEST} deep")
        if name not in self.done:
            self.done[name] = self._read(name, inside)
        return self.done[name]

    def _read(self, name: str, inside: tuple[str, ...]) -> set[str]:
        by_child, found = self.by_child, set[str]()
        require_known(f"group in {self.path}:", name, self.elements)
        for part in self.elements[name]:
            if part.tag == "joint":
                joint = _attribute(part, "name", self.path)
                found.update(named(joint, self.known.urdf.joints) or ([joint] if self.known.joint(joint) else []))
            elif part.tag == "link":
                link = _attribute(part, "name", self.path)
                found.update([by_child[link].name] if self.known.links([link]) and link in by_child else [])
            elif part.tag == "chain":
                base_and_tip = [_attribute(part, end, self.path) for end in ("base_link", "tip_link")]
                if self.known.links(base_and_tip):
                    found.update(self._chain(base_and_tip[0], base_and_tip[1], by_child))
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


def _values(state: Element, known: _Model, path: Path) -> dict[str, float]:
    values = {}
    for joint in state.findall("joint"):
        name = _attribute(joint, "name", path)
        # MoveIt writes the coordinates of a planar joint as one text.
        several, numbers = named(name, known.urdf.joints), _attribute(joint, "value", path).split()
        if len(several) != len(numbers):
            if not known.joint(name):
                continue
            several, numbers = [name], [" ".join(numbers)]
        for each, text in zip(several, numbers, strict=True):
            try:
                values[each] = float(text)
            except ValueError:
                values[each] = math.nan
            if not math.isfinite(values[each]):
                raise InvalidValue(f"joint {each!r} of a state in {path} must be a finite number, got {text!r}")
    return values


def _in_order(names: set[str], urdf: RobotDescription) -> tuple[str, ...]:
    free = names & urdf.free
    return tuple(name for name in urdf.order if name in free)


def _attribute(element: Element, name: str, path: Path) -> str:
    value = element.get(name)
    if not value:
        raise BrokenFile(f"<{element.tag}> in {path} lacks {name!r}")
    return value
