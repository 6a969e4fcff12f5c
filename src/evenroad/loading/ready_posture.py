"""Collision-free values for held joints, and a default ready posture."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._rng import generator
from evenroad.robots.hull_trees import contacts, hull_trees
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import KinematicTree, held_values, poses_at, with_mimics
from evenroad.robots.pairs import Pieces

_SHARES = (0.5, 0.25, 0.75, 1.0)
"""Fractions of the range to either limit at which joints are tried; half open first."""
_SAMPLES = 200
"""Number of random values that are tried after these."""


def held_apart(
    robot: KinematicTree,
    pieces: Pieces,
    pairs: Collection[tuple[str, str]],
    states: Collection[Mapping[str, float]] = (),
) -> dict[str, float]:
    """Return values of held joints at which the fewest of these pairs touch, joint -> value [rad or m].

    Only joints between bodies that touch at the robot's held values are returned.  Values of `states` are preferred;
    else a gripper closed at 0 is half opened.  Pairs that touch at all values, or depend on joints of the group, are
    ignored.
    """
    movable = {joint.name: joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None}
    held = held_values(robot)
    between = {
        pair: joints & set(held)
        for pair in pairs
        if (joints := _joints_between(robot, *pair)) and not joints & set(robot.group)
    }
    bodied = {link: pieces[link] for link in {link for pair in between for link in pair}}
    between = {pair: joints for pair, joints in between.items() if joints}
    if not between:
        return {}
    every = list(between)
    values = {name: np.array([value]) for name, value in held.items()}
    first = _touching(robot, bodied, every, values)[0]
    moved = sorted(set().union(*(between[pair] for pair, touch in zip(every, first, strict=True) if touch)))
    if not moved:
        return {}
    tried = _sampled_values([movable[name] for name in moved], [held[name] for name in moved])
    known = [[float(state.get(name, held[name])) for name in moved] for state in states]
    tried = np.concatenate([tried[:1], np.reshape(known, (-1, len(moved))), tried[1:]])
    values = {name: np.full(len(tried), value) for name, value in held.items()}
    values |= dict(zip(moved, tried.T, strict=True))
    count = _touching(robot, bodied, every, values).sum(axis=1)
    best = int(np.argmin(count))
    if count[best] == count[0]:
        return {}
    return dict(zip(moved, tried[best].tolist(), strict=True))


def bent_posture(
    robot: KinematicTree, pieces: Pieces, pairs: Sequence[tuple[str, str]], home: Mapping[str, float]
) -> dict[str, float]:
    """Return a posture away from `home` in which none of these pairs touches, joint -> value [rad or m].

    Joints of the group that no other follows are drawn from the middle half of their ranges, of whole turns at most;
    the others stay.  Empty where none of 200 is free.
    """
    followed = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    moved = [joint for joint in robot.joints if joint.name in robot.group and joint.name not in followed]
    low, high = (np.clip([getattr(joint, end) for joint in moved], -np.pi, np.pi) for end in ("lower", "upper"))
    drawn = low + (0.25 + 0.5 * generator(0).random((_SAMPLES, len(moved)))) * (high - low)
    values = {name: np.full(_SAMPLES, value) for name, value in home.items()}
    values |= {joint.name: drawn[:, i].round(3) for i, joint in enumerate(moved)}
    bodied = {link: pieces[link] for pair in pairs for link in pair}
    free = np.flatnonzero(~_touching(robot, bodied, pairs, values).any(axis=1))
    return {name: float(each[free[0]]) for name, each in values.items()} if len(free) and moved else {}


def _joints_between(robot: KinematicTree, first: str, second: str) -> set[str]:
    """Return the joints that move two links on each other, for mimics those that they follow."""
    above = {joint.child: joint for joint in robot.joints}

    def joints_above(link: str) -> set[Joint]:
        joints = set()
        while link in above:
            joints.add(above[link])
            link = above[link].parent
        return joints

    moving = (joint for joint in joints_above(first) ^ joints_above(second) if joint.kind != "fixed")
    return {joint.name if joint.mimic is None else joint.mimic.joint for joint in moving}


def _sampled_values(joints: Sequence[Joint], values: Sequence[float]) -> Floats:
    """Return values of joints to try, (n, joints): the current ones first, then farther ones, then random ones."""
    now = np.array(values)
    circle = np.where([joint.kind == "continuous" for joint in joints], np.pi, np.inf)
    low = np.maximum([joint.lower for joint in joints], -circle)
    high = np.minimum([joint.upper for joint in joints], circle)
    farther = [now + share * (end - now) for share in _SHARES for end in (high, low)]
    return np.array([now, *farther, *(low + generator(0).random((_SAMPLES, len(now))) * (high - low))])


def _touching(
    robot: KinematicTree, pieces: Pieces, pairs: Sequence[tuple[str, str]], values: dict[str, Floats]
) -> Bools:
    """Return which pairs touch, (n, pairs), at these values, joint -> (n,); other joints are at 0."""
    count = len(next(iter(values.values())))
    others = {name: np.zeros(count) for name in robot.group}
    poses = poses_at(robot, with_mimics(robot, others | values), count)
    of_link = {link: np.ascontiguousarray(poses[:, robot.links.index(link)]) for link in pieces}
    trees = hull_trees({link: [(piece.parts, piece.radius) for piece in of] for link, of in pieces.items()})
    found = [contacts(trees, a, b, of_link[a], of_link[b])[:, 0] >= 0 for a, b in pairs]
    return np.stack(found, axis=1) if found else np.zeros((count, 0), dtype=np.bool_)
