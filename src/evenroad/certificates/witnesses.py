"""Witnesses that cells of joints are blocked: a ball inside of one body meets a solid of another one throughout."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.certificates.claim import Claimed, Tree, touching_of, tree_of
from evenroad.errors import NotAvailable
from evenroad.geometry.inner import capsules_inside
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, PointCloud, Shape, Sphere
from evenroad.loading.description import RobotDescription
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene

SPARE = 2e-7
"""What an overlap must have to spare, and by how much balls are smaller than what is inside of shapes [m]."""
_STEP = 0.5
"""Distance of balls along a capsule, as a share of its radius."""
_MOST = 24
"""Largest number of balls along a capsule."""
_AT_ONCE = 1 << 18


@dataclass(frozen=True)
class Body:
    """Shapes of one name, each with its pose in the frame that they are in."""

    name: str
    frame: int
    shapes: tuple[tuple[Shape, Pose], ...]
    is_obstacle: bool
    wider: float = 0.0
    """By how much an obstacle is wider than its shapes: its clearance [m]."""


@dataclass(frozen=True)
class Solids:
    """Solids in frames: boxes, and what is within `radius` of a disc or segment along z; each is of a body.

    `half` are half extents along the rows of `axes`, (n, 3, 3); of a disc or segment the second is the disc's radius.
    Solids that a checker does not take have a negative radius.
    """

    body: Ints
    frame: Ints
    middle: Floats
    axes: Floats
    half: Floats
    radius: Floats
    is_box: Bools

    def distances(self, rows: Ints, points: Floats) -> Floats:
        """Return how far points, (n, 3), in the frames of some solids, are from these; less than 0 inside [m]."""
        local = np.einsum("nij,nj->ni", self.axes[rows], points - self.middle[rows])
        out = np.abs(local) - self.half[rows]
        round_ones = ~self.is_box[rows]
        # The first axis counts for boxes alone.
        out[round_ones, 0] = np.hypot(local[round_ones, 0], local[round_ones, 1]) - self.half[rows[round_ones], 1]
        out[round_ones, 1] = out[round_ones, 0]
        away = np.maximum(out, 0.0)
        away[round_ones, 1] = 0.0
        return np.asarray(np.linalg.norm(away, axis=1) + np.minimum(out.max(axis=1), 0.0) - self.radius[rows])


@dataclass(frozen=True)
class Pairs:
    """Pairs of a ball and a solid, both numbers of solids, with the distance to keep [m].

    `up` and `down`, (pairs, joints), are the joints that move the ball, and the solid, but not both.
    """

    ball: Ints
    solid: Ints
    keep: Floats
    up: Bools
    down: Bools

    def of(self, rows: Ints | Bools) -> Pairs:
        """Return some of the pairs."""
        return Pairs(self.ball[rows], self.solid[rows], self.keep[rows], self.up[rows], self.down[rows])


@dataclass(frozen=True)
class Witnesses:
    """All that may block cells: solids, of which the last `balls` are balls inside of bodies, and pairs of them."""

    robot: Robot
    tree: Tree
    bodies: tuple[Body, ...]
    solids: Solids
    balls: int
    pairs: Pairs

    @property
    def columns(self) -> Bools:
        """Which columns of a configuration move which pair, (pairs, columns)."""
        moves = self.pairs.up | self.pairs.down
        found = np.zeros((len(moves), len(self.robot.group)), dtype=np.bool_)
        for k, (_, _, _, column, _, _) in enumerate(self.tree.moved):
            found[:, column] |= moves[:, k]
        return found


def witnesses_of(robot: Robot, urdf: RobotDescription, scene: Scene, claimed: Claimed) -> Witnesses:
    """Return the witnesses of a robot in a scene: of pairs of bodies of the claim that the robot's planner tests."""
    tree = tree_of(urdf, claimed)
    bodies = _bodies(urdf, scene, tree)
    rows = [
        (number, *_solid(shape, pose, body.wider))
        for number, body in enumerate(bodies)
        for shape, pose in body.shapes
        if not isinstance(shape, Mesh) or body.name in claimed.convex
    ]
    first_ball = len(rows)
    rows += [
        (number, centre, np.eye(3), np.zeros(3), radius, False)
        for number, body in enumerate(bodies)
        for shape, pose in body.shapes
        for centre, radius in _balls(shape, pose)
    ]
    body, middle, axes, half, radius, is_box = zip(*rows, strict=True) if rows else ((),) * 6
    frames = np.array([each.frame for each in bodies], dtype=np.int64)
    number = np.array(body, dtype=np.int64)
    solids = Solids(
        number,
        frames[number],
        np.array(middle, dtype=float).reshape(-1, 3),
        np.array(axes, dtype=float).reshape(-1, 3, 3),
        np.array(half, dtype=float).reshape(-1, 3),
        np.array(radius, dtype=float),
        np.array(is_box, dtype=np.bool_),
    )
    touching = touching_of(urdf, scene, {each.name for each in bodies if not each.is_obstacle}, claimed)
    pairs = _pairs(robot, scene, claimed, tree, bodies, solids, first_ball, touching)
    return Witnesses(robot, tree, bodies, solids, len(rows) - first_ball, pairs)


def _bodies(urdf: RobotDescription, scene: Scene, tree: Tree) -> tuple[Body, ...]:
    found: dict[str, list[tuple[Shape, Pose]]] = {}
    for link in urdf.links:
        for shape in (each for each in urdf.shapes if each.link == link):
            found.setdefault(link, []).append((shape, tree.placement[link][1] @ shape.pose))
    links = [Body(link, tree.placement[link][0], tuple(shapes), False) for link, shapes in found.items()]
    held = [
        Body(each.name, frame, ((each.body, at @ each.body.pose),), False)
        for each in scene.attached
        for frame, at in [tree.placement[each.link]]
    ]
    around = [Body(each.name, 0, ((each.body, each.body.pose),), True, each.clearance) for each in scene.obstacles]
    return (*links, *held, *around)


def _solid(shape: Shape, pose: Pose, wider: float) -> tuple[Floats, Floats, Floats, float, bool]:
    """Return middle, axes, half extents and radius of a solid, and whether it is a box."""
    rotation = pose.rotation_matrix
    axes, middle = rotation.T, np.array(pose.xyz)
    if isinstance(shape, Box):
        half = 0.5 * np.array(shape.size, dtype=float)
        return middle, axes, half, wider if half.min() > SPARE else -1.0, True
    if isinstance(shape, Sphere):
        return middle, axes, np.zeros(3), shape.radius + wider, False
    if isinstance(shape, Cylinder):
        return middle, axes, np.array([0.0, shape.radius, 0.5 * shape.length]), wider, False
    if isinstance(shape, Mesh | PointCloud):
        return middle, axes, np.zeros(3), -1.0, False
    if not isinstance(shape, Capsule):
        raise NotAvailable(f"no certificate speaks of a {shape.kind} yet")
    a, b = (rotation @ np.array(end) + middle for end in (shape.a, shape.b))
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length if length > 0.0 else axes[2]
    across = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    across /= np.linalg.norm(across)
    rows = np.stack([across, np.cross(along, across), along])
    return 0.5 * (a + b), rows, np.array([0.0, 0.0, 0.5 * length]), shape.radius + wider, False


def _balls(shape: Shape, pose: Pose) -> Iterator[tuple[Floats, float]]:
    """Yield balls inside of a shape, in single precision as a certificate has them."""
    for capsule in capsules_inside(shape):
        a, b = np.array(capsule.a), np.array(capsule.b)
        count = 1 + min(_MOST, int(np.ceil(np.linalg.norm(b - a) / (_STEP * capsule.radius))))
        local = np.linalg.inv(shape.pose.matrix)
        for share in np.linspace(0.0, 1.0, count) if count > 1 else [0.5]:
            centre = (a + share * (b - a)) @ local[:3, :3].T + local[:3, 3]
            placed = pose.apply(centre[np.newaxis])[0].astype(np.float32).astype(float)
            radius = float(np.float32(capsule.radius * (1.0 - 1e-6) - SPARE - 2e-7 * np.abs(placed).max()))
            if radius > SPARE:
                yield placed, radius


def _pairs(
    robot: Robot,
    scene: Scene,
    claimed: Claimed,
    tree: Tree,
    bodies: tuple[Body, ...],
    solids: Solids,
    first_ball: int,
    touching: Collection[frozenset[str]],
) -> Pairs:
    """Return the pairs of balls and solids of bodies that may not touch."""
    tested = {frozenset(pair) for pair in robot.pairs}
    every = np.arange(len(solids.body))
    meshes = np.array([any(isinstance(shape, Mesh) for shape, _ in body.shapes) for body in bodies], dtype=np.bool_)
    first, second, keep = [np.empty(0, dtype=np.int64)], [np.empty(0, dtype=np.int64)], [np.empty(0)]
    for one, a in enumerate(bodies):
        for two, b in enumerate(bodies):
            if a.frame == b.frame or a.is_obstacle:
                continue
            if b.is_obstacle:
                free = (a.name, b.name) not in scene.allowed
                apart = claimed.clearance + claimed.padding.get(a.name, 0.0)
            else:
                both = frozenset((a.name, b.name))
                free, apart = both not in touching and both in tested, 0.0
            if not free:
                continue
            mine = every[(solids.body == one) & (every >= first_ball)]
            # A ball stands for a mesh, and for nothing else that a solid says better.
            others = every[(solids.body == two) & (solids.radius >= 0.0) & ((every < first_ball) | meshes[two])]
            first.append(np.repeat(mine, len(others)))
            second.append(np.tile(others, len(mine)))
            keep.append(np.full(len(mine) * len(others), apart))
    ball, solid = np.concatenate(first), np.concatenate(second)
    carries = np.zeros((len(tree.moved) + 1, len(tree.moved)), dtype=np.bool_)
    for k, (parent, *_) in enumerate(tree.moved):
        carries[k + 1] = carries[parent]
        carries[k + 1, k] = True
    of_ball, of_solid = carries[solids.frame[ball]], carries[solids.frame[solid]]
    return Pairs(ball, solid, np.concatenate(keep), of_ball & ~of_solid, of_solid & ~of_ball)


def frames_at(witnesses: Witnesses, q: Floats) -> Floats:
    """Return the poses of all frames at configurations, (n, dim): (n, frames, 4, 4)."""
    robot, poses = witnesses.robot, link_poses(witnesses.robot, q)
    children = [robot.links.index(joint.child) for _, joint, *_ in witnesses.tree.moved]
    return np.stack([poses[:, 0], *(poses[:, child] for child in children)], axis=1)


class Depths(NamedTuple):
    """By how much pairs overlap in the middles of cells, and throughout; how far half a cell moves them [m]."""

    middle: Floats
    least: Floats
    moved: Floats


def depths(witnesses: Witnesses, frames: Floats, half: Floats, cell: Ints, pair: Ints) -> Depths:
    """Return the depths of pairs in cells: `cell` and `pair` say which.

    `frames`, (n, f, 4, 4), are those in the middles of cells and `half`, (n, dim), half sides.
    """
    found = [
        _depths(witnesses, frames, half, cell[begin : begin + _AT_ONCE], pair[begin : begin + _AT_ONCE])
        for begin in range(0, max(len(cell), 1), _AT_ONCE)
    ]
    return Depths(*(np.concatenate(each) for each in zip(*found, strict=True)))


def _depths(witnesses: Witnesses, frames: Floats, half: Floats, cell: Ints, pair: Ints) -> Depths:
    at = _movements(witnesses, frames, half, cell, pair)
    solids, solid = witnesses.solids, witnesses.pairs.solid[pair]
    middle = at.wide - solids.distances(solid, at.local)
    # Where even the middle is not deep enough, no corner is looked at.
    rows = np.flatnonzero(middle > at.stray)
    least, most = np.full(len(cell), -np.inf), np.full(len(rows), -np.inf)
    for signs in itertools.product((1.0, -1.0), repeat=len(at.motions)):
        corner = at.local[rows] + np.einsum("k,kni->ni", np.array(signs), at.motions[:, rows])
        most = np.maximum(most, solids.distances(solid[rows], corner))
    least[rows] = at.wide[rows] - most - at.stray[rows]
    return Depths(middle, least, at.moved)


def losses(witnesses: Witnesses, frames: Floats, half: Floats, cell: Ints, pair: Ints) -> Floats:
    """Return about how much depth of pairs is lost in cells by the sides of each column, (n, columns) [m]."""
    at = _movements(witnesses, frames, half, cell, pair)
    solids, solid = witnesses.solids, witnesses.pairs.solid[pair]
    middle = solids.distances(solid, at.local)
    both_sides = [
        [solids.distances(solid, at.local + sign * motion) - middle for sign in (-1.0, 1.0)] for motion in at.motions
    ]
    lost: Floats = np.array(both_sides).max(axis=1).T + at.strays.T
    return lost


class _Movement(NamedTuple):
    """Where balls are from solids in the middles of cells, (n, 3), and how half a cell moves them, (columns, n, 3) [m].

    They stray from this by `stray` at most, of which each column has a share, and move by `moved` in all.
    """

    wide: Floats
    local: Floats
    motions: Floats
    stray: Floats
    strays: Floats
    moved: Floats


def _movements(witnesses: Witnesses, frames: Floats, half: Floats, cell: Ints, pair: Ints) -> _Movement:
    pairs, solids, tree = witnesses.pairs, witnesses.solids, witnesses.tree
    ball, solid = pairs.ball[pair], pairs.solid[pair]
    at = frames[cell, solids.frame[ball]]
    points = np.einsum("nij,nj->ni", at[:, :3, :3], solids.middle[ball]) + at[:, :3, 3]
    other = frames[cell, solids.frame[solid]]
    local = np.einsum("nji,nj->ni", other[:, :3, :3], points - other[:, :3, 3])
    columns = np.flatnonzero(half.any(axis=0))
    far, motions = np.zeros(len(cell)), np.zeros((len(columns), len(cell), 3))
    strays = np.zeros((len(columns), len(cell)))
    joints = range(len(tree.moved))
    for moves, order, sign in ((pairs.up, joints[::-1], 1.0), (pairs.down, joints, -1.0)):
        for k in order:
            _, joint, _, column, factor, _ = tree.moved[k]
            rows = np.flatnonzero(moves[pair, k])
            if column not in columns or not len(rows):
                continue
            number, by = int(np.searchsorted(columns, column)), half[cell[rows], column] * factor
            posed = frames[cell[rows], k + 1]
            motion = posed[:, :3, :3] @ np.array(joint.axis)
            if joint.kind == "prismatic":
                far[rows] += np.abs(by)
            else:
                motion = np.cross(motion, points[rows] - posed[:, :3, 3])
                long = np.abs(by) * np.linalg.norm(motion, axis=1)
                strays[number, rows] += np.abs(by) * (0.5 * long + far[rows])
                far[rows] += long
            motions[number, rows] += sign * by[:, np.newaxis] * motion
    stray = strays.sum(axis=0)
    motions = np.einsum("nji,knj->kni", other[:, :3, :3], motions)
    return _Movement(solids.radius[ball] + pairs.keep[pair], local, motions, stray, strays, far + stray)
