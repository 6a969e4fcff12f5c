"""Hard queries in random narrow passages, and the configurations that can be joined to them.

Where a roadmap fails, none of its milestones is visible from a start or goal.  So milestones are chosen for hard
queries of no particular task: the tip of the robot is inside random boxes of five walls, anywhere within its reach.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._native.robot import Checker
from evenroad._native.robot_roadmap import rows_joined
from evenroad._threads import in_order
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.kinematics import capsule_endpoints, link_poses
from evenroad.robot_roadmap.free_probability import Surroundings, among

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

OWNERS = 4096
"""Number of configurations, the first of a pool, that passages are put around."""

EARLY = np.array([0.05, 0.1, 0.2])
"""Shares of a motion at which it is checked first: most that leave a passage touch its walls at once.  Those that do
not are checked at sixteen states; nothing is proved here.
"""

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
    candidates: Ints,
    count: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] = lambda _: None,
) -> Visibility:
    """Return which candidates are visible from `count` random hard queries; fewer where hardly any is free.

    Queries and candidates are rows of a pool, (n, dim).
    """
    if not count:
        return no_visibility()
    around, tips, inside = Surroundings.of(robot, pool), tips_of(robot, pool[:OWNERS]), ArmWorld(robot, cell)
    body, radii = body_of(robot, pool[:OWNERS])
    pool = inside.space.wrapped(pool)

    def queries() -> Iterator[tuple[list[Checker], list[int]]]:
        """Yield passages and rows in them, some at once; a passage of several rows comes several times."""
        drawn, given = TRIES * count if tips.shape[1] else 0, 0
        while given < count and drawn > 0:
            owns, which = rng.integers(len(tips), size=BATCH), rng.integers(tips.shape[1], size=BATCH)
            drawn -= BATCH
            passages, own_rows = list[Checker](), list[int]()
            batch = passages_around(tips[owns, which], around, rng)
            for i in np.flatnonzero(~batch.touched_by(body[owns], radii)).tolist():
                if given + len(own_rows) == count:
                    break
                # The pool is free of robot and static scene already.
                passage = among(inside.robot, batch.walls(i))
                own = int(owns[i])
                if passage.valid(pool[own]):
                    others = np.flatnonzero(batch.holds(i, tips[:, which[i]]))
                    others = rng.permutation(others[passage.valid(pool[others])])[: IN_ONE - 1]
                    within = sorted({own, *others.tolist()})[: count - given - len(own_rows)]
                    own_rows += within
                    passages += [passage] * len(within)
            if own_rows:
                given += len(own_rows)
                yield passages, own_rows

    def seen(passages: list[Checker], own_rows: list[int]) -> Iterator[tuple[int, Ints]]:
        """Return queries, each with the candidates that straight motions join to it."""
        counts, rows = rows_joined(passages, inside.checker, pool, np.array(own_rows), candidates, EARLY)
        return zip(own_rows, np.split(rows, np.cumsum(counts)[:-1]), strict=True)

    own_of, found, pairs = list[int](), list[Ints](), 0
    for end, rows in chain.from_iterable(in_order(seen, queries())):
        own_of.append(end)
        found.append(rows)
        pairs += len(rows) * len(robot.pairs)
        progress(min(max(len(found) / count, pairs / MOST_SEEN), 1.0))
        if pairs > MOST_SEEN and len(found) >= FEWEST:
            break
    if not found:
        return no_visibility()
    return Visibility(np.array(own_of), np.cumsum([0, *map(len, found)]), np.concatenate(found))


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
    """Boxes without their sides to -x: centres, (m, 3), axes, (m, 3, 3), half extents, (m, 3), and positions and half
    extents of their walls, (m, 5, 3) each.
    """

    centre: Floats
    turn: Floats
    half: Floats
    positions: Floats
    sizes: Floats

    def touched_by(self, body: Floats, radii: Floats) -> Bools:
        """Return which passages have a wall nearer to one of some points, (m, n, 3), than its radius, (n,): (m,).

        It needs no world.  The last points, farthest from the base, touch most often: they are looked at first.
        """
        touched = np.zeros(len(body), dtype=np.bool_)
        half = len(radii) // 2
        for some in (slice(half, None), slice(half)):
            rest = np.flatnonzero(~touched)
            touched[rest] = self._touched_by(rest, body[rest, some], radii[some])
        return touched

    def _touched_by(self, which: Ints, body: Floats, radii: Floats) -> Bools:
        """Return which of some passages have a wall nearer to a point than its radius."""
        there = np.matmul(body - self.centre[which, np.newaxis], self.turn[which])
        squared = np.zeros((*there.shape[:2], len(_SIDES)))
        for along in range(3):
            apart = np.abs(there[:, :, np.newaxis, along] - self.positions[which, np.newaxis, :, along])
            apart -= self.sizes[which, np.newaxis, :, along]
            squared += np.square(np.maximum(apart, 0.0, out=apart))
        touched: Bools = np.any(squared < (radii * radii)[:, np.newaxis], axis=(1, 2))
        return touched

    def holds(self, i: int, positions: Floats) -> Bools:
        """Return which points, (n, 3), are well inside a passage."""
        x, y, z = (np.abs((positions - self.centre[i]) @ self.turn[i]) < INSIDE * self.half[i]).T
        inside: Bools = x & y & z
        return inside

    def walls(self, i: int) -> Floats:
        """Return the walls of a passage as boxes, (5, 17), see :func:`evenroad.robot.obstacle.box_rows`."""
        rows = np.zeros((len(_SIDES), 17))
        rows[:, 1:4], rows[:, 4:13] = 2.0 * self.sizes[i], self.turn[i].reshape(9)
        rows[:, 13:16] = self.centre[i] + self.positions[i] @ self.turn[i].T
        return rows


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
    half = around.reach * rng.uniform(_LEAST, _MOST, (len(tips), 3))
    off = half * rng.uniform(-0.5, 0.5, (len(tips), 3))
    centre = tips - np.einsum("mij,mj->mi", turn, off)
    half_walls = half[:, np.newaxis]
    sizes = np.where(_SIDES == 0.0, half_walls, WALL * around.reach)
    return Passages(centre, turn, half, _SIDES * half_walls, sizes)
