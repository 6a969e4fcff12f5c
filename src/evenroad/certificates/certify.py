"""Writing a certificate of a plan, for the files that its robot and its scene come from."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad._yaml import read_mapping
from evenroad.certificates.claim import Claim, Claimed, claim_of
from evenroad.certificates.elements import tables_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import Exhausted, InvalidValue, NotAvailable, shown
from evenroad.geometry.shapes import Mesh
from evenroad.loading.description import RobotDescription
from evenroad.loading.find import find_robot
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile
from evenroad.loading.srdf import read_srdf
from evenroad.robots.kinematics import held_values
from evenroad.scenes.scene_file import find_scene

MAGIC = "evenroad certificate 1\n"
MOST_TASKS = 4_000_000
_DECIDED = 1e-7
"""Nearer bodies than this count as touching [m]."""
_ALWAYS = "links that always touch need an SRDF that disables them, as evenroad robot --write-srdf writes one"
PathLike = str | os.PathLike[str]


@dataclass(frozen=True)
class Sources:
    """The files that a certificate is about."""

    robot: Path
    scene: Path
    srdf: Path | None = None
    packages: Mapping[str, PathLike] | None = None

    @classmethod
    def named(
        cls, robot: PathLike, scene: PathLike, srdf: PathLike | None, packages: Mapping[str, PathLike] | None
    ) -> Sources:
        """Return the files of a robot and a scene, which may be the names of shipped ones."""
        path, own = find_robot(robot)
        return cls(path, find_scene(scene), own if srdf is None else Path(srdf), packages)


def certify(world: object, path: Floats, sources: Sources, file: PathLike) -> None:
    """Write the certificate of a path, (p, dim), that a world of these files calls free.

    Raises NotAvailable for a robot, or a scene, of which no certificate speaks; InvalidValue if the path touches
    something, or comes too near to it; Exhausted if the proof would be too long.
    """
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a certificate is about a path of an arm in a scene, not in {shown(world)}")
    urdf = _read(sources)
    entries = _entries(sources.scene)
    claimed = Claimed(
        joints=world.robot.group,
        held={name: value for name, value in held_values(world.robot).items() if value != 0.0},
        disabled=None if sources.srdf is None else read_srdf(sources.srdf, urdf).disabled,
        convex=frozenset(name for name, entry in entries if entry.get("convex") is True),
        clearance=world.clearance,
        padding=dict(world.robot.padding),
    )
    claim = claim_of(urdf, world.scene, claimed)
    curves = np.stack([path[:-1], 0.5 * (path[:-1] + path[1:]), path[1:]], axis=1)
    answers, directions = answers_of(claim, curves)
    text = _header(claimed, _digest(sources, urdf, entries), len(curves), len(answers), len(directions))
    content = path.astype("<f8").tobytes() + packed(answers) + directions.astype("<f4").tobytes()
    with atomic_write(Path(file)) as stream:
        stream.write(text.encode() + content)


def answers_of(claim: Claim, curves: Floats) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]:
    """Return the answers of a certificate and their directions, (d, 3), for curves of three control points."""
    # Imported late: nothing else needs it.
    from evenroad._native import certificates as native

    members = np.array([number for node in claim.nodes for number in node.shapes], dtype=np.int64)
    stops = np.cumsum([len(node.shapes) for node in claim.nodes], dtype=np.int64)
    rows = [(node.frame, end - len(node.shapes), end) for node, end in zip(claim.nodes, stops, strict=True)]
    both = np.array([pair[:2] for pair in claim.pairs], dtype=np.int64).reshape(-1, 2)
    written = native.write_answers(
        tables_of(claim.shapes),
        claim.tree.tables(),
        np.array(rows, dtype=np.int64).reshape(-1, 3),
        members,
        both,
        np.array([keep for _, _, keep, _ in claim.pairs], dtype=float),
        np.ascontiguousarray(curves, dtype=float),
        MOST_TASKS,
    )
    if written is None:
        raise Exhausted(f"the certificate would have more than {MOST_TASKS} answers")
    touch = written.touch
    if touch.pair >= 0:
        first, second = claim.pairs[touch.pair][3]
        what = "touches" if touch.gap < _DECIDED else "is not shown to be apart from"
        said = f"no certificate: motion {touch.motion} at share {touch.share:.6f}: {first} {what} {second}"
        raise InvalidValue(said if claim.by_srdf else f"{said}; {_ALWAYS}")
    return written.answers, written.directions


def packed(answers: npt.NDArray[np.uint8]) -> bytes:
    """Return answers of 0 to 5, three in a byte."""
    digits = np.concatenate([answers, np.zeros(-len(answers) % 3, np.uint8)]).reshape(-1, 3)
    return (digits @ np.array([1, 6, 36], np.uint8)).astype(np.uint8).tobytes()


def _header(claimed: Claimed, digest: str, motions: int, answers: int, directions: int) -> str:
    lines = [f"inputs {digest}", *(f"joint {name}" for name in claimed.joints)]
    lines += [f"held {value!r} {name}" for name, value in claimed.held.items()]
    lines += [f"clearance {claimed.clearance!r}"] if claimed.clearance else []
    lines += [f"padding {value!r} {link}" for link, value in claimed.padding.items() if value]
    lines += ["degree 1", f"motions {motions}", f"answers {answers}", f"directions {directions}"]
    return MAGIC + "\n".join(lines) + "\n\n"


def _read(sources: Sources) -> RobotDescription:
    """Return what the robot's URDF says; NotAvailable for other files."""
    if sources.robot.suffix != ".urdf":
        raise NotAvailable(f"a certificate is about a URDF, not {sources.robot.name}: write the URDF of it first")
    packages = tuple((name, os.fspath(folder)) for name, folder in sorted((sources.packages or {}).items()))
    return read_robot(RobotFile(sources.robot, packages=packages))


def _entries(scene: Path) -> list[tuple[str, Mapping[str, object]]]:
    """Return name and entry of what a scene's file has as obstacles, and then of what it attaches."""
    document = read_mapping(scene, "scene")
    found: list[tuple[str, Mapping[str, object]]] = []
    for key in ("obstacles", "attach"):
        part = document.get(key) or {}
        pairs: Iterable[tuple[str, object]] = (
            part.items() if isinstance(part, Mapping) else ((str(each.get("name")), each) for each in part)
        )
        found += [(name, entry) for name, entry in pairs if isinstance(entry, Mapping)]
    return found


def _digest(sources: Sources, urdf: RobotDescription, entries: list[tuple[str, Mapping[str, object]]]) -> str:
    """Return the digest of all files that the claim is about, in the order in which a checker reads them."""
    robots = [shape.source for shape in urdf.shapes if isinstance(shape, Mesh)]
    scenes = [sources.scene.parent / str(entry["file"]) for _, entry in entries if "file" in entry]
    files = [sources.robot, sources.srdf, *robots, sources.scene, *scenes]
    digest = hashlib.sha256()
    for path in files:
        if isinstance(path, Path):
            digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()
