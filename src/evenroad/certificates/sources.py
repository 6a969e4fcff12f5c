"""The files that a certificate is about: which ones are named, and a scene's as it is or as a plain one."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict, Unpack

from evenroad._shared import once_property
from evenroad._yaml import read_mapping
from evenroad.certificates.plain import plain_scene
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.shapes import PRIMITIVES
from evenroad.loading.find import find_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.scenes.robot_in_scene import in_scene, scene_around
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import find_scene, load_scene

PathLike = str | os.PathLike[str]
_SECTIONS = {"obstacles", "allowed", "states", "limits", "attach", "name"}
MESHES = {".stl", ".obj", ".dae"}
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

    @once_property
    def digests(self) -> bytes:
        """Their digests, one after the other."""
        return b"".join(hashlib.sha256(each).digest() for each in self.contents)


@dataclass(frozen=True)
class RobotFiles(Files):
    """Those of a robot, and the pairs of links that they let touch, None where they say nothing."""

    disabled: frozenset[frozenset[str]] | None = None


@dataclass(frozen=True)
class SceneFiles(Files):
    """Those of a scene, and which of its meshes stand for their hulls."""

    convex: frozenset[str] = frozenset()


def scene_files(sources: Sources, world: ArmWorld, scene: Scene) -> SceneFiles:
    """Return the files of what a plan's world claims as its `scene`: its own file, or a plain one that is carried."""
    if sources.scene is None:
        return SceneFiles(plain_scene(scene), "-")
    data = sources.scene.read_bytes()
    read = load_scene(sources.scene)
    made_of = digest_of(data) if _says(read, world) else "-"
    entries = _plain_entries(sources.scene, data)
    if entries is None or made_of == "-":
        return SceneFiles(plain_scene(scene), made_of)
    meshes = [(sources.scene.parent / str(entry["file"])).read_bytes() for _, entry in entries if "file" in entry]
    convex = frozenset(name for name, entry in entries if entry.get("convex") is True)
    return SceneFiles((data, *meshes), made_of if sources.embed else None, convex)


def digest_of(data: bytes) -> str:
    """Return the digest of a file as a header names it."""
    return hashlib.sha256(data).hexdigest()


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
        return Path(str(entry.get("file"))).suffix.lower() in MESHES
    short = [kind for kind in PRIMITIVES if kind in entry]
    return entry.get("shape") in (*PRIMITIVES, "plane") or ("shape" not in entry and len(short) == 1)
