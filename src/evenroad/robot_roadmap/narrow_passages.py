"""Hard queries in random narrow passages, and the configurations that can be joined to them.

Where a roadmap fails, a start or goal sees none of its milestones.  So milestones learn from ends that no task has
shown: the tip of the robot in boxes of five walls, anywhere that it gets to.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._threads import in_order
from evenroad.robot import ArmWorld, Obstacle, Robot, Scene
from evenroad.robot.kinematics import capsule_endpoints, link_poses
from evenroad.robot_roadmap.free_probability import Surroundings

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

FIRST = 4096
"""Configurations that each end is tried to be joined to: the first ones, wherever they are, so that what is seen from
afar counts as well."""

NEAR = 1500
"""And the nearest of those that follow."""

STEP = 0.2
"""Of the motions that are tried; nothing is proved here [rad]."""

EARLY = 0.1
"""How far along a motion it is checked first: most that leave a pocket touch its walls at once."""

BATCH = 64
"""Pockets that are drawn at once."""

MOST_SEEN, FEWEST = 6 * 10**7, 50
"""Pairs of capsules on all motions to what ends see: no more ends follow then, if there are that many."""

TRIES = 40
"""Pockets for each end that is wanted, at most."""

ALONG = 3
"""Places along a capsule's axis that tell most pockets that it touches."""

STILL = 1e-3
"""A tip that does not move so far moves not at all [m]."""


class Visibility(NamedTuple):
    """Which configurations ends can be joined to: the end ``own[e]`` to ``which[first[e]:first[e + 1]]``."""

    own: Ints
    first: Ints
    which: Ints


def no_visibility() -> Visibility:
    """Return what no end sees."""
    nothing = np.empty(0, dtype=np.int64)
    return Visibility(nothing, np.zeros(1, dtype=np.int64), nothing)


def hard_queries(
    robot: Robot,
    cell: Scene,
    pool: Floats,
    scaled: Floats,
    count: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] = lambda _: None,
) -> Visibility:
    """Return what `count` ends in pockets at random see of a pool, (n, dim); fewer where hardly any is free.

    `scaled` is the pool in the metric that tells which configurations are near.
    """
    if not count:
        return no_visibility()
    around = Surroundings.of(robot, pool)
    tips = tips_of(robot, pool)
    body, radii = body_of(robot, pool)
    bare, inside = replace(robot, pairs=()), ArmWorld(robot, cell, resolution=STEP)
    pool = inside.space.wrapped(pool)
    # What threads share is made before there are any.
    inside.valid(pool[:1])
    scaled = np.ascontiguousarray(scaled.T)
    own_of: list[int] = []

    def queries() -> Iterator[tuple[ArmWorld, int]]:
        drawn = TRIES * count if tips.shape[1] else 0
        while len(own_of) < count and drawn > 0:
            owns, which = rng.integers(len(pool), size=BATCH), rng.integers(tips.shape[1], size=BATCH)
            drawn -= BATCH
            batch = passages_around(tips[owns, which], around, rng)
            for i in np.flatnonzero(~batch.touched_by(body[owns], radii)).tolist():
                if len(own_of) == count:
                    return
                own = int(owns[i])
                # What the pool is free of already is not asked about again.
                world = ArmWorld(bare, Scene(batch.walls(i), name="pocket"), resolution=STEP)
                if not world.valid(pool[own : own + 1])[0]:
                    continue
                others = np.flatnonzero(batch.holds(i, tips[:, which[i]]))
                others = rng.permutation(others[world.valid(pool[others])])[: IN_ONE - 1]
                for end in np.unique(np.append(others, own))[: count - len(own_of)].tolist():
                    own_of.append(end)
                    yield world, end

    found: list[Ints] = []
    pairs = 0
    for seen in in_order(lambda world, end: _seen(world, inside, pool, scaled, end), queries()):
        found.append(seen)
        pairs += len(seen) * len(robot.pairs)
        progress(min(max(len(found) / count, pairs / MOST_SEEN), 1.0))
        if pairs > MOST_SEEN and len(found) >= FEWEST:
            break
    if not found:
        return no_visibility()
    return Visibility(np.array(own_of[: len(found)]), np.cumsum([0, *map(len, found)]), np.concatenate(found))


def _seen(world: ArmWorld, inside: ArmWorld, pool: Floats, scaled: Floats, end: int) -> Ints:
    """Return which configurations a straight motion joins to an end, itself left out: of the first ones and those near.

    `world` has the pocket alone, `inside` robot and cell; `scaled` is (dim, n).
    """
    later = np.arange(FIRST, len(pool))
    if len(later) > NEAR:
        squared = np.zeros(len(later))
        for positions in scaled:
            apart = positions[FIRST:] - positions[end]
            apart *= apart
            squared += apart
        later = np.argpartition(squared, NEAR)[:NEAR] + FIRST
    rows = np.append(np.arange(min(FIRST, len(pool))), later)
    return joined_to(world, inside, pool, end, rows)


def joined_to(passage: ArmWorld, inside: ArmWorld, pool: Floats, end: int, rows: Ints) -> Ints:
    """Return which of some rows of a pool, (n, dim), a straight motion joins to the row `end`.

    The end is free of the pocket, all of the pool of what is `inside`, robot and static scene.
    """
    rows = rows[rows != end]
    here = np.broadcast_to(pool[end], (len(rows), pool.shape[1]))
    free = passage.valid(passage.space.interpolate(here, pool[rows], EARLY))
    for world in (passage, inside):
        free[free] = world.motion_valid(here[free], pool[rows[free]])
    return rows[free]


def last_links(robot: Robot) -> list[int]:
    """Return the numbers of the links that carry no other."""
    carrying = {joint.parent for joint in robot.joints}
    return [i for i, link in enumerate(robot.links) if link not in carrying]


def tips_of(robot: Robot, pool: Floats) -> Floats:
    """Return the places of the links that carry no other and move, (n, tips, 3) [m]."""
    positions = np.concatenate(
        [link_poses(robot, q)[..., :3, 3] for q in np.array_split(pool, -(-len(pool) // 10_000))]
    )
    return positions[:, [i for i in last_links(robot) if np.ptp(positions[:, i], axis=0).max() > STILL]]


def body_of(robot: Robot, pool: Floats) -> tuple[Floats, Floats]:
    """Return places along the axes of all capsules, (n, places, 3), and their radii, (places,) [m]."""
    endpoints = np.concatenate(
        [capsule_endpoints(robot, q) for q in np.array_split(pool, -(-len(pool) // 10_000))]
    )
    share = np.linspace(0.0, 1.0, ALONG)[:, np.newaxis]
    positions = endpoints[:, :, np.newaxis, 0] * (1.0 - share) + endpoints[:, :, np.newaxis, 1] * share
    return positions.reshape(len(pool), -1, 3), np.repeat([each.radius for each in robot.capsules], ALONG)


class Passages(NamedTuple):
    """Boxes without their sides to -x: centres, (m, 3), axes, (m, 3, 3), half extents, (m, 3), places and half extents
    of their walls, (m, 5, 3) each.
    """

    centre: Floats
    turn: Floats
    half: Floats
    positions: Floats
    sizes: Floats

    def touched_by(self, body: Floats, radii: Floats) -> Bools:
        """Return of which pockets a wall is nearer to one of some places, (m, n, 3), than its radius, (n,): (m,).

        What costs no world.
        """
        apart = np.einsum("mni,mij->mnj", body - self.centre[:, np.newaxis], self.turn)[:, :, np.newaxis]
        apart = np.abs(apart - self.positions[:, np.newaxis]) - self.sizes[:, np.newaxis]
        apart = np.maximum(apart, 0.0, out=apart)
        squared = np.einsum("mnwk,mnwk->mnw", apart, apart).min(axis=2)
        touched: Bools = (squared < radii * radii).any(axis=1)
        return touched

    def holds(self, i: int, positions: Floats) -> Bools:
        """Return which places, (n, 3), are well inside of a pocket."""
        x, y, z = (np.abs((positions - self.centre[i]) @ self.turn[i]) < INSIDE * self.half[i]).T
        inside: Bools = x & y & z
        return inside

    def walls(self, i: int) -> tuple[Obstacle, ...]:
        """Return the walls of a pocket as obstacles."""
        axes = tuple(self.turn[i].ravel().tolist())
        return tuple(
            Obstacle.of(
                f"wall {number} of a pocket",
                "box",
                (2.0 * size).tolist(),
                (self.centre[i] + self.turn[i] @ position).tolist(),
                axes,
            )
            for number, (position, size) in enumerate(zip(self.positions[i], self.sizes[i], strict=True))
        )


def passages_around(tips: Floats, around: Surroundings, rng: np.random.Generator) -> Passages:
    """Return a pocket around each tip, (m, 3)."""
    x, y, _ = (tips - around.base).T
    angle = np.arctan2(y, x) + rng.uniform(-TURNED, TURNED, len(tips))
    turn = np.zeros((len(tips), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    above = rng.random(len(tips)) < UPWARDS
    turn[above] = turn[above] @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    half = around.reach * rng.uniform(_LEAST, _MOST, (len(tips), 3))
    off = half * rng.uniform(-0.5, 0.5, (len(tips), 3))
    centre = tips - np.einsum("mij,mj->mi", turn, off)
    half_walls = half[:, np.newaxis]
    sizes = np.where(_SIDES == 0.0, half_walls, WALL * around.reach)
    return Passages(centre, turn, half, _SIDES * half_walls, sizes)
