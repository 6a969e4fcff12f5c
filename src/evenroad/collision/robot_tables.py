"""RobotTables: what checks know of a robot, the same in every scene; made once per robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.placed_capsules import (
    FARTHEST,
    PlacedCapsule,
    PlacedHulls,
    farthest,
    largest_value,
    place_capsule,
    place_hulls,
    speed_bounds,
)
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.distance import segment_distance
from evenroad.geometry.hulls import Hull
from evenroad.robots.hull_trees import contacts, hull_trees
from evenroad.robots.moving_tree import MovingTree, moving_tree
from evenroad.robots.robot import Robot, pieces_of

PADDING = 2e-6
"""Single precision makes places uncertain by less than this share of the robot's reach (of 1 m at least)."""

_MOST_TURNED = 1e9
"""No angle may be larger [rad]: it would leave double precision too few digits."""


@dataclass(frozen=True, eq=False)
class RobotTables:
    """Tables of a robot for checks: capsules and hulls on moving frames, pairs that may touch, and their speeds.

    Attributes
    ----------
    capsules : tuple of PlacedCapsule
        Those that do not move come first.
    reach : float
        No point of the robot, padding included, is ever farther than this from the root's origin [m].
    capsule_pairs : tuple of pairs of int
        Capsules that are tested against each other.
    speeds, pair_speeds : float64 ndarrays, shapes (capsules, dim) and (capsule pairs + by_hulls, dim)
        How fast each coordinate moves a capsule, and the two of a pair against each other, at most [m/rad]; pairs of
        bodies of which hulls decide come after those of capsules.
    fixed_contact : tuple of 2 str, or None
        Two links that no joint moves on each other and that touch, though they are to be tested.
    body_pairs : tuple of pairs of str
        Links that are tested against each other; of the last `by_hulls` the hulls decide.
    hulls : mapping of str to PlacedHulls
        The hulls of all links, of none where all are round.
    """

    tree: MovingTree
    capsules: tuple[PlacedCapsule, ...]
    reach: float
    capsule_pairs: tuple[tuple[int, int], ...]
    speeds: Floats
    pair_speeds: Floats
    fixed_contact: tuple[str, str] | None
    body_pairs: tuple[tuple[str, str], ...]
    by_hulls: int
    hulls: Mapping[str, PlacedHulls]


def robot_tables(robot: Robot) -> RobotTables:
    """Return the tables of a robot.

    Raises InvalidValue if a capsule has a size that is not a finite number > 0, the robot has no capsules, a length is
    larger than 1e6 m, or an angle, or what a mimic multiplies by or adds, larger than 1e9; and UnknownName if capsules
    or pairs name a link that is not there.
    """
    tree = moving_tree(robot)
    _require_few_turns(robot, tree)
    if not robot.capsules:
        raise InvalidValue(f"robot {robot.name!r} has no capsules: every configuration would be free")
    placed = [place_capsule(capsule, tree) for capsule in robot.capsules]
    # By frame, then by link: bodies lie together, those that are fixed come first.
    order = sorted(range(len(placed)), key=lambda i: (placed[i].frame, robot.links.index(placed[i].link)))
    capsules = tuple(placed[i] for i in order)
    reach = farthest(tree, capsules, robot) + max((metres for _, metres in robot.padding), default=0.0)
    if reach > FARTHEST:
        raise InvalidValue(f"robot {robot.name!r} reaches {reach:.3g} m: more than {FARTHEST:g} leaves no digits")
    moving, fixed = _split_pairs(robot, tree)
    bodied = {capsule.link for capsule in capsules}
    hulls, sharp = _hulls_of(robot, tree)
    # Pairs decided by hulls come last, the most expensive ones at the end.
    work = {link: len(hulls[link].leaves) if link in sharp else 0 for link in bodied}
    pairs = sorted(filter(bodied.issuperset, moving), key=lambda pair: work[pair[0]] + work[pair[1]])
    of_hulls = [pair for pair in pairs if not sharp.isdisjoint(pair)]
    of = _by_link(capsules)
    capsule_pairs = tuple((i, k) for a, b in pairs for i in of[a] for k in of[b])
    number = {link: len(capsules) + i for i, link in enumerate(hulls)}
    every_pair = [*capsule_pairs, *((number[a], number[b]) for a, b in of_hulls)]
    speeds, pair_speeds = speed_bounds(tree, [*capsules, *hulls.values()], every_pair, robot)
    for array in (speeds, pair_speeds):
        array.setflags(write=False)
    return RobotTables(
        tree,
        capsules,
        reach,
        capsule_pairs,
        speeds[: len(capsules)],
        pair_speeds,
        _fixed_contact(capsules, hulls, fixed) if robot.pairs_given else None,
        tuple(pairs),
        len(of_hulls),
        hulls,
    )


def _require_few_turns(robot: Robot, tree: MovingTree) -> None:
    for frame in tree.frames:
        if max(abs(frame.multiplier), abs(frame.offset)) > _MOST_TURNED:
            raise InvalidValue(
                f"what follows joint {robot.group[frame.coordinate]!r} must do so with a multiplier and an offset of"
                f" at most {_MOST_TURNED:g}, got {frame.multiplier:g} and {frame.offset:g}"
            )
        if not frame.slides and largest_value(frame, robot) > _MOST_TURNED:
            raise InvalidValue(
                f"what joint {robot.group[frame.coordinate]!r} moves turns by up to"
                f" {largest_value(frame, robot):.3g} rad: more than {_MOST_TURNED:g} leaves no digits"
            )


def _split_pairs(robot: Robot, tree: MovingTree) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Return the pairs of links, each once, that move against each other, and those that do not."""
    moving: list[tuple[str, str]] = []
    fixed: list[tuple[str, str]] = []
    seen = set()
    for a, b in robot.pairs:
        for link in (a, b):
            if link not in tree.links:
                raise UnknownName.among("link", link, tree.links)
        if a == b or frozenset((a, b)) in seen:
            continue
        seen.add(frozenset((a, b)))
        (fixed if tree.links[a].frame == tree.links[b].frame else moving).append((a, b))
    return moving, fixed


def _by_link(capsules: Sequence[PlacedCapsule]) -> dict[str, list[int]]:
    """Return the numbers of every link's capsules."""
    numbers: dict[str, list[int]] = {}
    for i, capsule in enumerate(capsules):
        numbers.setdefault(capsule.link, []).append(i)
    return numbers


def _fixed_contact(
    capsules: Sequence[PlacedCapsule], hulls: Mapping[str, PlacedHulls], fixed: Sequence[tuple[str, str]]
) -> tuple[str, str] | None:
    """Return the first pair of links, fixed to each other, whose bodies touch, or None."""
    here, of = np.eye(4)[np.newaxis], _by_link(capsules)
    for a, b in fixed:
        for i in of.get(a, ()):
            for k in of.get(b, ()):
                endpoints = capsules[i].endpoints[np.newaxis], capsules[k].endpoints[np.newaxis]
                if segment_distance(*endpoints)[0] >= capsules[i].radius + capsules[k].radius:
                    continue
                trees = hull_trees({link: hulls[link].leaves for link in (a, b) if link in hulls})
                if len(trees.bodies) < 2 or contacts(trees, a, b, here, here)[0, 0] >= 0:
                    return a, b
    return None


def _hulls_of(robot: Robot, tree: MovingTree) -> tuple[dict[str, PlacedHulls], set[str]]:
    """Return the hulls of all bodies, of none if all are round; and the links of which some are not."""
    of_link: dict[str, list[Hull]] = {}
    for piece in (piece for pieces in pieces_of(robot).values() for piece in pieces):
        of_link.setdefault(piece.hull.link, []).append(piece.hull)
    sharp = {link for link, hulls in of_link.items() if not all(hull.is_round for hull in hulls)}
    return {link: place_hulls(hulls, tree) for link, hulls in of_link.items() if sharp}, sharp
