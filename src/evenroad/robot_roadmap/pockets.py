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
from evenroad.robot.kinematics import capsule_ends, link_poses
from evenroad.robot_roadmap.chance import Surroundings

HALF_EXTENTS = ((0.12, 0.25), (0.1, 0.22), (0.1, 0.22))
"""Ranges of a pocket's depth, width and height, halved, as shares of the reach."""

_LEAST, _MOST = np.transpose(HALF_EXTENTS)
_SIDES = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])

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

ALONG = 3
"""Places along a capsule's axis that tell most pockets that it touches."""

STILL = 1e-3
"""A tip that does not move so far moves not at all [m]."""


def links_of(n: int) -> int:
    """Return to how many of n milestones start and goal are linked: of up to 256 to all, of 1024 to half."""
    return min(n, round(16.0 * np.sqrt(n)))


class Seen(NamedTuple):
    """Which configurations ends can be joined to: the end ``own[e]`` to ``which[first[e]:first[e + 1]]``."""

    own: Ints
    first: Ints
    which: Ints


def no_ends() -> Seen:
    """Return what no end sees."""
    nothing = np.empty(0, dtype=np.int64)
    return Seen(nothing, np.zeros(1, dtype=np.int64), nothing)


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
    if not count:
        return no_ends()
    around = Surroundings.of(robot, pool)
    tips = tips_of(robot, pool)
    body, radii = body_of(robot, pool)
    own_of: list[int] = []
    found: list[Ints] = []
    for _ in range(TRIES * count if tips.shape[1] else 0):
        if len(found) == count:
            break
        own, tip = int(rng.integers(len(pool))), int(rng.integers(tips.shape[1]))
        pocket = pocket_around(tips[own, tip], around, rng)
        if pocket.touched_by(body[own], radii):
            continue
        scene = replace(cell, name="pocket", obstacles=(*cell.obstacles, *pocket.walls()))
        world = ArmWorld(robot, scene, resolution=STEP)
        if not world.valid(pool[own : own + 1])[0]:
            continue
        others = np.flatnonzero(
            (np.abs((tips[:, tip] - pocket.centre) @ pocket.turn) < INSIDE * pocket.half).all(axis=1)
        )
        others = rng.permutation(others[world.valid(pool[others])])[: IN_ONE - 1]
        for end in np.unique(np.append(others, own))[: count - len(found)]:
            own_of.append(int(end))
            found.append(_seen(world, pool, scaled, int(end)))
        progress(len(found) / count)
    if not found:
        return no_ends()
    return Seen(np.array(own_of), np.cumsum([0, *map(len, found)]), np.concatenate(found))


def _seen(world: ArmWorld, pool: Floats, scaled: Floats, end: int) -> Ints:
    """Return which of the nearest configurations a straight motion joins to an end, itself left out."""
    squared = ((scaled - scaled[end]) ** 2).sum(axis=1)
    squared[end] = np.inf
    near = np.argpartition(squared, NEAR)[:NEAR] if len(pool) > NEAR else np.flatnonzero(squared < np.inf)
    near = near[world.valid(pool[near])]
    free = world.motion_valid(np.broadcast_to(pool[end], (len(near), pool.shape[1])), pool[near])
    return near[free].astype(np.int64)


def tips_of(robot: Robot, pool: Floats) -> Floats:
    """Return the places of the links that carry no other and move, (n, tips, 3) [m]."""
    carrying = {joint.parent for joint in robot.joints}
    places = np.concatenate(
        [link_poses(robot, q)[..., :3, 3] for q in np.array_split(pool, -(-len(pool) // 10_000))]
    )
    ends = [i for i, link in enumerate(robot.links) if link not in carrying]
    return places[:, [i for i in ends if np.ptp(places[:, i], axis=0).max() > STILL]]


def body_of(robot: Robot, pool: Floats) -> tuple[Floats, Floats]:
    """Return places along the axes of all capsules, (n, places, 3), and their radii, (places,) [m]."""
    ends = np.concatenate([capsule_ends(robot, q) for q in np.array_split(pool, -(-len(pool) // 10_000))])
    share = np.linspace(0.0, 1.0, ALONG)[:, np.newaxis]
    places = ends[:, :, np.newaxis, 0] * (1.0 - share) + ends[:, :, np.newaxis, 1] * share
    return places.reshape(len(pool), -1, 3), np.repeat([each.radius for each in robot.capsules], ALONG)


class Pocket(NamedTuple):
    """A box without its side to -x: centre, (3,), axes, (3, 3), half extents, (3,), of its walls too, (5, 3) each."""

    centre: Floats
    turn: Floats
    half: Floats
    places: Floats
    sizes: Floats

    def touched_by(self, body: Floats, radii: Floats) -> bool:
        """Say whether a wall is nearer to one of some places, (n, 3), than its radius: what costs no world."""
        apart = np.abs(((body - self.centre) @ self.turn)[:, np.newaxis] - self.places) - self.sizes
        apart = np.maximum(apart, 0.0, out=apart)
        return bool((np.einsum("ijk,ijk->ij", apart, apart).min(axis=1) < radii * radii).any())

    def walls(self) -> tuple[Obstacle, ...]:
        """Return the walls as obstacles."""
        axes = tuple(self.turn.ravel().tolist())
        return tuple(
            Obstacle.of(
                f"wall {i} of a pocket",
                "box",
                (2.0 * size).tolist(),
                (self.centre + self.turn @ place).tolist(),
                axes,
            )
            for i, (place, size) in enumerate(zip(self.places, self.sizes, strict=True))
        )


def pocket_around(tip: Floats, around: Surroundings, rng: np.random.Generator) -> Pocket:
    """Return a pocket around a tip."""
    x, y, _ = tip - around.base
    angle = np.arctan2(y, x) + rng.uniform(-TURNED, TURNED)
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    if rng.random() < UPWARDS:
        turn = turn @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    half = around.reach * rng.uniform(_LEAST, _MOST)
    centre = tip - turn @ (half * rng.uniform(-0.5, 0.5, 3))
    sizes = np.where(_SIDES == 0.0, half, WALL * around.reach)
    return Pocket(centre, turn, half, _SIDES * half, sizes)
