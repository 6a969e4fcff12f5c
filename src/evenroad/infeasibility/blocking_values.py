"""Walls: values of one joint at which two links overlap for all values of the other joints.

No path passes a wall, because a joint takes all values between its first and last.  If two joints move a pair of links
relative to each other, a proof needs cells of only one of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._time_limit import look_at_clock, require_time_for
from evenroad.collision.prepared_robots import joint_space
from evenroad.geometry.hulls import Hull
from evenroad.infeasibility.prefix_cells import BEYOND, SLACK, Cells, Piece
from evenroad.robots.hull_trees import HullTrees, contacts, hull_trees
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot

_VALUES = 128
"""Number of values of a joint to try."""
_FIRST, _CELLS = 8, 512
"""Numbers of cells of the other joint that moves the pair: `_FIRST` to choose a value, `_CELLS` to prove it a wall."""
_MOST_POINTS = 8
"""Largest number of common points of the two links to try; each lies in both links in some of these cells."""
_ALONG, _AROUND = 64, 2_000
"""Number of cells between two walls along their joint, and number of all cells."""


def pieces_between_walls(robot: Robot, start: Floats) -> Iterator[tuple[int, Piece]]:
    """Yield coordinates that have walls, each with all cells that a path from a start, (dim,), may reach."""
    space = joint_space(robot)
    period = space.flat.period
    for k, walls in enumerate(map(np.array, walls_of(robot))):
        if not len(walls):
            continue
        low, high = np.array(space.low) - BEYOND, np.array(space.high) + BEYOND
        if np.isfinite(period[k]):
            above = np.mod(walls - start[k], period[k])
            low[k], high[k] = start[k] + above.max() - period[k], start[k] + above.min()
        else:
            low[k] = walls[walls < start[k]].max(initial=low[k])
            high[k] = walls[walls > start[k]].min(initial=high[k])
        count = np.full(k + 1, max(1, int((_AROUND / _ALONG) ** (1 / max(k, 1)))))
        count[k] = _ALONG
        cells = Cells(low[: k + 1], high[: k + 1], count, period[: k + 1])
        yield k, Piece(cells, np.ones(count, dtype=np.bool_))


def walls_of(robot: Robot) -> tuple[tuple[float, ...], ...]:
    """Return the walls of each coordinate, in order [rad or m]; they are cached.

    The search covers tested pairs of links that have solid hulls, and that one or two joints move relative to each
    other.
    """
    held = tuple(sorted(robot.held.items()))
    return _walls_of(robot.links, robot.joints, robot.pairs, robot.group, robot.hulls, held)


@lru_cache(maxsize=8)
def _walls_of(
    links: tuple[str, ...],
    joints: tuple[Joint, ...],
    pairs: tuple[tuple[str, str], ...],
    group: tuple[str, ...],
    hulls: tuple[Hull, ...],
    held: tuple[tuple[str, float], ...],
) -> tuple[tuple[float, ...], ...]:
    robot = Robot("", links, joints, (), pairs, group, dict(held), hulls=hulls)
    solid: dict[str, list[Hull]] = {}
    for hull in hulls:
        if hull.solid:
            solid.setdefault(hull.link, []).append(hull)
    trees = hull_trees({link: [(hull.points[np.newaxis], 0.0) for hull in of] for link, of in solid.items()})
    walls: list[list[float]] = [[] for _ in group]
    for first, second in pairs:
        look_at_clock()
        moving = _between(robot, first, second) if first in solid and second in solid else []
        for k in {coordinate for _, coordinate in moving}:
            others = [each for each in moving if each[1] != k]
            # A joint that mimics another one has its own axis.
            if len(others) < 2 and not any(joint.mimic for joint, _ in others):
                pair = _Pair(robot, (first, second), (solid[first], solid[second]), trees, k, *others)
                walls[k] += pair.walls()
    return tuple(tuple(sorted(set(each))) for each in walls)


def _between(robot: Robot, first: str, second: str) -> list[tuple[Joint, int]]:
    """Return the joints that move two links relative to each other, each with its coordinate."""
    above = {joint.child: joint for joint in robot.joints}
    number = {name: k for k, name in enumerate(robot.group)}
    chains = []
    for link in (first, second):
        chain = set()
        while link in above:
            chain.add(above[link])
            link = above[link].parent
        chains.append(chain)
    leaders = [(joint, joint.mimic.joint if joint.mimic else joint.name) for joint in chains[0] ^ chains[1]]
    return [(joint, number[name]) for joint, name in leaders if name in number and joint.kind != "fixed"]


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two tested links, their solid hulls, the coordinate `k`, and the other joint that moves them, if any."""

    robot: Robot
    links: tuple[str, str]
    solid: tuple[list[Hull], list[Hull]]
    trees: HullTrees
    k: int
    other: tuple[Joint, int] | None = None

    def walls(self) -> list[float]:
        """Return values of the coordinate at which the two overlap for all values of the other joint."""
        space = joint_space(self.robot)
        values = np.linspace(space.low[self.k], space.high[self.k], _VALUES)
        meet = self._in_middles(values, _FIRST)[2][:, 0].reshape(_VALUES, -1) >= 0
        turns = np.diff(np.concatenate([[False], meet.all(axis=1), [False]]).astype(int))
        middles = (np.flatnonzero(turns > 0) + np.flatnonzero(turns < 0)) // 2
        return [float(value) for value in values[middles] if self._is_wall(value)]

    def _in_middles(self, values: Floats, count: int) -> tuple[float, Floats, Ints]:
        """Return half a cell of the other joint, the links' poses in the middles, and the hulls that seem to overlap.

        The poses, (n, links, 4, 4), are those of the first value, then those of the next.
        """
        space, half = joint_space(self.robot), 0.0
        low, high = np.array(space.low), np.array(space.high)
        q = np.tile(0.5 * (low + high), (len(values), count if self.other else 1, 1))
        q[:, :, self.k] = values[:, np.newaxis]
        if self.other:
            at = self.other[1]
            half = float(0.5 * (high - low)[at] + BEYOND) / count
            q[:, :, at] += half * (2.0 * np.arange(count) + 1.0 - count)
        poses = link_poses(self.robot, q.reshape(-1, len(low)))
        first, second = (poses[:, self.robot.links.index(link)] for link in self.links)
        return half, poses, contacts(self.trees, *self.links, first, second)

    def _is_wall(self, value: float) -> bool:
        """Return whether the two have a point in common for all values of the other joint.

        Take a point that is fixed to one hull.  Within a cell it moves in the other hull's frame by at most half a cell
        times its distance from the joint's axis.  If it is deeper than that in the other hull in the middle of the
        cell, it lies in both hulls throughout the cell.
        """
        half, poses, met = self._in_middles(np.array([value]), _CELLS)
        left = np.ones(len(poses), dtype=np.bool_)
        for _ in range(_MOST_POINTS):
            look_at_clock()
            # Hulls that seem to overlap only show where to look.
            cell = int(left.argmax())
            hulls = [of[number] for of, number in zip(self.solid, met[cell], strict=True)]
            for still, other in (hulls, hulls[::-1]):
                at, of = (poses[:, self.robot.links.index(hull.link)] for hull in (still, other))
                start = np.linalg.solve(at, of)
                point = _deepest(other, still, start[cell])
                deep = half * self._speed(poses[cell], still, point) + SLACK
                in_other = np.einsum("nj,njk->nk", point - start[:, :3, 3], start[:, :3, :3])
                left &= (_depths(other, in_other) < deep) | (_depths(still, point) < SLACK)
            if left[cell] or not left.any():
                break
        return not left.any()

    def _speed(self, poses: Floats, hull: Hull, point: Floats) -> float:
        """Return the speed of a point of a hull, (1, 3), past the other link by the other joint [m/rad or m/m]."""
        if self.other is None or self.other[0].kind == "prismatic":
            return 1.0
        joint, link = (poses[self.robot.links.index(link)] for link in (self.other[0].child, hull.link))
        in_joint = np.linalg.solve(joint, link)
        return float(np.linalg.norm(np.cross(self.other[0].axis, point @ in_joint[:3, :3].T + in_joint[:3, 3])))


def _deepest(other: Hull, still: Hull, pose: Floats) -> Floats:
    """Return the point, (1, 3), of a hull that is deepest in another hull with this pose in its frame.

    The proof does not rely on the solver's answer.
    """
    require_time_for("scipy.optimize")
    from scipy.optimize import linprog

    own, sides = _sides(other), _sides(still)
    turned = own[:, :3] @ pose[:3, :3].T
    rows = np.concatenate([np.c_[turned, np.ones(len(own))], np.c_[sides[:, :3], np.zeros(len(sides))]])
    limits = np.concatenate([turned @ pose[:3, 3] - own[:, 3], -sides[:, 3] - 2.0 * SLACK])
    found = linprog([0.0, 0.0, 0.0, -1.0], A_ub=rows, b_ub=limits, bounds=[(None, None)] * 4)
    return np.zeros((1, 3)) if found.x is None else found.x[np.newaxis, :3]


def _depths(hull: Hull, points: Floats) -> Floats:
    """Return the depths of points, (n, 3), in a hull; negative outside (n,) [m]."""
    sides = _sides(hull)
    outside: Floats = (points @ sides[:, :3].T + sides[:, 3]).max(axis=1)
    return -outside


@lru_cache(maxsize=64)
def _sides(hull: Hull) -> Floats:
    """Return the planes around a hull's points, (f, 4)."""
    from scipy.spatial import ConvexHull

    return np.asarray(ConvexHull(hull.points).equations)
