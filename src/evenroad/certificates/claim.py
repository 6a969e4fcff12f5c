"""What a certificate claims: frames that move, bodies in them, and the pairs of bodies that are apart."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.certificates import JointTables, Node
from evenroad._native.certificates import Pair as NativePair
from evenroad._shared import once_property
from evenroad.certificates.elements import Elements, elements_of
from evenroad.certificates.kept import Axis, Point
from evenroad.errors import InvalidValue, NotAvailable
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

    @once_property
    def native(self) -> JointTables:
        """The joints as the kernel takes them."""
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
class Pair:
    """Two nodes, a distance that they are to keep [m], and the names of their bodies."""

    first: Node
    second: Node
    keep: float
    names: tuple[str, str]

    @once_property
    def native(self) -> NativePair:
        """The same for the kernel."""
        return NativePair(self.first, self.second, self.keep)


@dataclass(frozen=True)
class Claim:
    """All that is to be proved: pairs of nodes in the frames of a tree, and constraints."""

    tree: Tree
    pairs: tuple[Pair, ...]
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


class Links:
    """The links of a robot with shapes, as claims have them in any scene: each in a frame of its tree."""

    def __init__(self, urdf: RobotDescription, tree: Tree) -> None:
        self.urdf, self.tree = urdf, tree
        self.bodies: dict[str, tuple[Elements, ...]] = {}
        for link in urdf.links:
            shapes = [each for each in urdf.shapes if each.link == link]
            if shapes:
                at = tree.placement[link][1]
                self.bodies[link] = tuple(elements_of(each, at) for each in shapes)
        self._nodes: dict[tuple[str, ...], Node] = {}
        self._pairs: dict[frozenset[frozenset[str]], tuple[Pair, ...]] = {}

    def node(self, names: tuple[str, ...]) -> Node:
        """Return the node of some links of one frame, the same each time."""
        if names not in self._nodes:
            elements = [each.native for name in names for each in self.bodies[name]]
            self._nodes.setdefault(names, Node(self.tree.placement[names[0]][0], elements))
        return self._nodes[names]

    def pairs(self, untested: frozenset[frozenset[str]]) -> tuple[Pair, ...]:
        """Return the pairs of links in different frames, but those that are untested."""
        if untested not in self._pairs:
            frames = {name: self.tree.placement[name][0] for name in self.bodies}
            self._pairs[untested] = tuple(_among(frames, lambda name: self.node((name,)), untested))
        return self._pairs[untested]


def claim_of(links: Links, scene: Scene, claimed: Claimed) -> Claim:
    """Return what is to be proved of a robot in a scene; NotAvailable for bodies that no certificate speaks of."""
    held: dict[str, Elements] = {}
    frames = {name: links.tree.placement[name][0] for name in links.bodies}
    for each in scene.attached:
        for name in set(each.touches) & {obstacle.name for obstacle in scene.obstacles}:
            # In the scene that is carried, a checker reads the name as the obstacle's, and tests the link.
            why = f"{each.name!r} may touch the link {name!r}, and an obstacle has that name"
            raise NotAvailable(f"no certificate can say it: {why}: rename the obstacle")
        frames[each.name], at = links.tree.placement[each.link]
        held[each.name] = elements_of(each.body, at, convex=each.name in claimed.convex)
    nodes = {name: Node(frames[name], [elements.native]) for name, elements in held.items()}

    def node(names: tuple[str, ...]) -> Node:
        if not held.keys() & names:
            return links.node(names)
        elements = [each for name in names for each in links.bodies.get(name, ()) or (held[name],)]
        return Node(frames[names[0]], [each.native for each in elements])

    around = _around(node, frames, scene, claimed)
    untested = touching_of(links.urdf, scene, links.bodies, claimed)
    if not held:
        return Claim(links.tree, (*around, *links.pairs(untested)), claimed.keeps)
    among = _among(frames, lambda name: nodes.get(name) or links.node((name,)), untested)
    return Claim(links.tree, (*around, *among), claimed.keeps)


def _among(
    frames: Mapping[str, int], node: Callable[[str], Node], untested: frozenset[frozenset[str]]
) -> Iterator[Pair]:
    """Yield the pairs of bodies in different frames, but those that are untested; `frames` are the numbers of these."""
    names = list(frames)
    for i, name in enumerate(names):
        for other in names[i + 1 :]:
            if frames[name] != frames[other] and frozenset((name, other)) not in untested:
                yield Pair(node(name), node(other), 0.0, (name, other))


def _around(
    node: Callable[[tuple[str, ...]], Node], frames: Mapping[str, int], scene: Scene, claimed: Claimed
) -> Iterator[Pair]:
    """Yield pairs of bodies and obstacles: bodies of one frame with the same allowances are one node."""
    allowed: dict[str, list[str]] = {}
    for body, obstacle in scene.allowed:
        allowed.setdefault(body, []).append(obstacle)
    groups: dict[tuple[int, frozenset[str], float], list[str]] = {}
    for name, frame in frames.items():
        key = frame, frozenset(allowed.get(name, ())), claimed.padding.get(name, 0.0)
        groups.setdefault(key, []).append(name)
    obstacles = {
        each.name: elements_of(each.body, IDENTITY, convex=each.name in claimed.convex, wider=each.clearance).native
        for each in scene.obstacles
    }
    around: dict[frozenset[str], Node] = {}
    for (frame, touched, padding), names in groups.items():
        others = [elements for name, elements in obstacles.items() if name not in touched]
        if frame == 0 or not others:
            continue
        if touched not in around:
            around[touched] = Node(0, others)
        keep, said = claimed.clearance + padding, (" and ".join(names), "an obstacle")
        yield Pair(node(tuple(names)), around[touched], keep, said)


def touching_of(
    urdf: RobotDescription, scene: Scene, bodies: Container[str], claimed: Claimed
) -> frozenset[frozenset[str]]:
    """Return pairs of links that may touch: those of the SRDF, else neighbours; and what a held body may."""
    touching = {frozenset((held.name, link)) for held in scene.attached for link in (held.link, *held.touches)}
    own = claimed.disabled or neighbours(urdf, bodies)
    return own | touching if touching else own


def neighbours(urdf: RobotDescription, bodied: Container[str]) -> frozenset[frozenset[str]]:
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
    return frozenset(found)
