"""Pairs of links that nobody tests: never in contact, as is proved for all values of the joints, or touching somewhere.

Where two links are depends on the joints between them alone.  Their values are divided into cells.  In each cell one
joint is swept from its lower to its upper end, and the kernel of certificates proves that the links stay apart all
along that line.  The other joints stand in the cell's middle: while they are anywhere in it no point moves by more than
the sum over them of lever times half the cell's extent.  So the line is proved with that much to spare, or the cell is
halved.  With one joint between two links there is one line, and nothing to spare.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import count
from typing import Literal

import numpy as np

from evenroad._arrays import Floats
from evenroad._rng import generator
from evenroad._time_limit import BudgetSpent, Deadline, look_at_clock, until
from evenroad.certificates.certify import written_of
from evenroad.certificates.claim import Claimed, Tree, tree_of
from evenroad.certificates.curves import straight
from evenroad.certificates.first_touch import IN_CONTACT, first_touch, in_contact, states_at
from evenroad.certificates.world_claim import Body, Owner, WorldClaim, bodies_of, nested
from evenroad.geometry.hulls import piece_of
from evenroad.geometry.shapes import Shape
from evenroad.loading.link_bodies import opened
from evenroad.robots.hull_trees import contacts, hull_trees
from evenroad.robots.joint import Joint
from evenroad.robots.kinematics import poses_at, with_mimics
from evenroad.robots.robot import Robot

_SAMPLES = 1000
"""Number of random states in which a contact is looked for first."""
_BATCH = 50
"""Number of these between two looks at the clock."""
_CONFIRMED = 3
"""In how many of a batch that seem to be in contact this is shown in double precision, until it is once."""
_MOST = 4000
"""Largest number of answers to one line; a line of more is cut."""
_SHORTER_LINES = 0.125
"""How much the extent of the swept joint counts where a line has too many answers."""
_LITTLE = 1e-3
"""With less than this to spare, a contact is looked for all along the line [m]."""
_SHORTEST = 1e-6
"""What moves nothing by more than this is not halved [m]."""


@dataclass(frozen=True)
class LinkPair:
    """What is known of two links at all values of the joints.

    Attributes
    ----------
    links : (str, str)
    reason : str
        Why the pair is not tested.
    status : "never", "touches" or "undecided"
        Proved never to touch; in contact in a state; neither within the time.
    joints : tuple of str
        The joints between the two: their values alone decide.
    configuration : mapping of str to float
        Values of these in a contact, or where the two are as near as `nearest` [rad or m].
    nearest : float or None
        The least distance that was seen, 0 in a contact; None of a pair that never touches [m].
    lines : int
        How many lines the proof, or the search, has.
    """

    links: tuple[str, str]
    reason: str
    status: Literal["never", "touches", "undecided"]
    joints: tuple[str, ...]
    configuration: dict[str, float]
    nearest: float | None
    lines: int

    @property
    def adjacent(self) -> bool:
        """Whether at most one joint is between the two links."""
        return len(self.joints) <= 1


class Links:
    """The links of a robot with the shapes of its file, meshes read once."""

    def __init__(self, robot: Robot, shapes: Sequence[Shape]) -> None:
        self.robot = robot
        self.shapes: dict[str, list[Shape]] = {}
        for shape in opened(shapes):
            self.shapes.setdefault(shape.link, []).append(shape)
        self._leaves: dict[str, list[tuple[Floats, float]]] = {}

    def leaves(self, link: str) -> list[tuple[Floats, float]]:
        """Return the convex parts of a link, as trees are made of."""
        if link not in self._leaves:
            pieces = map(piece_of, self.shapes[link])
            self._leaves[link] = [(piece.parts, piece.radius) for piece in pieces]
        return self._leaves[link]


def decide_pair(of: Links, links: tuple[str, str], reason: str, seconds: float) -> LinkPair:
    """Return whether two links ever touch, within some seconds."""
    if seconds <= 0.0:
        return LinkPair(links, reason, "undecided", tuple(_ranges(of.robot, links)), {}, None, 0)
    between = _between(of, links)
    if not between.joints:
        q = np.zeros(1)
        touching = in_contact(between.claim.one_by_one(between.claim.pairs), q) or nested(between.claim, q)
        return LinkPair(links, reason, "touches" if touching else "never", (), {}, 0.0 if touching else None, 1)
    search = _Search(between)
    decided = bool(np.isfinite(between.limits).all())
    try:
        with until(Deadline.after(seconds)):
            decided = decided and not search.finds_contact(of) and search.prove()
    except BudgetSpent:
        decided = False
    status: Literal["never", "touches", "undecided"] = "never" if decided else "undecided"
    if search.touches:
        status = "touches"
    seen = status != "never" and search.q is not None
    values = dict(zip(between.joints, search.q.tolist(), strict=True)) if seen and search.q is not None else {}
    nearest = search.nearest if seen else None
    return LinkPair(links, reason, status, between.joints, values, nearest, search.lines)


@dataclass(frozen=True, eq=False)
class _Between:
    """Two links and the joints between them: names, limits, (d, 2), and the levers of their values [m / rad, or 1]."""

    claim: WorldClaim
    joints: tuple[str, ...]
    limits: Floats
    levers: Floats


class _Search:
    """What is seen of two links, line by line of the joint that moves them most."""

    def __init__(self, between: _Between) -> None:
        self.claim, self.joints = between.claim, between.joints
        self.low, self.high = between.limits.T
        self.levers = between.levers
        self.swept = int((self.levers * (self.high - self.low)).argmax())
        self.nearest: float | None = None
        self.q: Floats | None = None
        self.lines = 0

    @property
    def touches(self) -> bool:
        """Whether a state in contact was seen."""
        return self.nearest is not None and self.nearest <= IN_CONTACT

    def finds_contact(self, of: Links) -> bool:
        """Return whether a contact is in one of random states, or one link is inside of the other."""
        first, second = (owner.name for owner in self.claim.pairs[0][:2])
        middle = 0.5 * (self.low + self.high)
        if nested(self.claim, middle) is not None:
            self._see(0.0, middle)
            return True
        # The only line of one joint says all.
        samples = _SAMPLES if len(middle) > 1 else _SAMPLES // 20
        q = self.low + generator(0).random((samples, len(middle))) * (self.high - self.low)
        trees = hull_trees({link: of.leaves(link) for link in (first, second)})
        alone = self.claim.one_by_one(self.claim.pairs)
        for rows in np.array_split(q, samples // _BATCH):
            look_at_clock()
            poses = poses_at(of.robot, with_mimics(of.robot, self._values(of.robot, rows)), len(rows))
            both = [poses[:, of.robot.links.index(link)] for link in (first, second)]
            for row in np.flatnonzero(contacts(trees, first, second, *both)[:, 0] >= 0)[:_CONFIRMED]:
                if in_contact(alone, rows[row]):
                    self._see(0.0, rows[row])
                    return True
        return False

    def prove(self) -> bool:
        """Prove the links apart in all cells; return False where a contact is seen, or they come too near to decide."""
        number = count()
        half = 0.5 * (self.high - self.low)
        cells: list[tuple[float, int, Floats, Floats]] = [(0.0, next(number), self.low + half, half)]
        while cells:
            _, _, middle, half = heappop(cells)
            moves = self.levers * half
            spare = float(moves.sum() - moves[self.swept])
            status = self._status(middle, half, spare)
            if status == "apart":
                continue
            # A narrower cell has less to spare.  A shorter line needs fewer answers, but that alone does not help.
            moves[self.swept] *= 0.0 if status == "near" else _SHORTER_LINES
            widest = int(moves.argmax())
            if self.touches or moves[widest] < _SHORTEST:
                return False
            narrower = half.copy()
            narrower[widest] *= 0.5
            for side in (-1.0, 1.0):
                moved = middle.copy()
                moved[widest] += side * narrower[widest]
                heappush(cells, (-float((self.levers * narrower).sum()), next(number), moved, narrower))
        return True

    def _status(self, middle: Floats, half: Floats, spare: float) -> Literal["apart", "near", "too long"]:
        """Return whether the links are proved apart in a cell, or are too near for what it has to spare."""
        look_at_clock()
        self.lines += 1
        line = np.stack([middle, middle])
        line[:, self.swept] += (-half[self.swept], half[self.swept])
        written = written_of(self.claim.one_by_one(self.claim.pairs, spare), straight(line), _MOST)
        if written is None:
            return "too long"
        touch = written.touch
        if touch.pair < 0:
            return "apart"
        self._see(max(touch.most + spare, 0.0), states_at(line, np.array([touch.share]))[0])
        if spare < _LITTLE:
            found = first_touch(self.claim, line)
            if found is not None and found.contact is not None:
                self._see(0.0, states_at(line, np.array([found.contact]))[0])
        return "near"

    def _values(self, robot: Robot, q: Floats) -> dict[str, Floats]:
        """Return values, joint -> (n,), of all joints that move by themselves; those elsewhere do not matter."""
        free = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None]
        values = {
            joint.name: np.full(len(q), _range(joint)[0] if joint.lower == joint.upper else 0.0) for joint in free
        }
        return values | dict(zip(self.joints, q.T, strict=True))

    def _see(self, distance: float, q: Floats) -> None:
        if self.nearest is None or distance < self.nearest:
            self.nearest, self.q = distance, q


def untested_pairs(
    robot: Robot,
    shapes: Sequence[Shape],
    pairs: Sequence[tuple[str, str, str]],
    seconds: float,
    report: Callable[[int, int], None] | None = None,
) -> list[LinkPair]:
    """Return what is known of pairs of links, each with the reason why it is not tested, in their order.

    Those with few joints between them come first, and leave their time to the others; `report` takes how many are done,
    of how many.
    """
    of = Links(robot, shapes)
    # What reads the files is not counted.
    end = Deadline.after(seconds)
    found: dict[int, LinkPair] = {}
    numbers = [i for i, (first, second, _) in enumerate(pairs) if {first, second} <= set(of.shapes)]
    for number in sorted(numbers, key=lambda i: len(_ranges(robot, pairs[i][:2]))):
        first, second, reason = pairs[number]
        share = end.left / (len(numbers) - len(found))
        found[number] = decide_pair(of, (first, second), reason, share)
        if report is not None:
            report(len(found), len(numbers))
    return [found[number] for number in numbers]


def _between(of: Links, links: tuple[str, str]) -> _Between:
    """Return what decides about two links."""
    ranges = _ranges(of.robot, links)
    still = {name: low for name, (low, high) in ranges.items() if low == high}
    joints = tuple(name for name in ranges if name not in still)
    tree = tree_of(of.robot, Claimed(joints, still, None, frozenset(), 0.0, {}))
    bodies = tuple(bodies_of((shape for link in links for shape in of.shapes[link]), tree))
    claim = WorldClaim(tree, bodies, ((Owner(links[0]), Owner(links[1]), 0.0),), "shapes of the file")
    limits = np.array([ranges[name] for name in joints]).reshape(-1, 2)
    return _Between(claim, joints, limits, _levers(tree, bodies, limits))


def _ranges(robot: Robot, links: tuple[str, str]) -> dict[str, tuple[float, float]]:
    """Return the joints between two links that move by themselves, or by which others do, with their ranges."""
    above = {joint.child: joint for joint in robot.joints}
    chains = [[*_up(above, link)] for link in links]
    names = {joint.name for joint in chains[0]} ^ {joint.name for joint in chains[1]}
    moving = [joint for joint in robot.joints if joint.name in names and joint.kind != "fixed"]
    leaders = {joint.name if joint.mimic is None else joint.mimic.joint for joint in moving}
    return {joint.name: _range(joint) for joint in robot.joints if joint.name in leaders}


def _up(above: dict[str, Joint], link: str) -> Iterator[Joint]:
    while link in above:
        yield above[link]
        link = above[link].parent


def _range(joint: Joint) -> tuple[float, float]:
    """Return the range of a joint: its hard limits, and one turn of a joint without any."""
    if joint.kind == "continuous":
        return -math.pi, math.pi
    return (joint.lower, joint.upper) if joint.hard is None else joint.hard


def _levers(tree: Tree, bodies: Sequence[Body], limits: Floats) -> Floats:
    """Return by how much the value of each joint moves a point of one body against the other, at most [m / rad, or 1].

    Lengths of the chain add up from the body to the joint; next to the body, the distance from the axis counts.
    """
    levers = np.zeros(len(limits))
    chains = {body.owner: [*_chain(tree, body.frame)] for body in bodies}
    shared = set.intersection(set(range(len(tree.moved))), *map(set, chains.values()))
    for owner, chain in chains.items():
        every = [body.elements for body in bodies if body.owner == owner]
        wide = max(elements.radius + elements.disc for elements in every)
        points = np.concatenate([elements.points for elements in every])
        reach = float(np.linalg.norm(points, axis=1).max()) + wide
        for above, k in enumerate(each for each in chain if each not in shared):
            _, joint, at, column, factor, offset = tree.moved[k]
            if joint.kind == "prismatic":
                reach += float(np.abs(factor * limits[column] + offset).max())
                levers[column] += abs(factor)
            elif above == 0:
                across = np.linalg.norm(np.cross(points, joint.axis), axis=1).max()
                levers[column] += abs(factor) * (float(across) + wide)
            else:
                levers[column] += abs(factor) * reach
            reach += float(np.linalg.norm(at.xyz))
    return levers


def _chain(tree: Tree, frame: int) -> Iterator[int]:
    """Yield the numbers of the joints that move a frame, from it to the root."""
    while frame:
        yield frame - 1
        frame = tree.moved[frame - 1][0]
