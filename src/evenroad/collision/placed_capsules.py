"""Capsules in the frames that move: spheres that cover them, and bounds on how far and fast joints can carry them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.hulls import Hull
from evenroad.geometry.shapes import Capsule
from evenroad.robots.moving_tree import MovingFrame, MovingTree
from evenroad.robots.robot import Robot
from evenroad.space.joints import SLACK

Floats = npt.NDArray[np.float64]

LARGEST_EXCESS = 1.10
"""The radius of spheres that cover a capsule is at most this many times the capsule's."""

FARTHEST = 1e6
"""No length may be larger [m]: single precision would leave decimetres, and fail altogether at 1e19."""


@dataclass(frozen=True)
class Cover:
    """Spheres along a capsule whose union contains it.

    Attributes
    ----------
    positions : tuple of floats
        Centres along the segment, from -1 at one end to 1 at the other.
    radius : float
        Of every sphere [m].
    """

    positions: tuple[float, ...]
    radius: float


@dataclass(frozen=True, eq=False)
class PlacedCapsule:
    """A capsule in the moving frame that it is fixed to.

    Attributes
    ----------
    link : str
        Link that it belongs to.
    frame : int
        Number of the frame; 0 is the root link's, which does not move.
    centre, half : ndarray, shape (3,)
        Middle of the segment, and the vector from there to its end `b` [m].
    radius : float
        Of the capsule [m].
    cover : Cover
        The spheres that stand for it where obstacles are concerned.
    """

    link: str
    frame: int
    centre: Floats
    half: Floats
    radius: float
    cover: Cover

    @property
    def endpoints(self) -> Floats:
        """Ends of the segment, (2, 3)."""
        return np.stack([self.centre - self.half, self.centre + self.half])


@dataclass(frozen=True, eq=False)
class PlacedHulls:
    """The hulls of a link in the moving frame that it is fixed to: their corners and by how much they are widened."""

    frame: int
    leaves: tuple[tuple[Floats, float], ...]

    @property
    def endpoints(self) -> Floats:
        """All corners, (n, 3)."""
        return np.concatenate([corners[0] for corners, _ in self.leaves])


Placed = PlacedCapsule | PlacedHulls


def place_hulls(hulls: Sequence[Hull], tree: MovingTree) -> PlacedHulls:
    """Return the hulls of one link in its frame."""
    placement = tree.links[hulls[0].link]
    leaves = [((h.points @ placement.rotation.T + placement.translation)[np.newaxis], h.radius) for h in hulls]
    return PlacedHulls(placement.frame, tuple(leaves))


def place_capsule(capsule: Capsule, tree: MovingTree) -> PlacedCapsule:
    """Return a capsule in its frame.

    Raises InvalidValue if it has a size that is not a finite number > 0, or one larger than 1e6 m, and UnknownName if
    it is of a link that is not there.
    """
    if capsule.link not in tree.links:
        raise UnknownName.among("link", capsule.link, tree.links)
    a, b = np.array(capsule.a, dtype=np.float64), np.array(capsule.b, dtype=np.float64)
    if not (all(map(math.isfinite, (*capsule.a, *capsule.b, capsule.radius))) and capsule.radius > 0.0):
        raise InvalidValue(f"a capsule must have finite ends and a radius > 0, got {capsule!r}")
    if max(map(abs, (*capsule.a, *capsule.b, capsule.radius))) > FARTHEST:
        raise InvalidValue(f"a capsule must be no larger than {FARTHEST:g} m, got {capsule!r}")
    placement = tree.links[capsule.link]
    half = placement.rotation @ (0.5 * (b - a))
    return PlacedCapsule(
        capsule.link,
        placement.frame,
        placement.rotation @ (0.5 * (a + b)) + placement.translation,
        half,
        float(capsule.radius),
        cover_capsule(float(np.linalg.norm(half)), float(capsule.radius)),
    )


@lru_cache(maxsize=4096)
def cover_capsule(half_length: float, radius: float) -> Cover:
    """Return the fewest spheres, evenly spaced, that cover a capsule at no more than `LARGEST_EXCESS`.

    The spheres' radius is R.  Neighbours d apart cover the tube between them if ``R^2 >= radius^2 + (d/2)^2``,
    and the outermost cover the caps if they lie at most ``R - radius`` inside the ends, since a ball holds
    every smaller one that touches it from within.  With both taken as equalities n spheres reach a half
    length of ``(n - 1) sqrt(R^2 - radius^2) + (R - radius)``, which rises with R: the least R is found by bisection.

    Parameters
    ----------
    half_length : float
        Half of the segment's length, >= 0 [m].
    radius : float
        Of the capsule, > 0 [m].
    """
    if half_length == 0.0:
        return Cover((0.0,), radius)
    most = LARGEST_EXCESS * radius
    gaps = max(0, math.ceil((half_length - (most - radius)) / math.sqrt(most**2 - radius**2)))
    least = radius
    for _ in range(60):
        middle = 0.5 * (least + most)
        if gaps * math.sqrt(middle**2 - radius**2) + (middle - radius) < half_length:
            least = middle
        else:
            most = middle
    outermost = (half_length - (most - radius)) / half_length if gaps else 0.0
    positions = [outermost * (2.0 * i / gaps - 1.0) for i in range(gaps + 1)] if gaps else [0.0]
    return Cover(tuple(positions), most)


def joint_arms(tree: MovingTree, capsules: Sequence[Placed], robot: Robot) -> npt.NDArray[np.float64]:
    """Return how fast each frame moves the segment of each capsule at most, shape (capsules, frames) [m/rad or m/m].

    A frame that turns by dq moves a point by at most |dq| times the point's distance from the z axis; for
    points of the frame itself that is known, for those of frames further out it is at most the way to the
    next frame's origin, seen along z, and from there on straight through all origins.  A frame that slides
    moves every point by |dq|.  Column f is for frame f + 1 and the change of its coordinate (a mimic's
    multiplier is included); 0 where the frame does not carry the capsule.
    """
    arms = np.zeros((len(capsules), len(tree.frames)))
    lengths = _lengths(tree, robot)
    for row, capsule in zip(arms, capsules, strict=True):
        endpoints = capsule.endpoints
        aside = float(np.hypot(endpoints[:, 0], endpoints[:, 1]).max())
        straight = float(np.linalg.norm(endpoints, axis=1).max())
        number = capsule.frame
        while number > 0:
            frame, (slide, across, away) = tree.frames[number - 1], lengths[number - 1]
            row[number - 1] = abs(frame.multiplier) * (1.0 if frame.slides else aside)
            straight += slide
            aside = straight + across
            straight += away
            number = frame.parent
    return arms


def _lengths(tree: MovingTree, robot: Robot) -> list[tuple[float, float, float]]:
    """Return of each frame how far it slides at most, and how far its origin is from the z axis before it, and from
    the origin before it [m].
    """
    return [
        (
            _longest_slide(frame, robot),
            float(np.hypot(frame.translation[0], frame.translation[1])),
            float(np.linalg.norm(frame.translation)),
        )
        for frame in tree.frames
    ]


def speed_bounds(
    tree: MovingTree, capsules: Sequence[Placed], pairs: Sequence[tuple[int, int]], robot: Robot
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return how fast each coordinate moves capsules, and those of a pair against each other, at most [m/rad].

    The arrays have shapes (capsules, dim) and (pairs, dim).  Frames that carry both of a pair move them as one body.
    """
    by_frame = joint_arms(tree, capsules, robot)
    first, second = (by_frame[[pair[end] for pair in pairs]].reshape(-1, by_frame.shape[1]) for end in (0, 1))
    of_frame = {number: _carriers(tree, number) for number in {capsule.frame for capsule in capsules}}
    carriers = [of_frame[capsule.frame] for capsule in capsules]
    common = np.zeros(first.shape, dtype=np.bool_)
    for row, (i, k) in zip(common, pairs, strict=True):
        row[[number - 1 for number in carriers[i] & carriers[k]]] = True
    to_coordinate = np.zeros((by_frame.shape[1], len(robot.group)))
    for column, frame in enumerate(tree.frames):
        to_coordinate[column, frame.coordinate] = 1.0
    return by_frame @ to_coordinate, np.where(common, 0.0, first + second) @ to_coordinate


def _carriers(tree: MovingTree, number: int) -> set[int]:
    """Return the numbers of the frames that carry what is fixed to a frame, itself included."""
    carriers = set()
    while number > 0:
        carriers.add(number)
        number = tree.frames[number - 1].parent
    return carriers


def farthest(tree: MovingTree, capsules: Sequence[PlacedCapsule], robot: Robot) -> float:
    """Return a distance from the root's origin beyond which no capsule ever reaches [m]."""
    most, lengths = 0.0, _lengths(tree, robot)
    for capsule in capsules:
        endpoints = capsule.endpoints
        straight = float(np.linalg.norm(endpoints, axis=1).max()) + 1.2 * capsule.radius
        number = capsule.frame
        while number > 0:
            slide, _, away = lengths[number - 1]
            straight += slide + away
            number = tree.frames[number - 1].parent
        most = max(most, straight)
    return most


def largest_value(frame: MovingFrame, robot: Robot) -> float:
    """Return the largest size of a frame's value within the limits of the joint that moves it [rad or m]."""
    joint = next(joint for joint in robot.joints if joint.name == robot.group[frame.coordinate])
    endpoints = (-math.pi, math.pi) if joint.kind == "continuous" else (joint.lower, joint.upper)
    return max(abs(frame.multiplier * value + frame.offset) for value in endpoints)


def _longest_slide(frame: MovingFrame, robot: Robot) -> float:
    """Return how far a frame's origin can slide from where it is at value 0; nothing where it turns."""
    return largest_value(frame, robot) + abs(frame.multiplier) * SLACK if frame.slides else 0.0
