"""Writing a certificate that there is no path: cells that witnesses block keep start and goals apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.certificates.cells import Ranges, separate, tree_of
from evenroad.certificates.certify import PathLike, Sources, claimed_by
from evenroad.certificates.pruned import LEFT_OPEN, pruned
from evenroad.certificates.witnesses import Witnesses, witnesses_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.loading.description import RobotDescription
from evenroad.scenes.scene import Scene

MAGIC = "evenroad certificate of no path 1\n"
FIRST = 3
"""Number of first joints of which cells are tried."""
CELLS = {1: 4_000, 2: 60_000, 3: 400_000}
"""Number of joints -> largest number of cells."""
BEYOND = 1e-5
"""By how much cells reach beyond limits [rad or m]."""
_ANY = 1000.0
"""A range of more than this is none [rad or m]."""


@dataclass(frozen=True)
class Part:
    """Columns, and the answers of their cells."""

    columns: Ints
    answers: Ints


def certify_no_path(world: object, start: Floats, goals: Floats, sources: Sources, file: PathLike) -> None:
    """Write the certificate that no path leads from a start, (dim,), to any goal, (g, dim), in a world of these files.

    Raises NotAvailable for a robot or a scene of which no certificate speaks, and where no such proof is found.
    """
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a certificate is about an arm in a scene, not about {shown(world)}")
    claimed = claimed_by(sources, world)
    urdf, scene = claimed.urdf, claimed.scene
    witnesses = witnesses_of(world.robot, urdf, scene, claimed.beside)
    parts, left = [], np.ones(len(goals), dtype=np.bool_)
    for columns in _columns(witnesses):
        if not left.any():
            break
        part, apart = _part(witnesses, urdf, scene, columns, start, goals[left])
        if part is not None:
            parts.append(part)
            left[np.flatnonzero(left)[apart]] = False
    if left.any():
        which = "the goal" if len(goals) == 1 else f"goal {int(left.argmax())}"
        raise NotAvailable(
            f"no certificate: balls inside of the robot's shapes do not show that {which} is out of reach of the first"
            f" {min(FIRST, len(start))} joints"
        )
    claimed.write(Path(file), MAGIC, *_content(witnesses, np.vstack([start, goals]), parts))


def _columns(witnesses: Witnesses) -> Iterator[tuple[int, ...]]:
    """Yield the columns that are tried: the first ones, and one or two that move a pair of links on each other."""
    dim, moved = len(witnesses.robot.group), witnesses.columns
    tried = [tuple(range(count)) for count in range(1, min(FIRST, dim) + 1)]
    among = np.unique(moved[moved.sum(axis=1) <= 2], axis=0)
    others = [tuple(np.flatnonzero(row).tolist()) for row in among if row.any()]
    yield from dict.fromkeys(sorted([*tried, *others], key=lambda each: (len(each), each)))


def _part(
    witnesses: Witnesses, urdf: RobotDescription, scene: Scene, columns: tuple[int, ...], start: Floats, goals: Floats
) -> tuple[Part | None, Bools]:
    """Return cells of some columns that keep a start apart from goals, and from which; None from none."""
    none = np.zeros(len(goals), dtype=np.bool_)
    others = np.ones(len(start), dtype=np.bool_)
    others[list(columns)] = False
    pairs = np.flatnonzero(~witnesses.columns[:, others].any(axis=1) & witnesses.columns.any(axis=1))
    ranges = _ranges(witnesses, urdf, scene, columns)
    if ranges is None or not len(pairs):
        return None, none
    tree = tree_of(witnesses, ranges, pairs)
    apart = separate(tree, witnesses, start, goals, CELLS[len(columns)])
    if not apart.any():
        return None, none
    return Part(ranges.columns, pruned(tree, start, goals[apart])), apart


def _ranges(witnesses: Witnesses, urdf: RobotDescription, scene: Scene, columns: tuple[int, ...]) -> Ranges | None:
    """Return the ranges of some columns as a checker has them; None where a joint has none."""
    names, joints = witnesses.robot.group, {joint.name: joint for joint in urdf.joints}
    low, high = np.full(len(columns), -np.inf), np.full(len(columns), np.inf)
    for i, column in enumerate(columns):
        name = names[column]
        for least, most in (joints[name].stops, scene.limits.get(name, (-np.inf, np.inf))):
            if most - least <= _ANY:
                low[i], high[i] = max(low[i], least - BEYOND), min(high[i], most + BEYOND)
        moved = [(joint, factor) for _, joint, _, at, factor, _ in witnesses.tree.moved if at == column]
        if np.isinf(low[i]) and any(joint.kind == "prismatic" or factor % 1.0 for joint, factor in moved):
            return None
        if low[i] >= high[i]:
            return None
    endless = np.isinf(low)
    return Ranges(np.array(columns), np.where(endless, -np.pi, low), np.where(endless, np.pi, high), endless)


def _content(witnesses: Witnesses, terminals: Floats, parts: list[Part]) -> tuple[list[str], bytes]:
    """Return the counts and the numbers of a certificate."""
    used = np.unique(np.concatenate([part.answers for part in parts]))
    pairs = used[used >= 0]
    ball, solid = witnesses.pairs.ball[pairs], witnesses.pairs.solid[pairs]
    first_ball = len(witnesses.solids.body) - witnesses.balls
    balls = np.unique(np.concatenate([ball, solid[solid >= first_ball]]))
    table = np.zeros(len(balls), dtype=[("body", "<u2"), ("ball", "<f4", 4)])
    table["body"] = witnesses.solids.body[balls]
    table["ball"] = np.c_[witnesses.solids.middle[balls], witnesses.solids.radius[balls]]
    others = np.where(solid >= first_ball, first_ball + np.searchsorted(balls, solid), solid)
    both = np.stack([np.searchsorted(balls, ball), others], axis=1)
    if max(both.max(initial=0), len(pairs)) > 60_000:
        raise NotAvailable("no certificate: it would need more than 60000 witnesses")
    content = terminals.astype("<f8").tobytes() + table.tobytes() + both.astype("<u2").tobytes()
    lines = [f"goals {len(terminals) - 1}", f"balls {len(balls)}", f"witnesses {len(pairs)}"]
    for part in parts:
        axes = len(part.columns)
        halved = (part.answers < 0) & (part.answers > LEFT_OPEN)
        named = 1 + axes + np.searchsorted(pairs, part.answers)
        answers = np.where(halved, -part.answers, np.where(part.answers < 0, 0, named))
        content += answers.astype("<u1" if 1 + axes + len(pairs) <= 256 else "<u2").tobytes()
        lines.append(f"cells {len(answers)} {' '.join(map(str, part.columns.tolist()))}")
    return lines, content
