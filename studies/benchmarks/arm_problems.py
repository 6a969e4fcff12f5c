"""Problems for arms: shelves, boxes, cages and tables at random, with the tool in a place to reach at both ends.

Everything follows from a seed.  `TUNING` and `REPORTING` are apart: constants were chosen on the one, figures come
from the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.collision.arm_world import ArmWorld
from evenroad.datasets.random_scenes import cell_of
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from evenroad_studies.arms.robots import arm_named as arm_named

KINDS = ("shelf", "box", "cage", "table")
TUNING, REPORTING = range(1_000, 1_100), range(2_000, 2_100)
"""Seeds, one a problem of each kind."""

POOL = 400_000
"""From so many configurations those with the tool in a place are taken."""

CHOICE = 8
"""Postures that the second end is chosen from."""

Vector = npt.NDArray[np.float64]
Region = tuple[Vector, Vector, float]
"""Centre and half extents of a box for the tool's place, turned about z by an angle."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene, and two free configurations to join."""

    kind: str
    seed: int
    robot: Robot
    scene: Scene
    start: Vector
    goal: Vector


class Pool:
    """Configurations of a robot with the places of its tool, and how far its last link points down."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        space = ArmWorld(robot, Scene((), name="nothing")).space
        self.q = space.from_cube(np.random.default_rng(0).random((POOL, space.dim)))
        last = robot.links.index("tool0") if "tool0" in robot.links else len(robot.links) - 1
        self.tool = np.concatenate([link_poses(robot, q)[:, last, :3, 3] for q in np.array_split(self.q, 40)])

    def within(self, region: Region) -> Vector:
        """Return the configurations whose tool is in a region, (n, dim)."""
        return self.q[within(self.tool, region)]


def within(places: Vector, region: Region) -> npt.NDArray[np.bool_]:
    """Return which places, (n, 3), are in a region."""
    centre, half, angle = region
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = (places - centre)[:, :2].T
    inside = (np.abs(cosine * x + sine * y) <= half[0]) & (np.abs(cosine * y - sine * x) <= half[1])
    return inside & (np.abs(places[:, 2] - centre[2]) <= half[2])


def problems(pool: Pool, seeds: range, kinds: tuple[str, ...] = KINDS) -> Iterator[Problem]:
    """Yield a problem of each kind for each seed."""
    for seed in seeds:
        for kind in kinds:
            yield _problem(pool, kind, seed)


def _problem(pool: Pool, kind: str, seed: int) -> Problem:
    rng = np.random.default_rng([KINDS.index(kind), seed])
    robot = pool.robot
    while True:
        obstacles, regions = _SCENES[kind](rng)
        cell = cell_of(robot)
        scene = Scene((*cell.obstacles, *obstacles), name=f"{kind}{seed}", allowed=cell.allowed)
        world = ArmWorld(robot, scene)
        ends: list[Vector] = []
        for region in rng.permutation(len(regions))[:2]:
            inside = pool.within(regions[region])
            free = inside[world.valid(inside)]
            if len(free) > 0:
                some = free[rng.integers(len(free), size=CHOICE)]
                # As inverse kinematics that begins at the other end: the nearest of several postures.
                nearest = np.argmin(world.space.distance(some, np.broadcast_to(ends[0], some.shape))) if ends else 0
                ends.append(some[nearest])
        # Else another scene: this one cannot be reached into.
        if len(ends) == 2:
            return Problem(kind, seed, robot, scene, ends[0], ends[1])


def _about_z(angle: float) -> tuple[float, ...]:
    cosine, sine = float(np.cos(angle)), float(np.sin(angle))
    return (cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0)


def _boxes(name: str, centre: Vector, angle: float, parts: list[tuple[Vector, Vector]]) -> list[Obstacle]:
    """Return boxes, each given by its place and full extents in a frame at `centre` turned about z."""
    turn = np.array(_about_z(angle)).reshape(3, 3)
    return [
        Obstacle.of(f"{name} {i}", "box", tuple(size), tuple(centre + turn @ place), _about_z(angle))
        for i, (place, size) in enumerate(parts)
    ]


def _before(rng: np.random.Generator) -> Region:
    """Return a region above the table and before the robot, where arms wait."""
    angle = rng.uniform(-np.pi, np.pi)
    return np.array([0.45 * np.cos(angle), 0.45 * np.sin(angle), 0.55]), np.array([0.1, 0.1, 0.1]), angle


def _shelf(rng: np.random.Generator) -> tuple[list[Obstacle], list[Region]]:
    """A shelf of two columns and three rows, its open side towards the robot; the tool goes into compartments."""
    angle, away = rng.uniform(-0.8, 0.8), rng.uniform(0.62, 0.75)
    width, depth, height = rng.uniform(0.34, 0.44), 0.3, rng.uniform(0.28, 0.34)
    low, board = rng.uniform(0.02, 0.15), 0.02
    centre = np.array([away * np.cos(angle), away * np.sin(angle), low])
    parts = [(np.array([0.0, 0.0, row * height]), np.array([depth, 2 * width + 3 * board, board])) for row in range(4)]
    parts += [
        (np.array([0.0, side * (width + board), 1.5 * height]), np.array([depth, board, 3 * height]))
        for side in (-1, 0, 1)
    ]
    turn = np.array(_about_z(angle)).reshape(3, 3)
    regions = [
        (
            centre + turn @ np.array([-0.03, side * 0.5 * width, (row + 0.5) * height]),
            np.array([0.08, 0.3 * width, 0.25 * height]),
            angle,
        )
        for side in (-1, 1)
        for row in range(3)
    ]
    return _boxes("shelf", centre, angle, parts), [*regions, _before(rng)]


def _box(rng: np.random.Generator) -> tuple[list[Obstacle], list[Region]]:
    """One or two boxes on the table, open above or towards the robot; the tool goes 10 to 25 cm deep."""
    obstacles: list[Obstacle] = []
    regions = [_before(rng)]
    for number, angle in enumerate(rng.uniform(-0.4, 0.4) + np.array([-0.7, 0.7])[: rng.integers(1, 3)]):
        away, inner, deep, wall = (
            rng.uniform(0.5, 0.65),
            rng.uniform(0.26, 0.36),
            rng.uniform(0.2, 0.35),
            0.01,
        )
        open_above = rng.random() < 0.5
        centre = np.array([away * np.cos(angle), away * np.sin(angle), 0.0])
        half, middle = 0.5 * inner + 0.5 * wall, 0.5 * deep
        sides = [(np.array([0.0, s * half, middle]), np.array([inner, wall, deep])) for s in (-1, 1)]
        if open_above:
            sides += [(np.array([s * half, 0.0, middle]), np.array([wall, inner + 2 * wall, deep])) for s in (-1, 1)]
            place, reach = np.array([0.0, 0.0, deep - rng.uniform(0.05, 0.15)]), np.array([0.08, 0.08, 0.05])
        else:
            deep = inner
            middle = 0.5 * inner
            sides = [(np.array([0.0, s * half, middle]), np.array([inner, wall, inner])) for s in (-1, 1)]
            sides += [
                (np.array([half, 0.0, middle]), np.array([wall, inner + 2 * wall, inner])),
                (np.array([0.0, 0.0, inner + 0.5 * wall]), np.array([inner, inner + 2 * wall, wall])),
            ]
            place, reach = np.array([-0.05, 0.0, middle]), np.array([0.1, 0.08, 0.08])
        obstacles += _boxes(f"box {number}", centre, angle, sides)
        turn = np.array(_about_z(angle)).reshape(3, 3)
        regions.append((centre + turn @ place, reach, angle))
    return obstacles, regions


def _cage(rng: np.random.Generator) -> tuple[list[Obstacle], list[Region]]:
    """A cage of bars on the table, with a bar along every edge and some between; the tool goes in between bars."""
    angle, away, bar = rng.uniform(-0.8, 0.8), rng.uniform(0.5, 0.62), 0.015
    width, height = rng.uniform(0.5, 0.6), rng.uniform(0.45, 0.6)
    centre = np.array([away * np.cos(angle), away * np.sin(angle), 0.0])
    half = 0.5 * width
    parts = []
    for side in (-1, 1):
        for u in (-half, 0.0, half):
            parts.append((np.array([side * half, u, 0.5 * height]), np.array([bar, bar, height])))
        parts.append((np.array([0.0, side * half, 0.5 * height]), np.array([bar, bar, height])))
        for z in (0.5 * height, height):
            parts.append((np.array([side * half, 0.0, z]), np.array([bar, width, bar])))
            parts.append((np.array([0.0, side * half, z]), np.array([width, bar, bar])))
    inside: Region = (centre + np.array([0.0, 0.0, 0.45 * height]), np.array([0.12, 0.12, 0.12]), angle)
    return _boxes("bar", centre, angle, parts), [inside, _before(rng)]


def _clutter(rng: np.random.Generator) -> tuple[list[Obstacle], list[Region]]:
    """A table with 6 to 14 things on it; the tool goes low between them."""
    obstacles: list[Obstacle] = []
    count = rng.integers(6, 15)
    for i in range(count):
        angle, away = rng.uniform(-1.4, 1.4), rng.uniform(0.35, 0.8)
        tall = rng.uniform(0.1, 0.4)
        place = (away * np.cos(angle), away * np.sin(angle), 0.5 * tall)
        if rng.random() < 0.5:
            obstacles.append(Obstacle.of(f"thing {i}", "cylinder", (rng.uniform(0.03, 0.07), tall), place))
        else:
            size = (rng.uniform(0.05, 0.15), rng.uniform(0.05, 0.15), tall)
            obstacles.append(Obstacle.of(f"thing {i}", "box", size, place, _about_z(rng.uniform(-np.pi, np.pi))))
    regions: list[Region] = []
    for _ in range(2):
        angle, away = rng.uniform(-1.2, 1.2), rng.uniform(0.4, 0.7)
        middle = np.array([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.1, 0.2)])
        regions.append((middle, np.array([0.08, 0.08, 0.06]), angle))
    return obstacles, regions


_SCENES = {"shelf": _shelf, "box": _box, "cage": _cage, "table": _clutter}


def scene_of(kind: str, rng: np.random.Generator) -> tuple[list[Obstacle], list[Region]]:
    """Return the obstacles of a scene of this kind, and the regions that tools go to."""
    return _SCENES[kind](rng)
