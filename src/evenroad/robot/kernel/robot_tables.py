"""RobotTables: the tables of a robot for compiled code, the same in every scene; made once per robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.distance import segment_distance
from evenroad.geometry.hulls import Hull
from evenroad.robot.kernel import layout
from evenroad.robot.kernel.hull_trees import contacts, hull_trees
from evenroad.robot.kernel.moving_tree import MovingTree, moving_tree
from evenroad.robot.kernel.placed_capsules import (
    FARTHEST,
    Cover,
    PlacedCapsule,
    PlacedHulls,
    farthest,
    largest_value,
    place_capsule,
    place_hulls,
    speed_bounds,
)
from evenroad.robot.robot import Robot, pieces_of

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

PADDING = 2e-6
"""Single precision makes places uncertain by less than this share of the robot's reach (of 1 m at least)."""

_MOST_TURNED = 1e9
"""No angle may be larger [rad]: it would leave double precision too few digits."""


@dataclass(frozen=True, eq=False)
class RobotTables:
    """A robot as compiled code reads it, in the order of ``layout.py``, and what its rows stand for.

    Attributes
    ----------
    capsules : tuple of PlacedCapsule
        Those that do not move come first.
    reach : float
        No point of the robot is ever farther than this from the root's origin [m].
    floats, singles : float64 and float32 ndarrays
        The robot as it is, and with larger radii, so that rounding never makes a verdict optimistic.
    capsule_pairs : tuple of pairs of int
        Capsules that are tested against each other.
    pair_margins : float64 ndarray, shape (capsule pairs + pairs of bodies of which hulls decide,)
        Capsules, or hulls, of a pair nearer to each other than this may touch by `singles` [m].
    speeds, pair_speeds : float64 ndarrays, shapes (capsules, dim) and (as many as margins, dim)
        How fast each coordinate moves a capsule, and the two of a pair against each other, at most [m/rad].
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
    ints: Ints
    floats: Floats
    singles: npt.NDArray[np.float32]
    capsule_pairs: tuple[tuple[int, int], ...]
    pair_margins: Floats
    speeds: Floats
    pair_speeds: Floats
    fixed_contact: tuple[str, str] | None
    body_pairs: tuple[tuple[str, str], ...]
    by_hulls: int
    hulls: Mapping[str, PlacedHulls]


@lru_cache(maxsize=32)
def enlarged(tables: RobotTables, clearance: float) -> RobotTables:
    """Return tables of bodies that are larger by a clearance [m] where obstacles are concerned, and for these alone."""
    floats, singles = tables.floats.copy(), tables.singles.copy()
    at, width = tables.ints[layout.CAPSULE_FLOATS], layout.CAPSULE_FLOAT_ROW
    bodies, body_width = tables.ints[layout.BODY_FLOATS], layout.BODY_FLOAT_ROW
    for numbers in (floats, singles):
        numbers[at:][: width * tables.ints[layout.CAPSULES]].reshape(-1, width)[:, 6] += clearance
        numbers[bodies:][: body_width * tables.ints[layout.BODIES]].reshape(-1, body_width)[:, 3:7] += clearance
        numbers.setflags(write=False)
    capsules = tuple(
        replace(
            capsule,
            radius=capsule.radius + clearance,
            cover=Cover(capsule.cover.positions, capsule.cover.radius + clearance),
        )
        for capsule in tables.capsules
    )
    reach = tables.reach + clearance
    return replace(tables, capsules=capsules, reach=reach, floats=floats, singles=singles)


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
    reach = farthest(tree, capsules, robot)
    if reach > FARTHEST:
        raise InvalidValue(f"robot {robot.name!r} reaches {reach:.3g} m: more than {FARTHEST:g} leaves no digits")
    moving, fixed = _split_pairs(robot, tree)
    bodied = {capsule.link for capsule in capsules}
    hulls, sharp = _hulls_of(robot, tree)
    # Pairs of which hulls decide come last, and of these the dearest.
    work = {link: len(hulls[link].leaves) if link in sharp else 0 for link in bodied}
    pairs = sorted(filter(bodied.issuperset, moving), key=lambda pair: work[pair[0]] + work[pair[1]])
    of_hulls = [pair for pair in pairs if not sharp.isdisjoint(pair)]
    of = _by_link(capsules)
    capsule_pairs = tuple((i, k) for a, b in pairs for i in of[a] for k in of[b])
    padding = PADDING * max(1.0, reach)
    packed = len(robot.group), tree, capsules, pairs, hulls, len(of_hulls)
    (ints, floats), padded = _pack(*packed, 0.0), _pack(*packed, padding)[1]
    radii = layout.PAIR_FLOAT_ROW * np.arange(len(capsule_pairs)) + ints[layout.PAIR_FLOATS] + 1
    number = {link: len(capsules) + i for i, link in enumerate(hulls)}
    every_pair = [*capsule_pairs, *((number[a], number[b]) for a, b in of_hulls)]
    speeds, pair_speeds = speed_bounds(tree, [*capsules, *hulls.values()], every_pair, robot)
    speeds = speeds[: len(capsules)]
    # Margins: once for what is added, once more for what rounding may add to that.
    tables = RobotTables(
        tree,
        capsules,
        reach,
        ints,
        floats,
        padded.astype(np.float32),
        capsule_pairs,
        np.concatenate([2.0 * (padded[radii] - floats[radii]), np.full(len(of_hulls), 4.0 * padding)]),
        np.ascontiguousarray(speeds),
        np.ascontiguousarray(pair_speeds),
        _fixed_contact(capsules, hulls, fixed) if robot.pairs_given else None,
        tuple(pairs),
        len(of_hulls),
        hulls,
    )
    arrays = ints, floats, tables.singles, tables.pair_margins, tables.speeds, tables.pair_speeds
    for array in arrays:
        array.setflags(write=False)
    return tables


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
                if len(trees.roots) < 2 or contacts(trees, a, b, here, here)[0, 0] >= 0:
                    return a, b
    return None


class _Rows:
    """Integers and floats as they are appended, section by section."""

    def __init__(self) -> None:
        self.header = [0] * layout.HEADER
        self.ints: list[int] = []
        self.floats: list[float] = []

    def begin(self, int_section: int | None, float_section: int | None) -> None:
        if int_section is not None:
            self.header[int_section] = layout.HEADER + len(self.ints)
        if float_section is not None:
            self.header[float_section] = len(self.floats)


def _pack(
    coordinates: int,
    tree: MovingTree,
    capsules: Sequence[PlacedCapsule],
    pairs: Sequence[tuple[str, str]],
    hulls: Mapping[str, PlacedHulls],
    by_hulls: int,
    padding: float,
) -> tuple[Ints, Floats]:
    """Return integers and floats, radii larger by `padding` [m]."""
    rows = _Rows()
    rows.header[layout.FRAMES] = len(tree.frames)
    rows.header[layout.COORDINATES] = coordinates
    bodies = len({capsule.link for capsule in capsules})
    rows.header[layout.SCRATCH] = layout.FRAME * (len(tree.frames) + 1) + layout.PLACED * (len(capsules) + bodies)
    rows.header[layout.CAPSULES] = len(capsules)
    rows.header[layout.FIXED_CAPSULES] = sum(capsule.frame == 0 for capsule in capsules)
    rows.begin(layout.FRAME_INTS, layout.FRAME_FLOATS)
    for frame in tree.frames:
        rows.ints += [frame.parent, frame.coordinate, int(frame.slides)]
        rows.floats += [*frame.rotation.ravel(), *frame.translation, frame.multiplier, frame.offset]
        rows.floats += [number - float(np.float32(number)) for number in (frame.multiplier, frame.offset)]
    rows.begin(layout.CAPSULE_INTS, layout.CAPSULE_FLOATS)
    first = 0
    for capsule in capsules:
        end = first + len(capsule.cover.positions)
        rows.ints += [capsule.frame, first, end]
        rows.floats += [*capsule.centre, *capsule.half, capsule.cover.radius + padding]
        first = end
    rows.begin(None, layout.SAMPLES)
    for capsule in capsules:
        rows.floats += capsule.cover.positions
    _pack_pairs(rows, tree, capsules, pairs, hulls, padding)
    rows.header[layout.HULL_PAIRS] = by_hulls
    rows.header[layout.PAIRS] += by_hulls
    rows.begin(None, layout.HULL_MARGINS)
    rows.floats += [2.0 * padding] * by_hulls
    return np.array([*rows.header, *rows.ints], dtype=np.int64), np.array(rows.floats, dtype=np.float64)


def _pack_pairs(
    rows: _Rows,
    tree: MovingTree,
    capsules: Sequence[PlacedCapsule],
    pairs: Sequence[tuple[str, str]],
    hulls: Mapping[str, PlacedHulls],
    padding: float,
) -> None:
    """Append bodies, which are links with capsules, pairs of bodies and pairs of capsules."""
    of = _by_link(capsules)
    bodies, groups = list(of), list(of.values())
    number = {link: i for i, link in enumerate(bodies)}
    balls = [_ball([capsules[i] for i in group]) for group in groups]
    frames = [tree.links[link].frame for link in bodies]
    rows.header[layout.BODIES] = len(bodies)
    rows.header[layout.FIXED_BODIES] = frames.count(0)
    roots = _pack_hulls(rows, hulls)
    rows.begin(layout.BODY_INTS, layout.BODY_FLOATS)
    for link, frame, group, (centre, radius) in zip(bodies, frames, groups, balls, strict=True):
        rows.ints += [frame, group[0], group[-1] + 1, roots.get(link, -1)]
        # Boxes are wider by twice the padding: they must not miss what the spheres, wider by one, would find.
        box = _half_extents([capsules[i] for i in group], centre) + 2.0 * padding
        rows.floats += [*centre, radius + padding, *box]
    rows.header[layout.BODY_PAIRS] = len(pairs)
    rows.begin(layout.BODY_PAIR_INTS, layout.BODY_PAIR_FLOATS)
    capsule_pairs: list[tuple[int, int]] = []
    for a, b in pairs:
        first = len(capsule_pairs)
        capsule_pairs += [(i, k) for i in of[a] for k in of[b]]
        rows.ints += [number[a], number[b], first, len(capsule_pairs)]
        rows.floats.append(balls[number[a]][1] + balls[number[b]][1] + 2.0 * padding)
    rows.header[layout.PAIRS] = len(capsule_pairs)
    rows.begin(layout.PAIR_INTS, layout.PAIR_FLOATS)
    for i, k in capsule_pairs:
        rows.ints += [i, k]
        a_half, b_half = (float(np.linalg.norm(capsules[number].half)) for number in (i, k))
        radii = capsules[i].radius + capsules[k].radius + 2.0 * padding
        squares = (a_half**2, b_half**2)
        rows.floats += [radii + a_half + b_half, radii, *(1.0 / s if s > 0.0 else 0.0 for s in squares)]


def _hulls_of(robot: Robot, tree: MovingTree) -> tuple[dict[str, PlacedHulls], set[str]]:
    """Return the hulls of all bodies, of none if all are round; and the links of which some are not."""
    of_link: dict[str, list[Hull]] = {}
    for piece in (piece for pieces in pieces_of(robot).values() for piece in pieces):
        of_link.setdefault(piece.hull.link, []).append(piece.hull)
    sharp = {link for link, hulls in of_link.items() if not all(hull.is_round for hull in hulls)}
    return {link: place_hulls(hulls, tree) for link, hulls in of_link.items() if sharp}, sharp


def _pack_hulls(rows: _Rows, hulls: Mapping[str, PlacedHulls]) -> dict[str, int]:
    """Append the trees over the hulls of all bodies, and return their roots."""
    # Points are counted in threes.
    rows.floats += [0.0] * (-len(rows.floats) % 3)
    trees = hull_trees({link: placed.leaves for link, placed in hulls.items()}, len(rows.floats) // 3)
    rows.begin(layout.NODE_INTS, None)
    rows.header[layout.NODE_FLOATS] = len(rows.floats) + int(trees.ints[layout.NODE_FLOATS])
    rows.ints += trees.ints[layout.HEADER :].tolist()
    rows.floats += trees.floats.tolist()
    return dict(trees.roots)


def _ball(capsules: Sequence[PlacedCapsule]) -> tuple[Floats, float]:
    """Return centre and radius of a ball that holds capsules of one frame: around the middle of their box."""
    endpoints = [(end, c.radius) for c in capsules for end in (c.centre - c.half, c.centre + c.half)]
    low = np.min([end - radius for end, radius in endpoints], axis=0)
    high = np.max([end + radius for end, radius in endpoints], axis=0)
    centre = 0.5 * (low + high)
    return centre, max(float(np.linalg.norm(end - centre)) + radius for end, radius in endpoints)


def _half_extents(capsules: Sequence[PlacedCapsule], centre: Floats) -> Floats:
    """Return the half extents of a box about `centre` that holds the spheres that cover capsules of one frame."""
    return np.max(
        [
            np.abs(c.centre + position * c.half - centre) + c.cover.radius
            for c in capsules
            for position in c.cover.positions
        ],
        axis=0,
    )
