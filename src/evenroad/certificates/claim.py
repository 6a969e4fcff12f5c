"""What a certificate claims: frames that move, bodies in them, and the pairs of bodies that are apart."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.certificates import JointTables
from evenroad.certificates.elements import Elements, elements_of
from evenroad.certificates.kept import Axis, Point
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import IDENTITY, Pose
from evenroad.loading.description import RobotDescription
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import Tree as RobotTree
from evenroad.robots.kinematics import joint_motion
from evenroad.scenes.scene import Scene


@dataclass(frozen=True)
class Claimed:
    """What a certificate is written for, beside the files: joints of the path, others where they are held, distances.

    `disabled` are pairs of links that the SRDF lets touch, None where none does; `convex` are meshes of the scene that
    stand for their hulls; links keep `padding` more than the `clearance` from obstacles [m].
    """

    joints: tuple[str, ...]
    held: Mapping[str, float]
    disabled: frozenset[frozenset[str]] | None
    convex: frozenset[str]
    clearance: float
    padding: Mapping[str, float]
    keeps: tuple[Axis | Point, ...] = ()


@dataclass(frozen=True)
class Tree:
    """Where links are: each in a frame, with its pose there; joint k moves frame k + 1, see `moved`.

    `moved` are, for each frame but the root's, its parent, the joint, its pose in the parent with the joint at 0, its
    column in a configuration, and the factor and offset of its value.
    """

    placement: dict[str, tuple[int, Pose]]
    moved: tuple[tuple[int, Joint, Pose, int, float, float], ...]

    def tables(self) -> JointTables:
        """Return the joints as the kernel takes them."""
        links = [(parent, column, joint.kind == "prismatic") for parent, joint, _, column, _, _ in self.moved]
        poses = [np.concatenate([at.matrix[:3, :3].ravel(), at.xyz, joint.axis]) for _, joint, at, *_ in self.moved]
        rules = [(factor, offset) for *_, factor, offset in self.moved]
        rows = np.array(links, dtype=np.int64).reshape(-1, 3), np.array(poses, dtype=float).reshape(-1, 15)
        return JointTables(*rows, np.array(rules, dtype=float).reshape(-1, 2))

    def moves_by(self, k: int, frames: Floats, half: Floats, points: Floats, before: Floats) -> Floats:
        """Return how far joint k moves points, (n, 3), at most, whose own movement is `before`, (n,) [m].

        Its value changes from that of `frames`, the poses (n, 4, 4) of its frame, by what `half`, (n,), of its column
        says.
        """
        _, joint, _, _, factor, _ = self.moved[k]
        turn = half * abs(factor)
        if joint.kind == "prismatic":
            return turn
        axis = frames[:, :3, :3] @ np.array(joint.axis)
        lever: Floats = before + np.linalg.norm(np.cross(axis, points - frames[:, :3, 3]), axis=1)
        return turn * lever


@dataclass(frozen=True)
class Node:
    """Some bodies of a frame; its shapes are numbers in the claim's."""

    frame: int
    shapes: tuple[int, ...]


@dataclass(frozen=True)
class Claim:
    """All that is to be proved: pairs, each of two nodes, a distance to keep [m], and the names of its bodies."""

    tree: Tree
    shapes: tuple[Elements, ...]
    nodes: tuple[Node, ...]
    pairs: tuple[tuple[int, int, float, tuple[str, str]], ...]
    keeps: tuple[Axis | Point, ...] = ()


def tree_of(urdf: RobotTree, claimed: Claimed) -> Tree:
    """Return the frames of a robot; InvalidValue if a joint of the path is none that its file has."""
    placement: dict[str, tuple[int, Pose]] = {urdf.links[0]: (0, IDENTITY)}
    moved: list[tuple[int, Joint, Pose, int, float, float]] = []
    for joint in urdf.joints:
        frame, at = placement[joint.parent]
        at = at @ joint.origin
        leader = joint.name if joint.mimic is None else joint.mimic.joint
        factor, offset = (1.0, 0.0) if joint.mimic is None else (joint.mimic.multiplier, joint.mimic.offset)
        if joint.kind != "fixed" and leader in claimed.joints:
            moved.append((frame, joint, at, claimed.joints.index(leader), factor, offset))
            placement[joint.child] = len(moved), IDENTITY
            continue
        if joint.kind != "fixed":
            value = factor * claimed.held.get(leader, 0.0) + offset
            at = at @ Pose.from_matrix(joint_motion(joint, np.array([value]))[0])
        placement[joint.child] = frame, at
    if missing := set(claimed.joints) - {joint.name for _, joint, *_ in moved}:
        raise InvalidValue(f"joint {min(missing)!r} is none that the robot's URDF has: no certificate can name it")
    return Tree(placement, tuple(moved))


def claim_of(urdf: RobotDescription, scene: Scene, claimed: Claimed) -> Claim:
    """Return what is to be proved of a robot in a scene; NotAvailable for bodies that no certificate speaks of."""
    tree = tree_of(urdf, claimed)
    placement = dict(tree.placement)
    shapes: list[Elements] = []
    bodies: dict[str, list[int]] = {}
    for link in urdf.links:
        for body in (each for each in urdf.shapes if each.link == link):
            bodies.setdefault(link, []).append(len(shapes))
            shapes.append(elements_of(body, placement[link][1]))
    for held in scene.attached:
        placement[held.name] = placement[held.link]
        bodies[held.name] = [len(shapes)]
        shapes.append(elements_of(held.body, placement[held.link][1], convex=held.name in claimed.convex))
    obstacles = {}
    for each in scene.obstacles:
        obstacles[each.name] = len(shapes)
        shapes.append(elements_of(each.body, IDENTITY, convex=each.name in claimed.convex, wider=each.clearance))
    nodes: list[Node] = []
    pairs = [*_around(bodies, placement, obstacles, scene, claimed, nodes)]
    first = len(nodes)
    nodes += [Node(placement[name][0], tuple(numbers)) for name, numbers in bodies.items()]
    touching, names = touching_of(urdf, scene, bodies, claimed), list(bodies)
    for i, name in enumerate(names):
        for j in range(i + 1, len(names)):
            if placement[name][0] != placement[names[j]][0] and frozenset((name, names[j])) not in touching:
                pairs.append((first + i, first + j, 0.0, (name, names[j])))
    return Claim(tree, tuple(shapes), tuple(nodes), tuple(pairs), claimed.keeps)


def _around(
    bodies: Mapping[str, list[int]],
    placement: Mapping[str, tuple[int, Pose]],
    obstacles: Mapping[str, int],
    scene: Scene,
    claimed: Claimed,
    nodes: list[Node],
) -> Iterable[tuple[int, int, float, tuple[str, str]]]:
    """Yield pairs of bodies and obstacles: bodies of one frame with the same allowances are one node."""
    groups: dict[tuple[int, frozenset[str], float], list[str]] = {}
    for name in bodies:
        touched = frozenset(obstacle for body, obstacle in scene.allowed if body == name)
        groups.setdefault((placement[name][0], touched, claimed.padding.get(name, 0.0)), []).append(name)
    around: dict[frozenset[str], int] = {}
    for (frame, touched, padding), names in groups.items():
        others = [number for name, number in obstacles.items() if name not in touched]
        if frame == 0 or not others:
            continue
        if touched not in around:
            around[touched] = len(nodes)
            nodes.append(Node(0, tuple(others)))
        nodes.append(Node(frame, tuple(number for name in names for number in bodies[name])))
        yield len(nodes) - 1, around[touched], claimed.clearance + padding, (" and ".join(names), "an obstacle")


def touching_of(urdf: RobotDescription, scene: Scene, bodies: Container[str], claimed: Claimed) -> set[frozenset[str]]:
    """Return pairs of links that may touch: those of the SRDF, else neighbours; and what a held body may."""
    touching = {frozenset((held.name, link)) for held in scene.attached for link in (held.link, *held.touches)}
    return touching | (claimed.disabled or neighbours(urdf, bodies))


def neighbours(urdf: RobotDescription, bodied: Container[str]) -> set[frozenset[str]]:
    """Return pairs of a link and the next one above it with a body where exactly one joint moves between them."""
    found = set[frozenset[str]]()
    above = {joint.child: joint for joint in urdf.joints}
    for name in urdf.links:
        link, moving = name, 0
        while link in above:
            moving += above[link].kind != "fixed"
            link = above[link].parent
            if link in bodied:
                found |= {frozenset((name, link))} if moving == 1 else set()
                break
    return found
