"""Writing a certificate of a plan, for the files that its robot and its scene come from."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._files import atomic_write
from evenroad._native.certificates import Answers, Paths, write_answers
from evenroad._shared import once_property
from evenroad.certificates.claim import Claim, Claimed, Links, claim_of
from evenroad.certificates.curves import TOLERANCES, Curves, driven, straight
from evenroad.certificates.kept import claimed_keeps, rows_of
from evenroad.certificates.limits import kept_limits, strays_of
from evenroad.certificates.plain import claimed_scene
from evenroad.certificates.robot_files import ReadRobot, read_robot_files
from evenroad.certificates.sources import Files, scene_files
from evenroad.certificates.sources import Sources as Sources
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import KeptWorld
from evenroad.constraints.differential_drive import DrivenWorld
from evenroad.constraints.keep import Keep
from evenroad.errors import Exhausted, InvalidValue, shown
from evenroad.robots.kinematics import held_values
from evenroad.scenes.scene import Scene
from evenroad.space.path import continued
from evenroad.trajectory.trajectory import Trajectory

MAGIC = "evenroad certificate 1\n"
MOST_TASKS = 4_000_000
DECIDED = 1e-7
"""Nearer bodies than this count as touching [m]."""
PathLike = str | os.PathLike[str]


def certify(
    world: object,
    path: Floats,
    sources: Sources,
    file: PathLike,
    *,
    trajectory: Trajectory | None = None,
    states: Floats | None = None,
) -> None:
    """Write the certificate of a path, (p, dim), that a world of these files calls free.

    With a `trajectory` along the path it is about the straight motions between its states, which are driven, and names
    the limits that these keep, if the tolerance leaves room for the spline of which limits hold; with `states`,
    (n, dim), about the motions between these.

    Raises NotAvailable for what no certificate speaks of; InvalidValue if the path touches something, or comes too near
    to it; Exhausted if the proof would be too long.
    """
    limits = {} if trajectory is None else kept_limits(trajectory)
    states = states if trajectory is None else trajectory.positions
    keeps: Sequence[Keep] = ()
    if isinstance(world, KeptWorld) and not isinstance(world, DrivenWorld):
        keeps, world = world.keeps, world.world
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a certificate is about a path of an arm in a scene, not in {shown(world)}")
    claimed = claimed_by(sources, world, keeps)
    claim = claimed.claim
    if states is None:
        curves = straight(continued(path, world.space, path[0]))
        answers, directions = answers_of(claim, curves)
    else:
        strays = strays_of(states) if limits else 0.0
        curves, answers, directions = _near(claim, states, continued(path, world.space, path[0]), strays)
        limits = limits if _is_wide(curves.tolerance, strays) else {}
    lines = [keep.line for keep in claimed.beside.keeps]
    joints = claimed.beside.joints
    lines += [f"limit {fast!r} {hard!r} {name}" for name, (fast, hard) in limits.items() if name in joints]
    lines += [f"tolerance {curves.tolerance!r}"] if curves.tolerance else []
    lines += [f"degree {curves.degree}", f"motions {len(curves.controls)}"]
    lines += [f"answers {len(answers)}", f"directions {len(directions)}"]
    tables = curves.points.astype("<f8").tobytes() + packed(answers) + directions.astype("<f4").tobytes()
    claimed.write(Path(file), MAGIC, lines, tables)


@dataclass(frozen=True)
class OfFiles:
    """What a certificate is about: what files say, and what it says beside them."""

    files: tuple[Files, Files]
    links: Links
    scene: Scene
    beside: Claimed

    @once_property
    def claim(self) -> Claim:
        """All that is to be proved of a path."""
        return claim_of(self.links, self.scene, self.beside)

    def write(self, file: Path, magic: str, more: list[str], tables: bytes) -> None:
        """Write a certificate: a header with some lines more, tables, and the files that it carries."""
        write_certificate(file, magic, self.files, self.beside, more, tables)


def write_certificate(
    file: Path, magic: str, about: Sequence[Files], beside: Claimed, more: list[str], tables: bytes
) -> None:
    """Write a certificate about files of a robot and a scene, and what is claimed beside them."""
    digest = hashlib.sha256()
    for files in about:
        digest.update(files.digests)
    lines = [f"inputs {digest.hexdigest()}", *(f"joint {name}" for name in beside.joints)]
    for name, files in zip(("robot", "scene"), about, strict=True):
        lines += [f"{name} {files.made_of}"] if files.carried else []
    lines += [f"held {value!r} {name}" for name, value in beside.held.items()]
    lines += [f"clearance {beside.clearance!r}"] if beside.clearance else []
    lines += [f"padding {value!r} {link}" for link, value in beside.padding.items() if value]
    carried = [each for files in about if files.carried for each in files.contents]
    with atomic_write(file) as stream:
        stream.write((magic + "\n".join([*lines, *more]) + "\n\n").encode() + tables)
        stream.write(b"".join(len(each).to_bytes(8, "little") + each for each in carried))


_known: WeakKeyDictionary[ArmWorld, tuple[ReadRobot, tuple[tuple[str, float], ...], OfFiles]] = WeakKeyDictionary()
"""What certificates of worlds are about, each as long as there is the world."""


def claimed_by(sources: Sources, world: ArmWorld, keeps: Sequence[Keep] = ()) -> OfFiles:
    """Return what a certificate of a world is about, the same for a world whose scene has no file."""
    read = read_robot_files(sources, world)
    if keeps or sources.scene is not None:
        return _claimed_by(read, sources, world, keeps)
    held = tuple(held_values(world.robot).items())
    of, stood, known = _known.get(world, (None, None, None))
    if known is None or of is not read or stood != held:
        known = _claimed_by(read, sources, world)
        _known[world] = read, held, known
    return known


def _claimed_by(read: ReadRobot, sources: Sources, world: ArmWorld, keeps: Sequence[Keep] = ()) -> OfFiles:
    robot = read.files(world)
    claims = claimed_scene(world)
    scene = scene_files(sources, world, claims)
    claimed = Claimed(
        joints=world.robot.group,
        held={name: value for name, value in held_values(world.robot).items() if value != 0.0},
        disabled=robot.disabled,
        convex=scene.convex,
        clearance=world.clearance,
        padding=dict(world.robot.padding),
        keeps=claimed_keeps(keeps, world.robot),
    )
    return OfFiles((robot, scene), read.links(claimed), claims, claimed)


def _near(
    claim: Claim, states: Floats, path: Floats, strays: float
) -> tuple[Curves, npt.NDArray[np.uint8], npt.NDArray[np.float32]]:
    """Return curves along states of a path, and their answers: nearer ones where the first are not proved free."""

    def near(tolerance: float) -> Curves:
        return driven(states, path, tolerance, strays if _is_wide(tolerance, strays) else 0.0)

    *others, finest = TOLERANCES
    for curves in map(near, others):
        with suppress(InvalidValue):
            return curves, *answers_of(claim, curves)
    curves = near(finest)
    return curves, *answers_of(claim, curves)


def _is_wide(tolerance: float, strays: float) -> bool:
    """Return whether a tolerance is enough for what strays from motions between states, and for curves along these."""
    return 2.0 * strays <= tolerance


def answers_of(claim: Claim, curves: Curves) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.float32]]:
    """Return the answers of a certificate and their directions, (d, 3)."""
    written = written_of(claim, curves, MOST_TASKS)
    if written is None:
        raise Exhausted(f"the certificate would have more than {MOST_TASKS} answers")
    touch = written.touch
    if touch.pair >= 0:
        where = f"no certificate: motion {touch.motion} at share {touch.share:.6f}"
        if touch.pair >= len(claim.pairs):
            raise InvalidValue(f"{where}: {claim.keeps[touch.pair - len(claim.pairs)].link} leaves its constraint")
        first, second = claim.pairs[touch.pair].names
        what = "touches" if touch.gap < DECIDED else "is not shown to be apart from"
        raise InvalidValue(f"{where}: {first} {what} {second}")
    return written.answers, written.directions


def written_of(claim: Claim, curves: Curves, most: int) -> Answers | None:
    """Return what the kernel writes for curves, None if it takes more than `most` answers."""
    paths = Paths(curves.controls, curves.tolerance, *rows_of(claim.keeps, claim.tree.placement))
    return write_answers(claim.tree.native, [pair.native for pair in claim.pairs], paths, most)


def packed(answers: npt.NDArray[np.uint8]) -> bytes:
    """Return answers of 0 to 5, three in a byte."""
    digits = np.concatenate([answers, np.zeros(-len(answers) % 3, np.uint8)]).reshape(-1, 3)
    return (digits @ np.array([1, 6, 36], np.uint8)).astype(np.uint8).tobytes()
