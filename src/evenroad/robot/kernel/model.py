"""ArmModel: what is tested against what, in the frames that move; the last step before packed tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.distance import segment_distance
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule
from evenroad.robot.kernel.cover import Cover, cover_capsule
from evenroad.robot.kernel.reach import farthest, largest_value
from evenroad.robot.kernel.separation import point_to_obstacle
from evenroad.robot.kernel.tree import MovingTree, Placement, moving_tree
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle, Scene

Vector = npt.NDArray[np.float64]

_FARTHEST = 1e6
"""No length may be larger [m]: single precision would leave decimetres, and fail altogether at 1e19."""

_MOST_TURNED = 1e9
"""No angle may be larger [rad]: it would leave double precision too few digits."""


@dataclass(frozen=True, eq=False)
class PlacedCapsule:
    """A capsule in the moving frame that it is fixed to.

    Attributes
    ----------
    link : str
        Link that it belongs to.
    frame : int
        Number of the frame.
    centre, half : ndarray, shape (3,)
        Middle of the segment, and the way from there to its end `b` [m].
    radius : float
        Of the capsule [m].
    cover : Cover
        The spheres that stand for it where obstacles are concerned.
    """

    link: str
    frame: int
    centre: Vector
    half: Vector
    radius: float
    cover: Cover

    @property
    def ends(self) -> Vector:
        """End points of its segment, (2, 3) [m]."""
        return np.stack([self.centre - self.half, self.centre + self.half])

    @property
    def half_length(self) -> float:
        """Half of the segment's length [m]."""
        return float(np.linalg.norm(self.half))


@dataclass(frozen=True, eq=False)
class ArmModel:
    """Frames, capsules and obstacles, and which of them are tested against each other.

    Attributes
    ----------
    tree : MovingTree
        The frames.
    capsules : tuple of PlacedCapsule
        Those that do not move come first.
    links : tuple of str
        The links that have capsules, in the order in which they come in `capsules`.
    obstacles : tuple of Obstacle
        Those that the robot can reach.
    tested : bool ndarray, shape (capsules, obstacles)
        Which capsules are tested against which obstacles.
    pairs : tuple of pairs of str
        Pairs of links that are tested and that can move against each other.
    standing_contact : tuple of 2 str, or None
        Two bodies that touch in every configuration, though they are to be tested.
    reach : float
        No point of the robot is ever farther than this from the root's origin [m].
    """

    tree: MovingTree
    capsules: tuple[PlacedCapsule, ...]
    links: tuple[str, ...]
    obstacles: tuple[Obstacle, ...]
    tested: npt.NDArray[np.bool_]
    pairs: tuple[tuple[str, str], ...]
    standing_contact: tuple[str, str] | None
    reach: float

    @property
    def standing(self) -> int:
        """How many capsules do not move."""
        return sum(capsule.frame == 0 for capsule in self.capsules)


def arm_model(robot: Robot, scene: Scene) -> ArmModel:
    """Return the model of `robot` in `scene`.

    Raises
    ------
    InvalidValue
        If a capsule or an obstacle has a size that is not a finite number > 0, the robot has no capsules, a length is
        larger than 1e6 m (but for boxes along the axes), or an angle, or what a mimic multiplies by or adds, larger
        than 1e9.
    UnknownName
        If capsules, pairs or allowed contacts name a link or an obstacle that is not there.
    """
    tree = moving_tree(robot)
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
    if not robot.capsules:
        raise InvalidValue(f"robot {robot.name!r} has no capsules: every configuration would be free")
    placed = [_placed(capsule, tree) for capsule in robot.capsules]
    # By frame, then by link: bodies lie together, those that stand come first.
    order = sorted(range(len(placed)), key=lambda i: (placed[i].frame, robot.links.index(placed[i].link)))
    capsules = tuple(placed[i] for i in order)
    links = tuple(dict.fromkeys(capsule.link for capsule in capsules))
    for obstacle in scene.obstacles:
        _require_sound(obstacle)
    reach = farthest(tree, capsules, robot)
    if reach > _FARTHEST:
        raise InvalidValue(
            f"robot {robot.name!r} reaches {reach:.3g} m: more than {_FARTHEST:g} leaves no digits"
        )
    obstacles = tuple(
        obstacle for obstacle in scene.obstacles if point_to_obstacle(np.zeros(3), obstacle) <= reach
    )
    tested = _tested(capsules, obstacles, scene, robot)
    for pair in robot.pairs:
        for link in pair:
            if link not in tree.links:
                raise UnknownName.among("link", link, tree.links)
    moving, fixed = _split_pairs(robot, tree)
    return ArmModel(
        tree,
        capsules,
        links,
        obstacles,
        tested,
        tuple(pair for pair in moving if pair[0] in links and pair[1] in links),
        _standing_contact(capsules, obstacles, tested, fixed),
        reach,
    )


def _placed(capsule: Capsule, tree: MovingTree) -> PlacedCapsule:
    if capsule.link not in tree.links:
        raise UnknownName.among("link", capsule.link, tree.links)
    a, b = np.array(capsule.a, dtype=np.float64), np.array(capsule.b, dtype=np.float64)
    if not (np.isfinite([*a, *b, capsule.radius]).all() and capsule.radius > 0.0):
        raise InvalidValue(f"a capsule must have finite ends and a radius > 0, got {capsule!r}")
    if max(map(abs, (*capsule.a, *capsule.b, capsule.radius))) > _FARTHEST:
        raise InvalidValue(f"a capsule must be no larger than {_FARTHEST:g} m, got {capsule!r}")
    place: Placement = tree.links[capsule.link]
    half = place.rotation @ (0.5 * (b - a))
    return PlacedCapsule(
        capsule.link,
        place.frame,
        place.rotation @ (0.5 * (a + b)) + place.translation,
        half,
        float(capsule.radius),
        cover_capsule(float(np.linalg.norm(half)), float(capsule.radius)),
    )


def _require_sound(obstacle: Obstacle) -> None:
    turn = np.reshape(obstacle.rotation, (3, 3))
    # A box along the axes is cut off where the robot never comes.
    cut = obstacle.shape == "box" and is_straight(turn)
    if not cut and max(map(abs, (*obstacle.size, *obstacle.xyz))) > _FARTHEST:
        raise InvalidValue(
            f"obstacle {obstacle.name!r} must be within {_FARTHEST:g} m, got size {obstacle.size!r} at {obstacle.xyz!r}"
        )


def _tested(
    capsules: Sequence[PlacedCapsule], obstacles: Sequence[Obstacle], scene: Scene, robot: Robot
) -> npt.NDArray[np.bool_]:
    names = {obstacle.name for obstacle in scene.obstacles}
    for link, name in scene.allowed:
        if link not in robot.links:
            raise UnknownName.among("link", link, robot.links)
        if name not in names:
            raise UnknownName.among("obstacle", name, names)
    tested = np.ones((len(capsules), len(obstacles)), dtype=np.bool_)
    for i, capsule in enumerate(capsules):
        for k, obstacle in enumerate(obstacles):
            tested[i, k] = (capsule.link, obstacle.name) not in scene.allowed
    return tested


def _split_pairs(robot: Robot, tree: MovingTree) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    """Return the pairs of links, each once, that move against each other, and those that do not."""
    moving: list[tuple[str, str]] = []
    fixed: list[tuple[str, str]] = []
    seen = set()
    for a, b in robot.pairs:
        if a == b or frozenset((a, b)) in seen:
            continue
        seen.add(frozenset((a, b)))
        (fixed if tree.links[a].frame == tree.links[b].frame else moving).append((a, b))
    return moving, fixed


def _standing_contact(
    capsules: Sequence[PlacedCapsule],
    obstacles: Sequence[Obstacle],
    tested: npt.NDArray[np.bool_],
    fixed: Sequence[tuple[str, str]],
) -> tuple[str, str] | None:
    """Return two bodies that touch whatever the joints do, or None."""
    for i, capsule in enumerate(capsules):
        for k, obstacle in enumerate(obstacles):
            if capsule.frame == 0 and tested[i, k]:
                for place in capsule.cover.places:
                    centre = capsule.centre + place * capsule.half
                    if point_to_obstacle(centre, obstacle) < capsule.cover.radius:
                        return capsule.link, obstacle.name
    for a, b in fixed:
        for first in (capsule for capsule in capsules if capsule.link == a):
            for second in (capsule for capsule in capsules if capsule.link == b):
                apart = segment_distance(first.ends[np.newaxis], second.ends[np.newaxis])[0]
                if apart < first.radius + second.radius:
                    return a, b
    return None


def is_straight(rotation: npt.NDArray[np.float64]) -> bool:
    """Return whether a rotation (3, 3) takes axes to axes, up to the rounding of sines of right angles."""
    return bool(np.abs(rotation - np.rint(rotation)).max() < 1e-14)


def clipped(obstacle: Obstacle, reach: float) -> Obstacle:
    """Return a box along the axes without what lies far beyond `reach`, where the robot never comes.

    A floor of a hundred metres would else cost digits: single precision has seven.
    """
    rotation = np.array(obstacle.rotation, dtype=np.float64).reshape(3, 3)
    if obstacle.shape != "box" or not is_straight(rotation):
        return obstacle
    centre, half = np.array(obstacle.xyz), np.abs(np.rint(rotation)) @ (0.5 * np.array(obstacle.size))
    low, high = np.maximum(centre - half, -2.0 * reach), np.minimum(centre + half, 2.0 * reach)
    return replace(obstacle, body=Box(tuple(high - low), pose=Pose(tuple(0.5 * (low + high)))))
