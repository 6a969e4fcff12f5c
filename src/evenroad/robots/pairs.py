"""Pairs of links that are tested against each other, and hulls that decide where their capsules touch."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._rng import generator
from evenroad.geometry.hulls import Hull, Piece, halves, share_inside
from evenroad.robots.hull_trees import HullTrees, contacts, hull_trees
from evenroad.robots.kinematics import KinematicTree, held_values, poses_at, with_mimics

SAMPLES = 1000
"""Number of random configurations that find pairs that are always in contact."""
TOUCHING = "touch in every sample"
"""Reason why a pair whose shapes touch in all of them is not tested."""
HELD_TOUCHING = "touch in every sample with the other joints where they are held"
"""Reason why another is not tested, until these joints are held elsewhere."""
CONTAINED = "one goes into the other as drawn"
"""Reason why a third is not tested: a single joint moves one in and out of the other."""
_MOSTLY = 0.5
"""Fraction of samples in which two such links touch, and of the volume of one that is inside the other."""
_MOST_HULLS = 128
"""Number of hulls of a link above which none is split."""
_MOST_ROWS = 20
"""Number of touching samples in which the depth of one in the other is measured."""
_ROUNDS = 12
_LOOKED_AT = 400
"""Number of samples by which hulls are judged."""
_RESTING = 1e-5
"""Distance below which two shapes count as touching, if they do so in all samples [m]."""
_FEW = 0.003
"""Largest share of samples in which hulls of a pair may touch though the shapes do not."""
Pieces = Mapping[str, Sequence[Piece]]
"""The shapes of every link that has any, as hulls and what these are around."""


@dataclass(frozen=True)
class SelfPairs:
    """Pairs of links that are tested, in the order of the links; and the others with bodies, each with the reason.

    Pairs in `always` are tested and touch in every sample.  Pairs in `held` are dropped only at the held values of
    other joints, pairs in `contained` because one link goes into the other as drawn.  `never_free` is a text with the
    pair that blocks most, if no sample is free; else it is empty.
    """

    tested: tuple[tuple[str, str], ...]
    dropped: tuple[tuple[str, str, str], ...]
    always: tuple[tuple[str, str], ...]
    held: tuple[tuple[str, str], ...]
    contained: tuple[tuple[str, str], ...]
    hulls: tuple[Hull, ...]
    never_free: str


def self_pairs(
    robot: KinematicTree,
    pieces: Pieces,
    untested: Mapping[frozenset[str], str] | None = None,
    drop_touching: bool = True,
) -> SelfPairs:
    """Return the pairs of links with bodies that are tested, and hulls that hardly touch where the shapes do not.

    Pairs that no joint moves on each other are dropped, and pairs in `untested`, which an SRDF or an MJCF gives with
    reasons.  Without these (None), neighbours in the tree are dropped; links without bodies do not count if only one
    joint moves between two links.  With `drop_touching`, pairs are dropped whose shapes touch in each of 1000
    configurations, uniform within the limits of all joints, and in as many with the other joints held.  So are pairs on
    the two sides of one joint that touch in most samples, where most of one link is inside the other: a bellows, drawn
    into the base.  Pairs that never touch are kept, because samples prove nothing.
    """
    order = [link for link in robot.links if link in pieces]
    reasons = _untested(robot, pieces, untested)
    samples = _Samples(robot, {link: list(pieces[link]) for link in order})
    candidates = [pair for pair in combinations(order, 2) if pair not in reasons]
    always = samples.judge(candidates)
    if drop_touching:
        reasons |= always
        rigid = rigid_links(robot)
        over = {joint.child: rigid[joint.parent] for joint in robot.joints if joint.kind != "fixed"}
        # A single joint moves them on each other.
        near = [(a, b) for a, b in candidates if over.get(rigid[a]) == rigid[b] or over.get(rigid[b]) == rigid[a]]
        near = [pair for pair in near if pair not in always]
        reasons |= dict.fromkeys(filter(samples.contains, near), CONTAINED)
    every = list(combinations(order, 2))
    tested = tuple(pair for pair in every if pair not in reasons)
    hulls = tuple(piece.hull for link in order for piece in samples.pieces[link])
    return SelfPairs(
        tested,
        tuple((*pair, reasons[pair]) for pair in every if pair in reasons),
        tuple(pair for pair in always if pair not in reasons),
        tuple(pair for pair, why in reasons.items() if why == HELD_TOUCHING),
        tuple(pair for pair, why in reasons.items() if why == CONTAINED),
        # Balls and capsules need no other shapes.
        () if all(hull.is_round for hull in hulls) else hulls,
        samples.never_free(tested),
    )


def pairs_of(
    robot: KinematicTree, pieces: Pieces, untested: Mapping[frozenset[str], str] | None = None
) -> tuple[tuple[str, str], ...]:
    """Return the pairs that would be tested if none always touched, in the order of the links."""
    order = [link for link in robot.links if link in pieces]
    reasons = _untested(robot, pieces, untested)
    return tuple(pair for pair in combinations(order, 2) if pair not in reasons)


def _untested(
    robot: KinematicTree, pieces: Pieces, untested: Mapping[frozenset[str], str] | None
) -> dict[tuple[str, str], str]:
    """Return the pairs that are never tested, each with the reason."""
    order = [link for link in robot.links if link in pieces]
    rigid, above = rigid_links(robot), bodied_above(robot, pieces)
    reasons: dict[tuple[str, str], str] = {}
    for first, second in combinations(order, 2):
        if rigid[first] == rigid[second]:
            reasons[first, second] = "fixed to each other"
        elif untested is not None and frozenset((first, second)) in untested:
            reasons[first, second] = untested[frozenset((first, second))]
        elif untested is None and above[second] == (first, 1):
            reasons[first, second] = "neighbours"
    return reasons


def rigid_links(robot: KinematicTree) -> dict[str, str]:
    """Return for every link the first of those that are rigidly joined to it."""
    first = {robot.links[0]: robot.links[0]}
    for joint in robot.joints:
        first[joint.child] = first[joint.parent] if joint.kind == "fixed" else joint.child
    return first


def bodied_above(robot: KinematicTree, bodied: Collection[str]) -> dict[str, tuple[str, int]]:
    """Return for every link the next one above it with a body, if any, and the number of moving joints between them."""
    # Two joints with a length between them fold, and bring together what does not touch by construction.
    above = {robot.links[0]: ("", 0)}
    for joint in robot.joints:
        link, moving = (joint.parent, 0) if joint.parent in bodied else above[joint.parent]
        above[joint.child] = link, moving + (joint.kind != "fixed")
    return above


class _Samples:
    """A robot in random configurations: which pairs touch there, by their hulls and by what these are around."""

    def __init__(self, robot: KinematicTree, pieces: dict[str, list[Piece]]) -> None:
        self.pieces, self._shapes = pieces, dict(pieces)
        self.touching: dict[tuple[str, str], Ints] = {}
        self.looked_at = np.arange(0)
        poses = _sampled_poses(robot)
        self._poses = {link: poses[:, robot.links.index(link)] for link in pieces}
        self._parts = hull_trees({link: [(p.parts, p.radius) for p in of] for link, of in pieces.items()})

    def judge(self, pairs: Sequence[tuple[str, str]]) -> dict[tuple[str, str], str]:
        """Return the pairs whose shapes touch in all samples, or in all of the group, each with which of the two.

        Hulls of others that touch too often are split.
        """
        every = np.arange(len(next(iter(self._poses.values()))))
        some, of_group = every[:: 1 + len(every) // _LOOKED_AT], every[-SAMPLES:]
        self.looked_at = np.intersect1d(some, of_group)
        trees = self._hulls()
        balls = {link: trees.ball(link) for link in self.pieces}
        centres = {
            link: self._poses[link][some, :3, :3] @ ball[:3] + self._poses[link][some, :3, 3]
            for link, ball in balls.items()
        }
        always: dict[tuple[str, str], str] = {}
        wrong = {}
        for first, second in pairs:
            reach = balls[first][3] + balls[second][3]
            rows = some[np.linalg.norm(centres[first] - centres[second], axis=1) <= reach]
            self.touching[first, second] = rows
            if not len(rows):
                continue
            rows = rows[self._touching(trees, first, second, rows)]
            inside = self._touching(self._parts, first, second, rows)
            self.touching[first, second] = rows[inside]
            wrong[first, second] = rows[~inside]
            if np.isin(self.looked_at, rows).all():
                touching = self._rest(first, second, every)
                if touching[of_group].all():
                    always[first, second] = TOUCHING if touching.all() else HELD_TOUCHING
                    wrong[first, second] = rows[:0]
        for _ in range(_ROUNDS):
            wrong = self._split({pair: rows for pair, rows in wrong.items() if len(rows) > _FEW * len(some)})
        return always

    def contains(self, pair: tuple[str, str]) -> bool:
        """Return whether two links touch in most samples and most of one is inside the other in one of these."""
        first, second = pair
        rows = np.intersect1d(self.looked_at, self.touching[pair])
        if len(rows) <= _MOSTLY * len(self.looked_at):
            return False
        rows = rows[:: 1 + len(rows) // _MOST_ROWS]
        relative = np.asarray(np.linalg.inv(self._poses[second][rows]) @ self._poses[first][rows], np.float64)
        back = np.asarray(np.linalg.inv(relative), np.float64)
        shares = (
            share_inside(self._shapes[first], self._shapes[second], relative),
            share_inside(self._shapes[second], self._shapes[first], back),
        )
        return bool(np.max(shares) > _MOSTLY)

    def never_free(self, tested: Sequence[tuple[str, str]]) -> str:
        """Return which tested pair blocks most, if one of them touches in all samples of the group."""
        rows = self.looked_at
        times = {pair: np.isin(rows, self.touching[pair]) for pair in tested if len(self.touching[pair])}
        if not times or not np.any(list(times.values()), axis=0).all():
            return ""
        (first, second), worst = max(times.items(), key=lambda item: item[1].sum())
        return (
            f"none of {len(rows)} random configurations is free of self-collision; {first!r} and {second!r} touch in"
            f" {100.0 * worst.mean():.0f} % of them: disable pairs that may touch in an SRDF, or narrow the limits of"
            " joints"
        )

    def _split(self, wrong: Mapping[tuple[str, str], Ints]) -> dict[tuple[str, str], Ints]:
        """Split all hulls that touch in these samples; return those in which others still touch."""
        trees, left = self._hulls(), {}
        hit: dict[str, set[int]] = {}
        for (first, second), rows in wrong.items():
            meeting = self._contacts(trees, first, second, rows)
            left[first, second] = rows[meeting[:, 0] >= 0]
            for link, leaves in zip((first, second), meeting.T, strict=True):
                hit.setdefault(link, set()).update(leaves[leaves >= 0].tolist())
        for link, leaves in hit.items():
            if len(self.pieces[link]) < _MOST_HULLS:
                self.pieces[link] = [
                    half
                    for i, piece in enumerate(self.pieces[link])
                    for half in (halves(piece) if i in leaves else (piece,))
                ]
        return left

    def _rest(self, first: str, second: str, rows: Ints) -> Bools:
        """Return where two bodies touch or rest on each other, though rounding may part the two, (n,)."""
        wider = {link: [(p.parts, p.radius + 0.5 * _RESTING) for p in self._shapes[link]] for link in (first, second)}
        return self._touching(hull_trees(wider), first, second, rows)

    def _touching(self, trees: HullTrees, first: str, second: str, rows: Ints) -> Bools:
        return self._contacts(trees, first, second, rows)[:, 0] >= 0

    def _contacts(self, trees: HullTrees, first: str, second: str, rows: Ints) -> Ints:
        return contacts(trees, first, second, self._poses[first][rows], self._poses[second][rows])

    def _hulls(self) -> HullTrees:
        return hull_trees(
            {link: [(p.hull.points[np.newaxis], p.hull.radius) for p in of] for link, of in self.pieces.items()}
        )


def _sampled_poses(robot: KinematicTree) -> Floats:
    """Return the poses of all links, (n, links, 4, 4), in random configurations, of all joints and of the group."""
    movable = [joint for joint in robot.joints if joint.kind != "fixed" and joint.mimic is None]
    # A full circle for continuous joints, which have no limits.
    circle = [np.pi if joint.kind == "continuous" else np.inf for joint in movable]
    low = np.maximum([joint.lower for joint in movable], np.negative(circle))
    high = np.minimum([joint.upper for joint in movable], circle)
    q = low + generator(0).random((SAMPLES, len(movable))) * (high - low)
    held = held_values(robot)
    if held:
        columns = [i for i, joint in enumerate(movable) if joint.name in held]
        q = np.concatenate([q, q])
        q[SAMPLES:, columns] = [held[movable[i].name] for i in columns]
    values = with_mimics(robot, {joint.name: q[:, i] for i, joint in enumerate(movable)})
    return poses_at(robot, values, len(q))
