"""Pairs of links that nobody tests: never in contact, as is proved for all values of the joints, or touching somewhere.

Where two links are depends on the joints between them alone.  All their values are a box.  The kernel of certificates
proves that the links stay apart in a cell of it, or halves the cell along one of the joints.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native.certificates import Answers, write_box
from evenroad._rng import generator
from evenroad._time_limit import BudgetSpent, Deadline, look_at_clock, until
from evenroad.certificates.claim import Claim, Claimed, Tree, tree_of
from evenroad.certificates.first_touch import IN_CONTACT, in_contact
from evenroad.certificates.no_path import ranges_of
from evenroad.certificates.world_claim import Body, Owner, WorldClaim, bodies_of, nested
from evenroad.geometry.hulls import piece_of
from evenroad.geometry.shapes import Shape
from evenroad.loading.description import RobotDescription
from evenroad.loading.link_bodies import opened
from evenroad.robots.hull_trees import contacts, hull_trees
from evenroad.robots.kinematics import poses_at, with_mimics
from evenroad.scenes.scene import Scene

MOST_JOINTS = 6
"""Largest number of joints between two links that are proved never to touch: a cell has 2^6 corners then."""
_SAMPLES = 1000
"""Number of random states in which a contact is looked for first."""
_BATCH = 50
"""Number of these between two looks at the clock."""
_CONFIRMED = 3
"""In how many of a batch that seem to be in contact this is shown in double precision, until it is once."""
_MOST = 4_000_000
"""Largest number of answers to a pair."""
_HALVINGS = 40
"""How often a cell is halved at most."""


@dataclass(frozen=True, eq=False)
class Proof:
    """The columns along which the cells of a pair are halved, one after the other, and its answers and directions."""

    columns: Ints
    answers: Answers


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
    proof : Proof or None
        Of a pair that never touches, unless the two links are fixed to each other.
    """

    links: tuple[str, str]
    reason: str
    status: Literal["never", "touches", "undecided"]
    joints: tuple[str, ...]
    configuration: dict[str, float]
    nearest: float | None
    proof: Proof | None = None

    @property
    def adjacent(self) -> bool:
        """Whether at most one joint is between the two links."""
        return len(self.joints) <= 1

    @property
    def steps(self) -> int:
        """How many steps the proof has."""
        return 0 if self.proof is None else len(self.proof.answers.answers)


class Links:
    """The links of a robot with the shapes of its file, meshes read once.

    `claimed` names the joints that move by themselves, and those that stand still.  `limits`, (joints, 2), say how
    far the former go, as a checker has it; nothing says it of those of the columns `endless`.
    """

    def __init__(self, urdf: RobotDescription) -> None:
        self.robot = urdf
        self.shapes: dict[str, list[Shape]] = {}
        for shape in opened(urdf.shapes):
            self.shapes.setdefault(shape.link, []).append(shape)
        alone = {joint.name: joint for joint in urdf.joints if joint.kind != "fixed" and joint.mimic is None}
        moving = tuple(name for name in urdf.order if name in alone and alone[name].lower < alone[name].upper)
        still = {name: float(alone[name].lower) for name in alone.keys() - set(moving)}
        held = {name: still[name] for name in sorted(still) if still[name] != 0.0}
        self.claimed = Claimed(moving, held, None, frozenset(), 0.0, {})
        self.tree = tree_of(urdf, self.claimed)
        found = [ranges_of(self.tree, moving, urdf, Scene(), (column,)) for column in range(len(moving))]
        self.endless = {column for column, ranges in enumerate(found) if ranges is None}
        turn = (-math.pi, math.pi)
        self.limits = np.array([turn if each is None else (each.low[0], each.high[0]) for each in found]).reshape(-1, 2)
        self._leaves: dict[str, list[tuple[Floats, float]]] = {}

    def leaves(self, link: str) -> list[tuple[Floats, float]]:
        """Return the convex parts of a link, as trees are made of."""
        if link not in self._leaves:
            pieces = map(piece_of, self.shapes[link])
            self._leaves[link] = [(piece.parts, piece.radius) for piece in pieces]
        return self._leaves[link]

    def between(self, links: tuple[str, str]) -> list[int]:
        """Return the columns of the joints that move two links against each other."""
        chains = [set(_chain(self.tree, self.tree.placement[link][0])) for link in links]
        return sorted({self.tree.moved[k][3] for k in chains[0] ^ chains[1]})

    def values(self, q: Floats) -> dict[str, Floats]:
        """Return the values, joint -> (n,), of all joints that move by themselves, at configurations (n, joints)."""
        alone = {joint.name for joint in self.robot.joints if joint.kind != "fixed" and joint.mimic is None}
        still = {name: np.full(len(q), self.claimed.held.get(name, 0.0)) for name in alone}
        return still | dict(zip(self.claimed.joints, q.T, strict=True))


def decide_pair(of: Links, links: tuple[str, str], reason: str, seconds: float) -> LinkPair:
    """Return whether two links ever touch, within some seconds."""
    columns = of.between(links)
    joints = tuple(of.claimed.joints[column] for column in columns)

    def pair(status: Literal["never", "touches", "undecided"], q: Floats, near: float | None) -> LinkPair:
        return LinkPair(links, reason, status, joints, dict(zip(joints, q[columns].tolist(), strict=True)), near)

    middle, nowhere = of.limits.mean(axis=1), LinkPair(links, reason, "undecided", joints, {}, None)
    if seconds <= 0.0:
        return nowhere
    bodies = tuple(bodies_of((shape for link in links for shape in of.shapes[link]), of.tree))
    claim = WorldClaim(of.tree, bodies, ((Owner(links[0]), Owner(links[1]), 0.0),), "shapes of the file")
    alone = claim.one_by_one(claim.pairs)
    if nested(claim, middle) is not None:
        return pair("touches", middle, 0.0)
    if of.endless & set(columns):
        return nowhere
    halved = _halved(of, bodies, columns)
    low, high = np.ascontiguousarray(of.limits.T)
    try:
        with until(Deadline.after(seconds)):
            contact = _contact(of, links, alone, columns) if columns else None
            if contact is not None:
                return pair("touches", contact, 0.0)
            if len(columns) > MOST_JOINTS:
                return nowhere
            answers = write_box(of.tree.native, alone.pairs[0].native, low, high, halved, _MOST)
    except BudgetSpent:
        answers = None
    if answers is None:
        return nowhere
    touch = answers.touch
    if touch.pair < 0:
        return LinkPair(links, reason, "never", joints, {}, None, Proof(halved, answers) if columns else None)
    near = max(touch.most, 0.0)
    return pair("touches" if near <= IN_CONTACT else "undecided", _middle(of.limits, halved, touch.share), near)


def _contact(of: Links, links: tuple[str, str], alone: Claim, columns: list[int]) -> Floats | None:
    """Return one of random states in which two links are in contact, None if none is."""
    low, high = of.limits.T
    # One joint is decided soon.
    samples = _SAMPLES if len(columns) > 1 else _SAMPLES // 20
    q = np.tile(of.limits.mean(axis=1), (samples, 1))
    q[:, columns] = (low + generator(0).random((samples, len(low))) * (high - low))[:, columns]
    trees = hull_trees({link: of.leaves(link) for link in links})
    for rows in np.array_split(q, samples // _BATCH):
        look_at_clock()
        poses = poses_at(of.robot, with_mimics(of.robot, of.values(rows)), len(rows))
        both = [poses[:, of.robot.links.index(link)] for link in links]
        for row in np.flatnonzero(contacts(trees, *links, *both)[:, 0] >= 0)[:_CONFIRMED]:
            if in_contact(alone, rows[row]):
                return np.asarray(rows[row])
    return None


def _halved(of: Links, bodies: Sequence[Body], columns: list[int]) -> Ints:
    """Return along which columns cells are halved, one after the other, so that points stray least from a straight way.

    By the rates u of the joints in a cell they do so by at most the sum of lever times u times (2 b + u), where b is
    the sum of rates of the joints above.
    """
    rows = _lever_rows(of, bodies)
    half, found = 0.5 * np.ptp(of.limits, axis=1), []
    for _ in range(_HALVINGS if columns else 0):
        strays = []
        for column in columns:
            narrower = half.copy()
            narrower[column] *= 0.5
            strays.append(sum(_stray(chain, narrower) for chain in rows))
        found.append(columns[int(np.argmin(strays))])
        half[found[-1]] *= 0.5
    return np.array(found, dtype=np.int64)


def _stray(chain: Sequence[tuple[int, float, bool, float]], half: Floats) -> float:
    above = stray = 0.0
    for column, factor, slides, lever in chain:
        rate = factor * float(half[column])
        turn = 0.0 if slides else rate
        stray += lever * rate * (2.0 * above + turn)
        above += turn
    return stray


def _lever_rows(of: Links, bodies: Sequence[Body]) -> list[list[tuple[int, float, bool, float]]]:
    """Return column, factor, whether it slides, and lever [m] of the joints that move each body, but not all, in order.

    Lengths of the chain add up from the body to the joint.
    """
    chains = {body.owner: _chain(of.tree, body.frame) for body in bodies}
    shared, found = set.intersection(*map(set, chains.values())), []
    for owner, chain in chains.items():
        every = [body.elements for body in bodies if body.owner == owner]
        reach = max(float(np.linalg.norm(each.points, axis=1).max()) + each.radius + each.disc for each in every)
        rows: list[tuple[int, float, bool, float]] = []
        for k in (each for each in chain if each not in shared):
            _, joint, at, column, factor, offset = of.tree.moved[k]
            slides = joint.kind == "prismatic"
            reach += float(np.abs(factor * of.limits[column] + offset).max()) if slides else 0.0
            rows.insert(0, (column, abs(factor), slides, 1.0 if slides else reach))
            reach += float(np.linalg.norm(at.xyz))
        found.append(rows)
    return found


def _middle(limits: Floats, halved: Ints, share: float) -> Floats:
    """Return the middle of the cell of which a share of 1 names the middle: its digits say which halves it is in."""
    (low, high), number = limits.T.copy(), share
    for column in halved:
        middle, number = 0.5 * (low[column] + high[column]), 2.0 * number
        if number == 1.0:
            break
        (high if number < 1.0 else low)[column] = middle
        number %= 1.0
    return np.asarray(0.5 * (low + high))


def untested_pairs(
    of: Links,
    pairs: Sequence[tuple[str, str, str]],
    seconds: float,
    report: Callable[[int, int], None] | None = None,
) -> list[LinkPair]:
    """Return what is known of pairs of links, each with the reason why it is not tested, in their order.

    Those with few joints between them come first, and leave their time to the others; `report` takes how many are done,
    of how many.
    """
    # What reads the files is not counted.
    end = Deadline.after(seconds)
    found: dict[int, LinkPair] = {}
    numbers = [i for i, (first, second, _) in enumerate(pairs) if {first, second} <= set(of.shapes)]
    for number in sorted(numbers, key=lambda i: len(of.between(pairs[i][:2]))):
        first, second, reason = pairs[number]
        share = end.left / (len(numbers) - len(found))
        found[number] = decide_pair(of, (first, second), reason, share)
        if report is not None:
            report(len(found), len(numbers))
    return [found[number] for number in numbers]


def _chain(tree: Tree, frame: int) -> list[int]:
    """Return the numbers of the joints that move a frame, from it to the root."""
    found = []
    while frame:
        found.append(frame - 1)
        frame = tree.moved[frame - 1][0]
    return found
