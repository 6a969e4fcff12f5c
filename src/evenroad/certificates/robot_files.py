"""The files of a robot that a certificate is about, and what they say: read once for many certificates."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

from evenroad.certificates.claim import Claimed, Links, neighbours, tree_of
from evenroad.certificates.plain import plain_robot, plain_srdf
from evenroad.certificates.sources import MESHES, RobotFiles, Sources, digest_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Mesh
from evenroad.loading.cache import Remembered, stamps
from evenroad.loading.load import read_robot
from evenroad.loading.srdf import read_srdf, with_moving_base
from evenroad.robots.kinematics import held_values
from evenroad.robots.robot import Robot

_ODD_XML = re.compile(
    rb"<xacro:|<!DOCTYPE|<!ENTITY|encoding=[\"'](?!utf-8)|\b(?:xyz|rpy|size|scale)\s*=\s*[\"'][^\"']*,", re.IGNORECASE
)
"""What a checker does not read, and evenroad does: numbers with commas between them, too."""


class ReadRobot:
    """A robot as its files say it, for one group of joints."""

    def __init__(self, sources: Sources, group: tuple[str, ...]) -> None:
        urdf = read_robot(sources.file)
        if sources.srdf is not None and not set(group) <= set(urdf.order):
            urdf = with_moving_base(urdf, sources.srdf)
        if missing := set(group) - set(urdf.order):
            raise InvalidValue(f"joint {min(missing)!r} is none of the robot {sources.robot.name}: it is another robot")
        self.urdf, self.data = urdf, sources.robot.read_bytes()
        self.meshes = [shape.source for shape in urdf.shapes if isinstance(shape, Mesh)]
        self.srdf = None if sources.srdf is None else sources.srdf.read_bytes()
        self.disabled = None if sources.srdf is None else read_srdf(sources.srdf, urdf).disabled
        self._sources = sources
        self._files: dict[object, RobotFiles] = {}
        self._links: dict[object, Links] = {}

    def links(self, claimed: Claimed) -> Links:
        """Return the links as claims have them, of the same joints at the same values the same ones."""
        key = claimed.joints, tuple(claimed.held.items())
        if key not in self._links:
            self._links.setdefault(key, Links(self.urdf, tree_of(self.urdf, claimed)))
        return self._links[key]

    def files(self, world: ArmWorld) -> RobotFiles:
        """Return the files of the robot that plans in a world.

        A URDF stays as it is.  Another file, a base that the SRDF moves, and a robot without an SRDF of which pairs of
        links are not tested, become a plain URDF and an SRDF, which the certificate carries.
        """
        robot = world.robot
        held = frozenset(name for name, value in held_values(robot).items() if value != 0.0)
        bodied = tuple(dict.fromkeys(each.link for each in robot.capsules))
        # Where an SRDF disables pairs, the rest of the robot does not count.
        key = held, None if self.disabled else (robot.pairs, robot.holds, bodied)
        if key not in self._files:
            self._files.setdefault(key, self._files_of(world, held, bodied))
        return self._files[key]

    def _files_of(self, world: ArmWorld, held: frozenset[str], bodied: tuple[str, ...]) -> RobotFiles:
        said = self.disabled
        untested = frozenset[frozenset[str]]() if said else _untested(world.robot, bodied)
        if untested <= neighbours(self.urdf, {shape.link for shape in self.urdf.shapes}):
            untested = frozenset()
        if self._is_plain({*world.robot.group, *held}) and not untested:
            return self._as_it_is(self.srdf, said)
        text, meshes_of = plain_robot(self.urdf)
        srdf = self.srdf if said and self.srdf else plain_srdf(self.urdf.name, untested)
        return RobotFiles((text, srdf, *meshes_of), digest_of(self.data), said or untested or None)

    def without_srdf(self, named: set[str]) -> RobotFiles:
        """Return the files of the robot, for a certificate that names some joints, and to which no SRDF matters."""
        if self._is_plain(named):
            return self._as_it_is(None, None)
        text, meshes_of = plain_robot(self.urdf)
        return RobotFiles((text, b"", *meshes_of), digest_of(self.data))

    def _as_it_is(self, srdf: bytes | None, said: frozenset[frozenset[str]] | None) -> RobotFiles:
        embed = self._sources.embed
        meshes = [each.read_bytes() for each in self.meshes if isinstance(each, Path)]
        of_pairs = [srdf or b""] if embed or srdf is not None else []
        return RobotFiles((self.data, *of_pairs, *meshes), digest_of(self.data) if embed else None, said)

    def _is_plain(self, named: set[str]) -> bool:
        """Return whether a checker reads the file of the robot as it is, in a certificate that names some joints."""
        sources, coordinates = self._sources, {joint.name for joint in self.urdf.joints if joint.of}
        return (
            sources.robot.suffix == ".urdf"
            and not (sources.use_visuals or sources.upright_meshes)
            and not _ODD_XML.search(self.data)
            and _is_xml(self.data)
            and not coordinates & named
            and all(isinstance(each, Path) and each.suffix.lower() in MESHES for each in self.meshes)
        )


def _is_xml(data: bytes) -> bool:
    """Return whether a file is XML for any reader: evenroad also takes names with a prefix that is not declared."""
    try:
        ET.fromstring(data)
    except ET.ParseError:
        return False
    return True


_read: Remembered[ReadRobot] = Remembered(16)


def read_robot_files(sources: Sources, world: ArmWorld) -> ReadRobot:
    """Return the robot of some files that plans in a world, the same until a file is saved again."""
    asked = sources.file, sources.srdf, sources.embed, world.robot.group
    found = _read.get(asked)
    if found is None:
        before = stamps((sources.robot, sources.srdf))
        found = ReadRobot(sources, world.robot.group)
        _read.keep(asked, before | stamps(found.meshes), found)
    return found


def _untested(robot: Robot, bodied: tuple[str, ...]) -> frozenset[frozenset[str]]:
    """Return pairs of links with bodies, which planned joints move against each other, that a robot does not test."""
    tested, first = {frozenset(pair) for pair in robot.pairs}, {robot.links[0]: robot.links[0]}
    for joint in robot.joints:
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        first[joint.child] = joint.child if leader in robot.group else first[joint.parent]
    links = [link for link in bodied if link not in robot.holds]
    pairs = (frozenset((a, b)) for i, a in enumerate(links) for b in links[i + 1 :] if first[a] != first[b])
    return frozenset(pair for pair in pairs if pair not in tested)
