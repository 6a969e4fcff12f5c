"""Writing a certificate that there is no path: cells that witnesses block keep start and goals apart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.certificates.cells import Ranges, separate, tree_of
from evenroad.certificates.certify import PathLike, Sources, claimed_by
from evenroad.certificates.claim import Tree
from evenroad.certificates.plain import ENDLESS
from evenroad.certificates.pruned import LEFT_OPEN, pruned
from evenroad.certificates.targets import Target, target_of
from evenroad.certificates.witnesses import Witnesses, witnesses_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.loading.description import RobotDescription
from evenroad.poses.pose_goal import PoseGoal
from evenroad.scenes.scene import Scene

MAGIC = "evenroad certificate of no path 1\n"
FIRST = 3
"""Number of first joints of which cells are tried."""
CELLS = {1: 4_000, 2: 60_000, 3: 150_000}
"""Number of joints -> largest number of cells."""
PAST_LIMITS = 1e-5
"""By how much cells reach beyond limits [rad or m]."""


@dataclass(frozen=True)
class Part:
    """Columns, and the answers of their cells."""

    columns: Ints
    answers: Ints


def certify_no_path(
    world: object, start: Floats, goals: Floats, sources: Sources, file: PathLike, poses: Sequence[PoseGoal] = ()
) -> None:
    """Write the certificate that no path leads from a start, (dim,), to any goal, (g, dim), in a world of these files.

    Nor does one lead to any posture that reaches one of the `poses`.
    Raises NotAvailable for a robot or a scene of which no certificate speaks, and where no such proof is found.
    """
    if not isinstance(world, ArmWorld):
        raise InvalidValue(f"a certificate is about an arm in a scene, not about {shown(world)}")
    claimed = claimed_by(sources, world)
    urdf, scene = claimed.links.urdf, claimed.scene
    witnesses = witnesses_of(world.robot, urdf, scene, claimed.beside)
    slides = _slides(witnesses, urdf, scene)
    parts, left = [], np.ones(len(goals) + len(poses), dtype=np.bool_)
    for columns in _columns(witnesses):
        if not left.any():
            break
        targets = [target_of(world.robot, witnesses.tree, pose, columns, slides) for pose in poses]
        wanted = [target for target, is_left in zip(targets, left[len(goals) :], strict=True) if is_left]
        part, apart = _part(witnesses, urdf, scene, columns, start, goals[left[: len(goals)]], wanted)
        if part is not None:
            parts.append(part)
            left[np.flatnonzero(left)[apart]] = False
    if left.any():
        number = int(left.argmax())
        which = "the goal" if len(left) == 1 else f"goal {number}" if number < len(goals) else "a pose"
        raise NotAvailable(
            f"no certificate: balls inside of the robot's shapes do not show that {which} is out of reach of the first"
            f" {min(FIRST, len(start))} joints"
        )
    lines, content = _content(witnesses, np.vstack([start, goals]), parts)
    said = [target_of(world.robot, witnesses.tree, pose, (), slides).line for pose in poses]
    claimed.write(Path(file), MAGIC, [*said, *lines], content)


def _columns(witnesses: Witnesses) -> Iterator[tuple[int, ...]]:
    """Yield the columns that are tried: the first ones, and one or two that move a pair of links on each other."""
    dim, moved = len(witnesses.robot.group), witnesses.columns
    tried = [tuple(range(count)) for count in range(1, min(FIRST, dim) + 1)]
    among = np.unique(moved[moved.sum(axis=1) <= 2], axis=0)
    others = [tuple(np.flatnonzero(row).tolist()) for row in among if row.any()]
    yield from dict.fromkeys(sorted([*tried, *others], key=lambda each: (len(each), each)))


def _part(
    witnesses: Witnesses,
    urdf: RobotDescription,
    scene: Scene,
    columns: tuple[int, ...],
    start: Floats,
    goals: Floats,
    targets: list[Target],
) -> tuple[Part | None, Bools]:
    """Return cells of some columns that keep a start apart from goals and targets, and from which; None from none."""
    none = np.zeros(len(goals) + len(targets), dtype=np.bool_)
    others = np.ones(len(start), dtype=np.bool_)
    others[list(columns)] = False
    pairs = np.flatnonzero(~witnesses.columns[:, others].any(axis=1) & witnesses.columns.any(axis=1))
    ranges = ranges_of(witnesses.tree, witnesses.robot.group, urdf, scene, columns)
    if ranges is None or not len(pairs):
        return None, none
    tree = tree_of(witnesses, ranges, pairs, tuple(targets))
    apart = separate(tree, witnesses, start, goals, CELLS[len(columns)])
    if not apart.any():
        return None, none
    shown = np.flatnonzero(apart[len(goals) :])
    return Part(ranges.columns, pruned(tree, start, goals[apart[: len(goals)]], shown)), apart


def ranges_of(
    tree: Tree, joints: Sequence[str], urdf: RobotDescription, scene: Scene, columns: tuple[int, ...]
) -> Ranges | None:
    """Return the ranges of some columns as a checker has them; None where a joint has none."""
    low, high = np.full(len(columns), -np.inf), np.full(len(columns), np.inf)
    for i, column in enumerate(columns):
        low[i], high[i] = _range(urdf, scene, joints[column])
        moved = [(joint, factor) for _, joint, _, at, factor, _ in tree.moved if at == column]
        if np.isinf(low[i]) and any(joint.kind == "prismatic" or factor % 1.0 for joint, factor in moved):
            return None
        if low[i] >= high[i]:
            return None
    endless = np.isinf(low)
    return Ranges(np.array(columns), np.where(endless, -np.pi, low), np.where(endless, np.pi, high), endless)


def _range(urdf: RobotDescription, scene: Scene, name: str) -> tuple[float, float]:
    """Return how far a joint may go as a checker has it, -inf and inf without limits."""
    joint, low, high = next(joint for joint in urdf.joints if joint.name == name), -np.inf, np.inf
    for least, most in (joint.stops, scene.limits.get(name, (low, high))):
        if most - least <= ENDLESS:
            low, high = max(low, least - PAST_LIMITS), min(high, most + PAST_LIMITS)
    return low, high


def _slides(witnesses: Witnesses, urdf: RobotDescription, scene: Scene) -> Floats:
    """Return how far from 0 joints slide at most, 0 for those that turn [m]."""
    far = []
    for _, joint, _, column, factor, offset in witnesses.tree.moved:
        limits = np.array(_range(urdf, scene, witnesses.robot.group[column]))
        far.append(float(np.abs(factor * limits + offset).max()) if joint.kind == "prismatic" else 0.0)
    return np.array(far)


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
