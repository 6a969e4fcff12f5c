"""The files that a certificate is about: a robot's and a scene's as they are, or plain ones that it carries."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict, Unpack

from evenroad._yaml import read_mapping
from evenroad.certificates.claim import neighbours
from evenroad.certificates.plain import plain_robot, plain_scene, plain_srdf
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import PRIMITIVES, Mesh
from evenroad.loading.description import RobotDescription
from evenroad.loading.find import find_robot
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.srdf import read_srdf, with_moving_base
from evenroad.robots.kinematics import held_values
from evenroad.scenes.robot_in_scene import in_scene, scene_around
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import find_scene, load_scene

PathLike = str | os.PathLike[str]
_SECTIONS = {"obstacles", "allowed", "states", "limits", "attach", "name"}
_MESHES = {".stl", ".obj", ".dae"}
_ODD_XML = re.compile(rb"<xacro:|<!DOCTYPE|<!ENTITY|encoding=[\"'](?!utf-8)", re.IGNORECASE)
_ODD_YAML = re.compile(r"\t|^%|(?:^|[:,\-\[{]\s)\s*[&*!|>]", re.MULTILINE)


class Reading(TypedDict, total=False):
    """What else than names `Sources` have."""

    embed: bool
    packages: Mapping[str, PathLike]
    arguments: Mapping[str, str]
    use_visuals: bool
    upright_meshes: bool


@dataclass(frozen=True)
class Sources:
    """Names of the files that a certificate is to be about, and how the robot's is read, as :class:`RobotFile` says.

    Without a `scene` the certificate carries that of the plan; with `embed` it carries all.
    """

    robot: Path
    scene: Path | None = None
    srdf: Path | None = None
    embed: bool = False
    packages: Mapping[str, PathLike] = field(default_factory=dict)
    arguments: Mapping[str, str] = field(default_factory=dict)
    use_visuals: bool = False
    upright_meshes: bool = False

    @classmethod
    def named(
        cls, robot: PathLike, scene: PathLike | None, srdf: PathLike | None = None, **reading: Unpack[Reading]
    ) -> Sources:
        """Return the files of a robot and a scene, which may be the names of shipped ones."""
        path, own = find_robot(robot)
        found = None if scene is None else find_scene(scene)
        return cls(path, found, own if srdf is None else Path(srdf), **reading)

    @property
    def file(self) -> RobotFile:
        """The robot's file, and how it is read."""
        packages = tuple((name, os.fspath(folder)) for name, folder in sorted(self.packages.items()))
        arguments = tuple(sorted(self.arguments.items()))
        return RobotFile(self.robot, self.use_visuals, packages, arguments, upright_meshes=self.upright_meshes)


@dataclass(frozen=True)
class Files:
    """The files of a robot, or of a scene, in the order in which a checker reads them.

    A certificate that carries them names the digest of the file `made_of` which they were made, or ``-``.
    """

    contents: tuple[bytes, ...]
    made_of: str | None = None

    @property
    def carried(self) -> bool:
        """Whether the certificate carries them."""
        return self.made_of is not None


@dataclass(frozen=True)
class RobotFiles(Files):
    """Those of a robot, and the pairs of links that they let touch, None where they say nothing."""

    disabled: frozenset[frozenset[str]] | None = None


@dataclass(frozen=True)
class SceneFiles(Files):
    """Those of a scene, and which of its meshes stand for their hulls."""

    convex: frozenset[str] = frozenset()


def robot_files(sources: Sources, world: ArmWorld) -> tuple[RobotFiles, RobotDescription]:
    """Return the files of a robot that plans in a world, and what they say.

    A URDF stays as it is.  Another file, a base that the SRDF moves, and a robot without an SRDF of which pairs of
    links are not tested, become a plain URDF and an SRDF, which the certificate carries.
    """
    urdf = read_robot(sources.file)
    if sources.srdf is not None and not set(world.robot.group) <= set(urdf.order):
        urdf = with_moving_base(urdf, sources.srdf)
    if missing := set(world.robot.group) - set(urdf.order):
        raise InvalidValue(f"joint {min(missing)!r} is none of the robot {sources.robot.name}: it is another robot")
    said = None if sources.srdf is None else read_srdf(sources.srdf, urdf).disabled
    untested = frozenset[frozenset[str]]() if said else _untested(world)
    if untested <= neighbours(urdf, {shape.link for shape in urdf.shapes}):
        untested = frozenset()
    data = sources.robot.read_bytes()
    if _is_plain_robot(sources, data, urdf, world) and not untested:
        sources_of = [shape.source for shape in urdf.shapes if isinstance(shape, Mesh)]
        meshes = [each.read_bytes() for each in sources_of if isinstance(each, Path)]
        of_pairs = [b"" if sources.srdf is None else sources.srdf.read_bytes()]
        of_pairs = of_pairs if sources.embed or sources.srdf is not None else []
        return RobotFiles((data, *of_pairs, *meshes), _digest(data) if sources.embed else None, said), urdf
    text, meshes_of = plain_robot(urdf)
    srdf = sources.srdf.read_bytes() if said and sources.srdf else plain_srdf(urdf.name, untested)
    return RobotFiles((text, srdf, *meshes_of), _digest(data), said or untested or None), urdf


def scene_files(sources: Sources, world: ArmWorld, scene: Scene) -> SceneFiles:
    """Return the files of what a plan's world claims as its `scene`: its own file, or a plain one that is carried."""
    if sources.scene is None:
        return SceneFiles(plain_scene(scene), "-")
    data = sources.scene.read_bytes()
    read = load_scene(sources.scene)
    made_of = _digest(data) if _says(read, world) else "-"
    entries = _plain_entries(sources.scene, data)
    if entries is None or made_of == "-":
        return SceneFiles(plain_scene(scene), made_of)
    meshes = [(sources.scene.parent / str(entry["file"])).read_bytes() for _, entry in entries if "file" in entry]
    convex = frozenset(name for name, entry in entries if entry.get("convex") is True)
    return SceneFiles((data, *meshes), made_of if sources.embed else None, convex)


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _untested(world: ArmWorld) -> frozenset[frozenset[str]]:
    """Return pairs of links with bodies, which planned joints move against each other, that a robot does not test."""
    robot, bodied = world.robot, list(dict.fromkeys(each.link for each in world.robot.capsules))
    tested, first = {frozenset(pair) for pair in robot.pairs}, {robot.links[0]: robot.links[0]}
    for joint in robot.joints:
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        first[joint.child] = joint.child if leader in robot.group else first[joint.parent]
    links = [link for link in bodied if link not in robot.holds]
    pairs = (frozenset((a, b)) for i, a in enumerate(links) for b in links[i + 1 :] if first[a] != first[b])
    return frozenset(pair for pair in pairs if pair not in tested)


def _is_plain_robot(sources: Sources, data: bytes, urdf: RobotDescription, world: ArmWorld) -> bool:
    """Return whether a checker reads the file of a robot as it is."""
    held = {name for name, value in held_values(world.robot).items() if value != 0.0}
    coordinates = {joint.name for joint in urdf.joints if joint.of}
    meshes = [shape.source for shape in urdf.shapes if isinstance(shape, Mesh)]
    return (
        sources.robot.suffix == ".urdf"
        and not (sources.use_visuals or sources.upright_meshes)
        and not _ODD_XML.search(data)
        and not coordinates & {*world.robot.group, *held}
        and all(isinstance(each, Path) and each.suffix.lower() in _MESHES for each in meshes)
    )


def _says(read: Scene, world: ArmWorld) -> bool:
    """Return whether a scene, as its file says it, is that of a world."""
    around = scene_around(world.robot, read)
    if {each.name for each in around.attached} != set(world.robot.holds):
        return False
    same = around.attached == world.scene.attached and around.fingerprint() == world.scene.fingerprint()
    return same and in_scene(world.robot, read) == world.robot and around.allowed == world.scene.allowed


def _plain_entries(path: Path, data: bytes) -> list[tuple[str, Mapping[str, object]]] | None:
    """Return name and entry of what a scene's file has as obstacles and attaches; None if a checker cannot read it."""
    if path.suffix not in (".yaml", ".yml") or _ODD_YAML.search(data.decode("utf-8", "replace")):
        return None
    document = read_mapping(path, "scene")
    allowed = document.get("allowed") or {}
    parts = allowed.values() if isinstance(allowed, Mapping) else [None]
    if not document.keys() <= _SECTIONS or not all(isinstance(o, str) for part in parts for o in part or [None]):
        return None
    found: list[tuple[str, Mapping[str, object]]] = []
    for key in ("obstacles", "attach"):
        part = document.get(key) or {}
        pairs: Iterable[tuple[str, object]] = (
            part.items() if isinstance(part, Mapping) else ((str(each.get("name")), each) for each in part)
        )
        found += [(name, entry) for name, entry in pairs if isinstance(entry, Mapping)]
    return found if all(_is_plain(entry) for _, entry in found) else None


def _is_plain(entry: Mapping[str, object]) -> bool:
    """Return whether a checker reads the entry of an obstacle."""
    if entry.get("shape") == "mesh":
        return Path(str(entry.get("file"))).suffix.lower() in _MESHES
    short = [kind for kind in PRIMITIVES if kind in entry]
    return entry.get("shape") in (*PRIMITIVES, "plane") or ("shape" not in entry and len(short) == 1)
