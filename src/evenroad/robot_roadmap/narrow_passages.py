"""Hard queries in random narrow passages, and the configurations that can be joined to them.

Where a roadmap fails, none of its milestones is visible from a start or goal.  So milestones are chosen for hard
queries of no particular task: the tip of the robot is inside random boxes of five walls, anywhere within its reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._threads import in_order
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.kinematics import capsule_endpoints, link_poses
from evenroad.robot_roadmap.free_probability import Surroundings

HALF_EXTENTS = ((0.12, 0.25), (0.1, 0.22), (0.1, 0.22))
"""Ranges of a passage's half depth, half width and half height, as shares of the reach."""

_LEAST, _MOST = np.transpose(HALF_EXTENTS)
_SIDES = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])

WALL = 0.01
"""Half of the thickness of a wall, as a share of the reach."""

UPWARDS = 0.3
"""Share of the passages that are open above; the others open towards the robot, turned by up to TURNED [rad]."""

TURNED = 0.7

INSIDE = 0.7
"""Largest distance of the tip from a passage's centre, as a share of its half extents."""

IN_ONE = 4
"""Largest number of queries in one passage."""

FIRST = 2048
"""Number of first candidates that each query is tried to be joined to at any distance."""

NEAR = 1000
"""Number of nearest candidates, of those that follow, that each query is tried to be joined to, too."""

STEP = 0.3
"""Resolution of the motions that are tried; nothing is proved here [rad]."""

EARLY = (0.05, 0.1, 0.2)
"""Shares of a motion at which it is checked first: most that leave a passage touch its walls at once."""

BATCH = 64
"""Number of passages that are drawn at once."""

MOST_SEEN, FEWEST = 6 * 10**7, 50
"""Number of pairs of capsules on all visible motions after which no more queries follow, if there are at
least FEWEST."""

TRIES = 40
"""Largest number of passages for each wanted query."""

ALONG = 3
"""Number of points along a capsule's axis that find most passages that it touches."""

STILL = 1e-3
"""Distance up to which a tip counts as not moving [m]."""


class Visibility(NamedTuple):
    """Visibility of configurations from queries: that of row ``own[e]`` sees ``which[first[e]:first[e + 1]]``."""

    own: Ints
    first: Ints
    which: Ints


def no_visibility() -> Visibility:
    """Return the visibility of no query."""
    nothing = np.empty(0, dtype=np.int64)
    return Visibility(nothing, np.zeros(1, dtype=np.int64), nothing)


def hard_queries(
    robot: Robot,
    cell: Scene,
    pool: Floats,
    scaled: Floats,
    candidates: Ints,
    count: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] = lambda _: None,
) -> Visibility:
    """Return which candidates are visible from `count` random hard queries; fewer where hardly any is free.

    Queries and candidates are rows of a pool, (n, dim).  `scaled` is the pool in the metric that decides which
    candidates are near.
    """
    if not count:
        return no_visibility()
    around = Surroundings.of(robot, pool)
    tips = tips_of(robot, pool)
    body, radii = body_of(robot, pool)
    bare, inside = replace(robot, pairs=()), ArmWorld(robot, cell, resolution=STEP)
    pool = inside.space.wrapped(pool)
    # Threads share this: it is made before they start.
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
                # The pool is free of these already.
                world = ArmWorld(bare, batch.walls(i), resolution=STEP)
                if not world.valid(pool[own : own + 1])[0]:
                    continue
                others = np.flatnonzero(batch.holds(i, tips[:, which[i]]))
                others = rng.permutation(others[world.valid(pool[others])])[: IN_ONE - 1]
                for end in np.unique(np.append(others, own))[: count - len(own_of)].tolist():
                    own_of.append(end)
                    yield world, end

    found: list[Ints] = []
    pairs = 0
    for seen in in_order(lambda world, end: _seen(world, inside, pool, scaled, candidates, end), queries()):
        found.append(seen)
        pairs += len(seen) * len(robot.pairs)
        progress(min(max(len(found) / count, pairs / MOST_SEEN), 1.0))
        if pairs > MOST_SEEN and len(found) >= FEWEST:
            break
    if not found:
        return no_visibility()
    return Visibility(np.array(own_of[: len(found)]), np.cumsum([0, *map(len, found)]), np.concatenate(found))


def _seen(world: ArmWorld, inside: ArmWorld, pool: Floats, scaled: Floats, candidates: Ints, end: int) -> Ints:
    """Return which candidates a straight motion joins to a query, except itself: of the first ones and the near ones.

    `world` has the passage alone, `inside` robot and static scene; `scaled` is (dim, n).
    """
    first, later = candidates[:FIRST], candidates[FIRST:]
    if len(later) > NEAR:
        squared = np.zeros(len(later))
        for positions in scaled:
            apart = positions[later] - positions[end]
            apart *= apart
            squared += apart
        later = later[np.argpartition(squared, NEAR)[:NEAR]]
    return joined_to(world, inside, pool, end, np.append(first, later))


def joined_to(passage: ArmWorld, inside: ArmWorld, pool: Floats, end: int, rows: Ints) -> Ints:
    """Return which of some rows of a pool, (n, dim), a straight motion joins to the row `end`.

    The query is free of the passage, and the whole pool is free in `inside`, with robot and static scene.
    """
    rows = rows[rows != end]
    towards = passage.space.flat.difference(pool[end], pool[rows])
    for share in EARLY:
        free = passage.valid(pool[end] + share * towards)
        rows, towards = rows[free], towards[free]
    for world in (passage, inside):
        rows = rows[world.motion_valid(np.broadcast_to(pool[end], (len(rows), pool.shape[1])), pool[rows])]
    return rows


def last_links(robot: Robot) -> list[int]:
    """Return the numbers of the links that carry no other."""
    carrying = {joint.parent for joint in robot.joints}
    return [i for i, link in enumerate(robot.links) if link not in carrying]


def tips_of(robot: Robot, pool: Floats) -> Floats:
    """Return the positions of the moving last links, (n, tips, 3) [m]."""
    positions = np.concatenate(
        [link_poses(robot, q)[..., :3, 3] for q in np.array_split(pool, -(-len(pool) // 10_000))]
    )
    return positions[:, [i for i in last_links(robot) if np.ptp(positions[:, i], axis=0).max() > STILL]]


def body_of(robot: Robot, pool: Floats) -> tuple[Floats, Floats]:
    """Return points along the axes of all capsules, (n, points, 3), and their radii, (points,) [m]."""
    endpoints = np.concatenate([capsule_endpoints(robot, q) for q in np.array_split(pool, -(-len(pool) // 10_000))])
    share = np.linspace(0.0, 1.0, ALONG)[:, np.newaxis]
    positions = endpoints[:, :, np.newaxis, 0] * (1.0 - share) + endpoints[:, :, np.newaxis, 1] * share
    return positions.reshape(len(pool), -1, 3), np.repeat([each.radius for each in robot.capsules], ALONG)


class Passages(NamedTuple):
    """Boxes without their sides to -x: centres, (m, 3), axes, (m, 3, 3), and the same as quaternions, (m, 4), half
    extents, (m, 3), positions and half extents of their walls, (m, 5, 3) each.
    """

    centre: Floats
    turn: Floats
    xyzw: Floats
    half: Floats
    positions: Floats
    sizes: Floats

    def touched_by(self, body: Floats, radii: Floats) -> Bools:
        """Return which passages have a wall nearer to one of some points, (m, n, 3), than its radius, (n,): (m,).

        It needs no world.
        """
        apart = np.einsum("mni,mij->mnj", body - self.centre[:, np.newaxis], self.turn)[:, :, np.newaxis]
        apart = np.abs(apart - self.positions[:, np.newaxis]) - self.sizes[:, np.newaxis]
        apart = np.maximum(apart, 0.0, out=apart)
        squared = np.einsum("mnwk,mnwk->mnw", apart, apart).min(axis=2)
        touched: Bools = (squared < radii * radii).any(axis=1)
        return touched

    def holds(self, i: int, positions: Floats) -> Bools:
        """Return which points, (n, 3), are well inside a passage."""
        x, y, z = (np.abs((positions - self.centre[i]) @ self.turn[i]) < INSIDE * self.half[i]).T
        inside: Bools = x & y & z
        return inside

    def walls(self, i: int) -> Scene:
        """Return the walls of a passage."""
        centres = self.centre[i] + self.positions[i] @ self.turn[i].T
        turned = np.broadcast_to(self.xyzw[i], (len(centres), 4))
        return Scene.of_boxes(2.0 * self.sizes[i], centres, xyzw=turned, name="narrow passage")


def passages_around(tips: Floats, around: Surroundings, rng: np.random.Generator) -> Passages:
    """Return a passage around each tip, (m, 3)."""
    x, y, _ = (tips - around.base).T
    angle = np.arctan2(y, x) + rng.uniform(-TURNED, TURNED, len(tips))
    turn = np.zeros((len(tips), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    above = rng.random(len(tips)) < UPWARDS
    # A quarter of a turn about y: what would open towards the robot opens above.
    turn[above] = turn[above] @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    sine, cosine, nothing = np.sin(0.5 * angle), np.cos(0.5 * angle), np.zeros(len(tips))
    xyzw = np.where(above, (-sine, cosine, sine, cosine), (nothing, nothing, sine, cosine)).T
    half = around.reach * rng.uniform(_LEAST, _MOST, (len(tips), 3))
    off = half * rng.uniform(-0.5, 0.5, (len(tips), 3))
    centre = tips - np.einsum("mij,mj->mi", turn, off)
    half_walls = half[:, np.newaxis]
    sizes = np.where(_SIDES == 0.0, half_walls, WALL * around.reach)
    return Passages(centre, turn, xyzw, half, _SIDES * half_walls, sizes)
