"""Chain: the joints between a robot's root and one of its links, for compiled code."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._checks import require_known
from evenroad._native import robot as kernel
from evenroad.collision.prepared_robots import prepared
from evenroad.collision.robot_tables import RobotTables
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.points.reversed_halton import cube_points
from evenroad.poses.pose_task import PoseTask
from evenroad.robots.moving_tree import MovingFrame, MovingTree
from evenroad.robots.robot import Robot

TURN = 2.0 * math.pi

_EVEN = 2048
"""Number of configurations with known tips: numeric solutions begin at the nearest ones."""

STEPS = 60
"""Largest number of steps of a numeric solution."""


@dataclass(frozen=True, eq=False)
class Chain:
    """The frames that carry a tip, from the root on."""

    tip: str
    """The link."""
    group: tuple[str, ...]
    """The coordinates."""
    frames: tuple[MovingFrame, ...]
    coordinates: Ints
    """Coordinate of each frame that carries the tip, (k,)."""
    slides: Bools
    """Which of them slide, (k,)."""
    rows: Floats
    """Rotation (9) and translation (3) in the frame before, multiplier and offset; last the tip's, (k + 1, 14)."""
    low: Floats
    high: Floats
    """Limits; infinite for a coordinate that can make a whole turn, because turns are added later."""
    bounds: Floats
    """Limits as they are, (2, dim); -pi and pi for coordinates that wrap."""
    turns: Bools
    """Which coordinates are in the same posture after a whole turn."""

    @cached_property
    def moving(self) -> Ints:
        """Coordinates that move the tip."""
        return np.unique(self.coordinates)

    @cached_property
    def still(self) -> Ints:
        """Coordinates that do not."""
        return np.setdiff1d(np.arange(len(self.group)), self.moving)

    @cached_property
    def even(self) -> tuple[Floats, Floats]:
        """Even configurations, (n, dim), and where they have the tip, (n, 12)."""
        low, high = np.maximum(self.low, self.bounds[0]), np.minimum(self.high, self.bounds[1])
        width = np.where(self.turns, np.minimum(high - low, TURN), high - low)
        middle = np.where(
            self.turns & (high - low > TURN), np.clip(0.0, low + math.pi, high - math.pi), 0.5 * (low + high)
        )
        q = np.repeat(middle[np.newaxis], _EVEN, axis=0)
        points = cube_points(len(self.moving))[:_EVEN]
        q[:, self.moving] += (points - 0.5) * width[self.moving]
        return q, self.tip_poses(q)

    @cached_property
    def slides_by(self) -> Floats:
        """Largest distance of each frame that slides from its place at 0, (k,) [m]; 0 for one that turns."""
        extremes = [np.abs(self.bounds[:, f.coordinate] * f.multiplier + f.offset).max() for f in self.frames]
        return np.where(self.slides, extremes, 0.0)

    @cached_property
    def arms(self) -> Floats:
        """Bounds on the distance of the tip from each joint that turns, (k,) [m]; 1 for one that slides."""
        offsets = np.linalg.norm(self.rows[1:, 9:12], axis=1)
        beyond = np.cumsum((offsets + np.append(self.slides_by[1:], 0.0))[::-1])[::-1]
        return np.where(self.slides, 1.0, beyond)

    @cached_property
    def native(self) -> kernel.Chain:
        """The chain for compiled code."""
        return kernel.Chain(self.coordinates, self.slides, self.rows, len(self.group))

    def tip_poses(self, q: Floats) -> Floats:
        """Return poses of the tip at configurations, (n, dim): rotation row by row, and origin, (n, 12)."""
        return self.native.tip_poses(np.ascontiguousarray(q))

    def derivatives(self, q: Floats) -> Floats:
        """Return how the tip moves and turns with each coordinate at configurations, (n, dim): (n, 6, dim)."""
        return self.native.derivatives(np.ascontiguousarray(q))

    def reached(
        self, q: Floats, task: Floats, *, limits: bool = True, steps: int = STEPS, enough: int = 2**31
    ) -> tuple[Floats, Floats]:
        """Return configurations, (n, dim), moved by at most `steps` steps until `enough` reach a task, (22,), and the
        squared errors, (n,).
        """
        within = np.array([self.low, self.high]) if limits else _unlimited(len(self.group))
        return self.native.reach(np.ascontiguousarray(q), task, within, steps, enough)

    def reached_all(
        self,
        start: Floats,
        tasks: Floats,
        pick: tuple[int, int, int],
        *,
        limits: bool = True,
        same: float = 0.0,
        enough: int = 2**31,
    ) -> kernel.Solutions:
        """Return postures that reach tasks, (p, 22).

        Solutions begin at `start`, (dim,), and at those even configurations with the nearest tips that `pick` says:
        from, to below, every.  Of postures of one task that are nearer than `same` the first stays.
        """
        within = np.array([self.low, self.high]) if limits else _unlimited(len(self.group))
        beginnings, postures = (
            kernel.Beginnings(start, *self.even, *pick),
            kernel.Postures(self.turns, self.bounds, same),
        )
        return self.native.reach_all(beginnings, tasks, within, postures, STEPS, enough)

    def followed(self, q: Floats, poses: Floats, longest: float, wraps: Bools, towards: Floats | None = None) -> Floats:
        """Return configurations, (m, dim), that bring the tip through poses, (n, 12): as many as there are.

        The first begins at `q`, (dim,), each at the one before, a share nearer to `towards`, within limits unless a
        joint `wraps`; none steps farther than `longest`.
        """
        within = np.where(wraps, _unlimited(len(self.group)), self.bounds)
        goal = np.empty(0) if towards is None else np.ascontiguousarray(towards)
        return self.native.follow(np.ascontiguousarray(q), goal, PoseTask().row, poses, within, STEPS, longest)

    def reach(self) -> tuple[Floats, float]:
        """Return a point that no joint moves and the largest distance of the tip from it [m]."""
        far = np.linalg.norm(self.rows[1:, 9:12], axis=1) + self.slides_by
        return self.rows[0, 9:12], float(far.sum())


_recent: dict[tuple[int, str], tuple[RobotTables, Chain]] = {}


def chain_of(robot: Robot, tip: str) -> Chain:
    """Return the chain from the root to a link, kept; UnknownName if it is none, InvalidValue if nothing moves it."""
    made = prepared(robot)
    space, tables = made.space, made.tables
    kept = _recent.get((id(tables), tip))
    if kept is not None:
        return kept[1]
    tree = tables.tree
    require_known(f"link of {robot.name!r}:", tip, tree.links)
    frames = _carrying(tree, tree.links[tip].frame)
    if not frames:
        raise InvalidValue(f"no joint of the group, {','.join(robot.group)}, moves the link {tip!r}")
    placement = tree.links[tip]
    rows = np.zeros((len(frames) + 1, 14))
    for row, frame in zip(rows, frames, strict=False):
        row[:] = *frame.rotation.ravel(), *frame.translation, frame.multiplier, frame.offset
    # A link is placed by what takes its points into its frame.
    rows[-1, :12] = *placement.rotation.ravel(), *placement.translation
    coordinates = np.array([frame.coordinate for frame in frames], dtype=np.int64)
    ranges = np.array([space.low, space.high])
    # All that a coordinate moves has to be where it was after a turn, not the tip alone.
    turns = np.ones(len(robot.group), dtype=np.bool_)
    for frame in tree.frames:
        whole = not frame.slides and frame.multiplier == round(frame.multiplier)
        turns[frame.coordinate] &= whole
    full = turns & (ranges[1] - ranges[0] >= TURN - 1e-9)
    chain = Chain(
        tip,
        robot.group,
        frames,
        coordinates,
        np.array([frame.slides for frame in frames], dtype=np.bool_),
        rows,
        np.where(full, -np.inf, ranges[0]),
        np.where(full, np.inf, ranges[1]),
        ranges,
        turns,
    )
    if len(_recent) >= 32:
        _recent.clear()
    _recent[id(tables), tip] = tables, chain
    return chain


def _unlimited(dim: int) -> Floats:
    return np.array([[-math.inf], [math.inf]]).repeat(dim, axis=1)


def _carrying(tree: MovingTree, number: int) -> tuple[MovingFrame, ...]:
    frames: list[MovingFrame] = []
    while number > 0:
        frames.insert(0, tree.frames[number - 1])
        number = frames[0].parent
    return tuple(frames)


def default_tip(robot: Robot) -> str:
    """Return the last link that the group moves, except held ones; InvalidValue if there are several."""
    tree = prepared(robot).tables.tree
    carried = {
        link: len({frame.coordinate for frame in _carrying(tree, placement.frame)})
        for link, placement in tree.links.items()
        if link not in robot.holds
    }
    most, parents = max(carried.values()), {joint.parent for joint in robot.joints if joint.child in carried}
    farthest = [link for link in carried if carried[link] == most]
    leaves = [link for link in farthest if link not in parents] or farthest[-1:]
    if len(leaves) > 1:
        raise InvalidValue(
            f"say of which link the pose is (--tip): at the end of {robot.name!r} are {', '.join(leaves[:8])}"
        )
    return leaves[0]


def frame_pose(robot: Robot, frame: str) -> Pose:
    """Return a link's pose in the frame of the root; InvalidValue if the group moves it, UnknownName if it is not."""
    if not frame or frame == robot.links[0]:
        return IDENTITY
    links = prepared(robot).tables.tree.links
    require_known(f"link of {robot.name!r}:", frame, links)
    placement = links[frame]
    if placement.frame != 0:
        raise InvalidValue(f"the frame of a goal pose must stand still, but the group moves the link {frame!r}")
    return Pose(tuple(placement.translation.tolist()), tuple(placement.rotation.ravel().tolist()))
