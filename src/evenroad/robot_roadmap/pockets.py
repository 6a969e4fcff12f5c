"""Ends that are hard to reach, in pockets at random; and which configurations they can be joined to.

Where a roadmap fails, a start or goal sees none of its milestones.  So milestones learn from ends that no task has
shown: the tip of the robot in boxes of five walls, anywhere that it gets to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robot.kinematics import link_poses
from evenroad.robot_roadmap.chance import Surroundings

HALF_EXTENTS = ((0.12, 0.25), (0.1, 0.22), (0.1, 0.22))
"""Ranges of a pocket's depth, width and height, halved, as shares of the reach."""

WALL = 0.01
"""Half of the thickness of a wall, as a share of the reach."""

UPWARDS = 0.3
"""Share of the pockets that are open above; the others open towards the robot, turned by up to TURNED [rad]."""

TURNED = 0.7

INSIDE = 0.7
"""How far inside of a pocket the tip is, as a share of its half extents."""

IN_ONE = 4
"""Ends in one pocket at most."""

NEAR = 1500
"""Configurations that each end is tried to be joined to: the nearest."""

STEP = 0.2
"""Of the motions that are tried; nothing is proved here [rad]."""

TRIES = 40
"""Pockets for each end that is wanted, at most."""

STILL = 1e-3
"""A tip that does not move so far moves not at all [m]."""


def links_of(n: int) -> int:
    """Return to how many of n milestones start and goal are linked: of up to 256 to all, of 1024 to half."""
    return min(n, round(16.0 * np.sqrt(n)))


class Seen(NamedTuple):
    """Which configurations ends can be joined to: those of end e are ``which[first[e]:first[e + 1]]``."""

    first: Ints
    which: Ints


def no_ends() -> Seen:
    """Return what no end sees."""
    return Seen(np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int64))


def ends_in_pockets(
    robot: Robot,
    cell: Scene,
    pool: Floats,
    scaled: Floats,
    count: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] = lambda _: None,
) -> Seen:
    """Return what `count` ends in pockets at random see of a pool, (n, dim); fewer where hardly any is free.

    `scaled` is the pool in the metric that tells which configurations are near.
    """
    around = Surroundings.of(robot, pool)
    tips = _tips(robot, pool)
    found: list[Ints] = []
    for _ in range(TRIES * count if tips.shape[1] else 0):
        if len(found) == count:
            break
        own, tip = int(rng.integers(len(pool))), int(rng.integers(tips.shape[1]))
        walls, centre, turn, half = _pocket(tips[own, tip], around, rng)
        scene = replace(cell, name="pocket", obstacles=(*cell.obstacles, *walls))
        world = ArmWorld(robot, scene, resolution=STEP)
        if not world.valid(pool[own : own + 1])[0]:
            continue
        others = np.flatnonzero((np.abs((tips[:, tip] - centre) @ turn) < INSIDE * half).all(axis=1))
        others = rng.permutation(others[world.valid(pool[others])])[: IN_ONE - 1]
        for end in np.unique(np.append(others, own))[: count - len(found)]:
            found.append(_seen(world, pool, scaled, int(end)))
        progress(len(found) / count)
    if not found:
        return no_ends()
    return Seen(np.cumsum([0, *map(len, found)]), np.concatenate(found))


def _seen(world: ArmWorld, pool: Floats, scaled: Floats, end: int) -> Ints:
    """Return which of the nearest configurations a straight motion joins to an end, itself left out."""
    squared = ((scaled - scaled[end]) ** 2).sum(axis=1)
    squared[end] = np.inf
    near = np.argpartition(squared, NEAR)[:NEAR] if len(pool) > NEAR else np.flatnonzero(squared < np.inf)
    near = near[world.valid(pool[near])]
    free = world.motion_valid(np.broadcast_to(pool[end], (len(near), pool.shape[1])), pool[near])
    return near[free].astype(np.int64)


def _tips(robot: Robot, pool: Floats) -> Floats:
    """Return the places of the links that carry no other and move, (n, tips, 3) [m]."""
    carrying = {joint.parent for joint in robot.joints}
    places = np.concatenate(
        [link_poses(robot, q)[..., :3, 3] for q in np.array_split(pool, -(-len(pool) // 10_000))]
    )
    ends = [i for i, link in enumerate(robot.links) if link not in carrying]
    return places[:, [i for i in ends if np.ptp(places[:, i], axis=0).max() > STILL]]


def _pocket(
    tip: Floats, around: Surroundings, rng: np.random.Generator
) -> tuple[tuple[Obstacle, ...], Floats, Floats, Floats]:
    """Return walls around a tip, and the pocket's centre, (3,), axes, (3, 3), and half extents, (3,); open to -x."""
    x, y, _ = tip - around.base
    angle = np.arctan2(y, x) + rng.uniform(-TURNED, TURNED)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    if rng.random() < UPWARDS:
        turn = turn @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    half = around.reach * rng.uniform(*np.transpose(HALF_EXTENTS))
    thick = WALL * around.reach
    centre = tip - turn @ (half * rng.uniform(-0.5, 0.5, 3))
    parts = [(np.array([half[0], 0.0, 0.0]), np.array([thick, half[1], half[2]]))]
    for axis in (1, 2):
        for side in (-1.0, 1.0):
            place, size = np.zeros(3), half.copy()
            place[axis], size[axis] = side * half[axis], thick
            parts.append((place, size))
    axes = tuple(turn.ravel().tolist())
    walls = tuple(
        Obstacle.of(
            f"wall {i}", "box", tuple((2.0 * size).tolist()), tuple((centre + turn @ place).tolist()), axes
        )
        for i, (place, size) in enumerate(parts)
    )
    return walls, centre, turn, half
