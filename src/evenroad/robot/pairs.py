"""Which links are tested against each other."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from evenroad._rng import generator
from evenroad.geometry.distance import segment_distance
from evenroad.robot.joint import Joint
from evenroad.robot.kinematics import KinematicTree, ends_at, poses_at, with_mimics

SAMPLES = 1000
"""Random configurations that tell pairs that are always in contact."""

TOUCHING = "touch in every sample"
"""Why a pair is not tested whose capsules are in contact in all of them; the shapes inside may well come apart."""


@dataclass(frozen=True)
class SelfPairs:
    """Pairs of links that are tested, in the order of the links; and the others with bodies, each with the reason."""

    tested: tuple[tuple[str, str], ...]
    dropped: tuple[tuple[str, str, str], ...]


def pairs_without(robot: KinematicTree, disabled: Collection[frozenset[str]]) -> SelfPairs:
    """Return all pairs of links that have bodies and can move on each other, but those disabled by an SRDF."""
    return _sorted_out(
        robot, {pair: "disabled in the SRDF" for pair in _bodied(robot) if frozenset(pair) in disabled}
    )


def computed_pairs(robot: KinematicTree) -> SelfPairs:
    """Return the pairs of links with bodies without those that touch by construction.

    Dropped are neighbours in the tree (links without bodies between them do not count where only one joint
    between them moves), pairs that no joint moves on each other, and pairs that touch in every one of 1000
    configurations drawn uniformly within the limits of all joints.  Pairs that never touch are kept: a sample
    cannot prove that.
    """
    reasons = {pair: "neighbours" for pair in _bodied(robot) if _are_neighbours(robot, *pair)}
    reasons |= {pair: TOUCHING for pair in always_touching(robot, _bodied(robot)) if pair not in reasons}
    return _sorted_out(robot, reasons)


def _sorted_out(robot: KinematicTree, reasons: dict[tuple[str, str], str]) -> SelfPairs:
    rigid = {pair: "fixed to each other" for pair in _bodied(robot) if not _can_move(robot, *pair)}
    reasons = reasons | rigid
    return SelfPairs(
        tested=tuple(pair for pair in _bodied(robot) if pair not in reasons),
        dropped=tuple((*pair, reasons[pair]) for pair in _bodied(robot) if pair in reasons),
    )


def _bodied(robot: KinematicTree) -> list[tuple[str, str]]:
    bodied = {capsule.link for capsule in robot.capsules}
    return list(combinations((link for link in robot.links if link in bodied), 2))


def _path_to_root(robot: KinematicTree, link: str) -> list[Joint]:
    by_child = {joint.child: joint for joint in robot.joints}
    path = []
    while link in by_child:
        path.append(by_child[link])
        link = by_child[link].parent
    return path


def _between(robot: KinematicTree, first: str, second: str) -> list[Joint]:
    """Return the joints between two links."""
    up, down = _path_to_root(robot, first), _path_to_root(robot, second)
    return [joint for joint in up if joint not in down] + [joint for joint in down if joint not in up]


def _can_move(robot: KinematicTree, first: str, second: str) -> bool:
    return any(joint.kind != "fixed" for joint in _between(robot, first, second))


def _are_neighbours(robot: KinematicTree, first: str, second: str) -> bool:
    if first not in {joint.parent for joint in _path_to_root(robot, second)}:
        return False
    joints = _between(robot, first, second)
    # Two joints with a length between them fold, and bring together what does not touch by construction.
    if sum(joint.kind != "fixed" for joint in joints) > 1:
        return False
    passed = {link for joint in joints for link in (joint.parent, joint.child)} - {first, second}
    return not passed & {capsule.link for capsule in robot.capsules}


def always_touching(robot: KinematicTree, pairs: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return those pairs of links that touch in every one of 1000 random configurations within the limits."""
    movable = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None]
    # A full circle for continuous joints, which have no limits.
    circle = [np.pi if joint.kind == "continuous" else np.inf for joint in movable]
    low = np.maximum([joint.lower for joint in movable], np.negative(circle))
    high = np.minimum([joint.upper for joint in movable], circle)
    q = low + generator(0).random((SAMPLES, len(movable))) * (high - low)
    values = with_mimics(robot, {joint.name: q[:, i] for i, joint in enumerate(movable)})
    ends = ends_at(robot, poses_at(robot, values, SAMPLES))
    number: dict[str, list[int]] = {}
    for i, capsule in enumerate(robot.capsules):
        number.setdefault(capsule.link, []).append(i)
    always = []
    for first, second in pairs:
        touching = np.zeros(SAMPLES, dtype=np.bool_)
        for i in number[first]:
            for j in number[second]:
                reach = robot.capsules[i].radius + robot.capsules[j].radius
                touching |= segment_distance(ends[:, i], ends[:, j]) <= reach
        if touching.all():
            always.append((first, second))
    return always
