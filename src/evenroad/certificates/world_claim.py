"""What is to be proved of a path in an arm's world: the bodies of the world, or the shapes of its robot's file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np

from evenroad._arrays import Floats, unique_rows
from evenroad._native.certificates import Node
from evenroad._native.robot import closed_parts, winding_at
from evenroad.certificates.claim import Claim, Claimed, Pair, Tree, tree_of
from evenroad.certificates.elements import Elements, elements_of
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.parts import Parts, kinds_in_words
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.geometry.shapes import Mesh, PointCloud, Shape
from evenroad.robots.kinematics import held_values, joint_motion
from evenroad.robots.robot import Robot


class Owner(NamedTuple):
    """A link, or an obstacle: the two may have the same name."""

    name: str
    is_obstacle: bool = False


Apart: TypeAlias = tuple[Owner, Owner, float]
"""A link and an obstacle, or two links, and what is to be kept between the two [m]."""


@dataclass(frozen=True, eq=False)
class Body:
    """A link's shape, or an obstacle: its elements in a frame, and what of it has an inside.

    `solid` are the triangles of closed surfaces, (t, 3, 3); `starts` has a point of each connected piece, (k, 3).
    """

    owner: Owner
    frame: int
    elements: Elements
    solid: Floats
    starts: Floats
    turned: bool = True


@dataclass(frozen=True, eq=False)
class WorldClaim:
    """The bodies of a world, and which of them are to keep a distance; `kinds` says what they are, in words."""

    tree: Tree
    bodies: tuple[Body, ...]
    pairs: tuple[Apart, ...]
    kinds: str

    @cached_property
    def numbers(self) -> dict[Owner, tuple[int, ...]]:
        """The numbers of the bodies of each link and obstacle."""
        found: dict[Owner, list[int]] = {}
        for number, body in enumerate(self.bodies):
            found.setdefault(body.owner, []).append(number)
        return {owner: tuple(numbers) for owner, numbers in found.items()}

    def one_by_one(self, pairs: Sequence[Apart], wider: float = 0.0) -> Claim:
        """Return these pairs as the kernel takes them, each by itself, with more to keep [m]."""
        nodes = [(self._node(self.numbers[first]), self._node(self.numbers[second])) for first, second, _ in pairs]
        both = zip(nodes, pairs, strict=True)
        return Claim(self.tree, tuple(Pair(*two, keep + wider, (a.name, b.name)) for two, (a, b, keep) in both))

    @cached_property
    def together(self) -> Claim:
        """All pairs that joints move, as the kernel takes them: a link with all obstacles of one distance at once."""
        around: dict[tuple[Owner, float], list[int]] = {}
        every = []
        for first, second, keep in self.moving:
            numbers = self.numbers[second]
            if second.is_obstacle:
                around.setdefault((first, keep), []).extend(numbers)
                continue
            names = (first.name, second.name)
            every.append(Pair(self._node(self.numbers[first]), self._node(numbers), keep, names))
        for (link, keep), obstacles in around.items():
            both = self._node(self.numbers[link]), self._node(tuple(obstacles))
            every.append(Pair(*both, keep, (link.name, _OBSTACLES)))
        return Claim(self.tree, tuple(every))

    @cached_property
    def moving(self) -> tuple[Apart, ...]:
        """The pairs that joints move against each other."""
        return tuple(pair for pair in self.pairs if self._frame(pair[0]) != self._frame(pair[1]))

    @cached_property
    def still(self) -> tuple[Apart, ...]:
        """The pairs that they do not."""
        return tuple(pair for pair in self.pairs if self._frame(pair[0]) == self._frame(pair[1]))

    def _frame(self, owner: Owner) -> int:
        return self.bodies[self.numbers[owner][0]].frame

    @cached_property
    def _nodes(self) -> dict[tuple[int, ...], Node]:
        return {}

    def _node(self, numbers: tuple[int, ...]) -> Node:
        """Return the node of some bodies of one frame, the same each time."""
        if numbers not in self._nodes:
            elements = [self.bodies[number].elements.native for number in numbers]
            self._nodes.setdefault(numbers, Node(self.bodies[numbers[0]].frame, elements))
        return self._nodes[numbers]


_OBSTACLES = "an obstacle"


def world_claim(world: ArmWorld, shapes: Sequence[Shape] | None) -> WorldClaim:
    """Return what is to be proved of a path in a world.

    `shapes` are those of the robot's file, each in its link's frame; None for the world's own bodies, which contain
    them.
    """
    robot, scene = world.robot, world.scene
    still = {name: value for name, value in held_values(robot).items() if value != 0.0}
    tree = tree_of(robot, Claimed(robot.group, still, None, frozenset(), world.clearance, dict(robot.padding)))
    bodies = [*bodies_of(shapes or (), tree), *_of_world(robot, tree, {each.link for each in shapes or ()})]
    bodied = {body.owner.name for body in bodies}
    bodies += [_body(Owner(each.name, True), 0, each.body, IDENTITY, each.clearance) for each in scene.obstacles]
    padding = dict(robot.padding)
    pairs = [(Owner(a), Owner(b), 0.0) for a, b in robot.pairs if {a, b} <= bodied]
    pairs += [
        (Owner(link), Owner(each.name, True), world.clearance + padding.get(link, 0.0))
        for link in robot.links
        if link in bodied
        for each in scene.obstacles
        if (link, each.name) not in scene.allowed
    ]
    kinds = kinds_in_words(robot.shapes, robot.capsules) if shapes is None else f"shapes of {robot.name}'s file"
    return WorldClaim(tree, tuple(bodies), tuple(pairs), kinds)


def bodies_of(shapes: Iterable[Shape], tree: Tree) -> Iterable[Body]:
    """Yield the bodies of shapes, each in its link's frame."""
    for shape in shapes:
        frame, at = tree.placement[shape.link]
        yield _body(Owner(shape.link), frame, shape, at)


def _of_world(robot: Robot, tree: Tree, known: set[str]) -> Iterable[Body]:
    """Yield the bodies by which a world checks the links that are not known: shapes of parts, else capsules."""
    sharp = {parts.link for parts in robot.shapes} - known
    for parts in robot.shapes:
        if parts.link in sharp:
            yield _of_parts(parts, *tree.placement[parts.link])
    for capsule in robot.capsules:
        if capsule.link not in sharp | known:
            frame, at = tree.placement[capsule.link]
            yield _body(Owner(capsule.link), frame, capsule, at)


def _of_parts(parts: Parts, frame: int, at: Pose) -> Body:
    corners = at.apply(parts.corners.reshape(-1, 3))
    points, number = unique_rows(corners)
    disc = at.rotation_matrix @ np.array(parts.disc)
    width = float(np.linalg.norm(disc))
    x, y, z = (disc / width).tolist() if width else (0.0, 0.0, 1.0)
    count = parts.corners.shape[:2]
    elements = Elements(points, number.reshape(count).astype(np.int64), parts.radius, width, (x, y, z))
    solid, starts = np.zeros((0, 3, 3)), corners[:1]
    if parts.of == "mesh":
        # All triangles of a link are one list: where another piece of it begins, the kernel says.
        starts = corners.reshape(-1, 3, 3)[closed_parts(points, elements.corners).first][:, 0]
        solid = corners.reshape(-1, 3, 3) if parts.closed else solid
    return Body(Owner(parts.link), frame, elements, solid, starts)


def _body(owner: Owner, frame: int, shape: Shape, at: Pose, wider: float = 0.0) -> Body:
    nothing = np.zeros((0, 3, 3))
    elements = elements_of(shape, at, wider=wider)
    if not isinstance(shape, Mesh):
        starts = elements.points if isinstance(shape, PointCloud) else elements.points[:1]
        return Body(owner, frame, elements, nothing, starts)
    mesh = shape.triangles
    parts, corners = mesh.closed_parts, (at @ shape.pose).apply(mesh.vertices)[mesh.facing]
    return Body(owner, frame, elements, corners[parts.closed], corners[parts.first][:, 0], parts.oriented)


def nested(claim: WorldClaim, q: Floats) -> tuple[str, str] | None:
    """Return two bodies of which one is inside of the other's closed surface at a configuration, (dim,).

    Surfaces that never touch stay inside or outside of each other, so one state of a path decides.
    """
    poses = [IDENTITY]
    for parent, joint, at, column, factor, offset in claim.tree.moved:
        motion = joint_motion(joint, np.array([factor * q[column] + offset]))[0]
        poses.append(poses[parent] @ at @ Pose.from_matrix(motion))
    for first, second, _ in claim.pairs:
        for outer, inner in ((first, second), (second, first)):
            for i in claim.numbers[outer]:
                if not len(claim.bodies[i].solid):
                    continue
                for j in claim.numbers[inner]:
                    if _is_inside(claim.bodies[i], claim.bodies[j], poses):
                        return inner.name, outer.name
    return None


def _is_inside(outer: Body, inner: Body, poses: Sequence[Pose]) -> bool:
    points = (poses[outer.frame].inverse() @ poses[inner.frame]).apply(inner.starts)
    flat = outer.solid.reshape(-1, 3)
    near = ((flat.min(axis=0) <= points) & (points <= flat.max(axis=0))).all(axis=1)
    solid = np.ascontiguousarray(outer.solid)
    return any(winding_at(np.ascontiguousarray(point), solid, outer.turned) for point in points[near])
