"""The fair suite's problems: random worlds, starts and goals, new in every instance, that favour no place."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.geometry import rotation_from_heading, rotation_from_quaternion
from evenroad.space import SE2, SE3
from evenroad.world import World
from evenroad_studies.bench.task import Problem, ProblemSource
from evenroad_studies.mazes import MazeDesign, draw_maze
from evenroad_studies.worlds import PeriodicBalls, PeriodicBoxes
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld

FarApart = Callable[[Floats, Floats], Bools]
"""Which pairs of rows of two (m, d) arrays of the cube may be a start and a goal, (m,)."""
ENTROPY = 20_261_121
"""Root of every instance of the fair suite; the seed of a suite draws sets, never worlds."""


class Stream(IntEnum):
    """What instances are for; part of their seed, so that two streams share none."""

    CALIBRATION = 0
    TUNING = 1
    REPORTING = 2


PREFIX = {Stream.TUNING: "tune", Stream.REPORTING: "fair"}
"""Stream -> how the names of its problems begin; the calibration's instances are no problems."""


class Family(IntEnum):
    """Kinds of random worlds; the number is part of the seed."""

    BALLS = 0
    BOXES = 1
    MAZE = 2
    SE2 = 3
    SE3 = 4


def instance_rng(stream: Stream, family: Family, d: int, difficulty: int, number: int) -> np.random.Generator:
    """Return the generator of one instance: the same numbers in every process, others for every other instance."""
    key = (int(stream), int(family), d, difficulty, number)
    return np.random.default_rng(np.random.SeedSequence(ENTROPY, spawn_key=key))


def make_instance(stream: Stream, family: Family, d: int, difficulty: int, size: float, number: int) -> Problem:
    """Return the problem of this number >= 0; the same arguments give the same one, in every process.

    `d` is the dimension of the point sets: any of :data:`BALLS` for balls and boxes, 2 for mazes, 3 for SE(2) and 6 for
    SE(3).  `size` is that of the obstacles, or the width of the doors in mazes, meant to give uniform points a success
    of `difficulty` %, which is part of the seed.
    """
    ways: dict[Family, tuple[Callable[..., World], FarApart]] = {
        Family.BALLS: (partial(draw_balls, d), far_on_torus),
        Family.BOXES: (partial(draw_boxes, d), far_on_torus),
        Family.MAZE: (draw_disk_world, far_in_map),
        Family.SE2: (partial(draw_clutter, 2), partial(places_far_apart, 2)),
        Family.SE3: (partial(draw_clutter, 3), partial(places_far_apart, 3)),
    }
    draw, far_apart = ways[family]
    rng = instance_rng(stream, family, d, difficulty, number)
    world, start, goal = draw_query(partial(draw, size), far_apart, rng)
    return Problem(world, start, goal, set_dim=d)


PAIRS = 512
"""Pairs of configurations that are tried in one world."""
BATCH = 32
"""Pairs whose validity is asked about together: few, since most worlds need no more."""


def draw_query(
    draw_world: Callable[[np.random.Generator], World], far_apart: FarApart, rng: np.random.Generator
) -> tuple[World, Floats, Floats]:
    """Draw a world, a start and a goal, (dim,) each; `rng` is consumed.

    Start and goal are two uniform configurations: the first pair of which both are free, that is far apart, and
    between which the straight motion is blocked.  A world in which none of 512 pairs will do is replaced by the next.
    """
    while True:
        world = draw_world(rng)
        cube = rng.random((2, PAIRS, world.space.cube_dim))
        rows = np.flatnonzero(far_apart(cube[0], cube[1]))
        for begin in range(0, len(rows), BATCH):
            some = rows[begin : begin + BATCH]
            first, second = (world.space.from_cube(each[some]) for each in cube)
            both_free = world.valid(first) & world.valid(second)
            for start, goal in zip(first[both_free], second[both_free], strict=True):
                # One by one: the first pair nearly always does.
                if not world.motion_valid(start[np.newaxis], goal[np.newaxis])[0]:
                    return world, start, goal


def far_on_torus(a: Floats, b: Floats) -> Bools:
    """Return which rows of two (m, d) arrays in the unit cube are at least sqrt(d / 12) apart on the torus: (m,).

    That is the root of the mean square for two uniform points.  Measured in the cube instead, far ends would be
    ends near its faces; on the torus each end alone stays uniform.
    """
    step = np.abs(b - a)
    step = np.minimum(step, 1.0 - step)
    return np.asarray((step**2).sum(axis=1) >= a.shape[1] / 12.0)


BALLS: Mapping[int, int] = {2: 20, 3: 60, 4: 100, 5: 150, 6: 200, 7: 200, 10: 200}
BOXES: Mapping[int, int] = {2: 20, 3: 40, 4: 60, 5: 60, 6: 60, 7: 60, 10: 60}
"""Dimension -> number of obstacles; how large they are is calibrated.

Many rather than few: few large obstacles must leave so little of the cube free, to be as hard, that what is left of
any set looks random.
"""

BOUNDED_AXES = 3
"""Coordinates that a box bounds, like an obstacle in space; both of them in the plane."""


def draw_balls(d: int, radius: float, rng: np.random.Generator) -> PeriodicBalls:
    """Return balls of one radius with uniform centres."""
    return PeriodicBalls(rng.random((BALLS[d], d)), radius)


def draw_boxes(d: int, half_extent: float, rng: np.random.Generator) -> PeriodicBoxes:
    """Return boxes with uniform centres, in random axes, half extents uniform in [0.5, 1.5] times the given one."""
    count, bounded = BOXES[d], min(BOUNDED_AXES, d)
    axes = np.argsort(rng.random((count, d)), axis=1)[:, :bounded]
    centres = rng.random((count, bounded))
    half_extents = half_extent * (0.5 + rng.random((count, bounded)))
    return PeriodicBoxes(d, axes, centres, np.minimum(half_extents, 0.5))


ROBOT_RADIUS = 6.0
"""In pixels, as in the shipped mazes."""


def draw_disk_world(door: float, rng: np.random.Generator) -> World:
    """Return a maze of 8 x 6 rooms in 640 x 480 pixels, with doors of `door` pixels, also in a tenth of other walls."""
    design = MazeDesign(cols=8, rows=6, wall=8, door=round(door), loops=0.1)
    return draw_maze(design, rng=rng).map.world(ROBOT_RADIUS)


def far_in_map(a: Floats, b: Floats) -> Bools:
    """Return which rows of the unit square are half the map's width, 320 pixels, apart in the map: (m,)."""
    return np.asarray(np.hypot(640.0 * (b[:, 0] - a[:, 0]), 480.0 * (b[:, 1] - a[:, 1])) >= 320.0)


# Rigid bodies among random boxes.  Obstacles are scattered over more than the body can reach, so that their density is
# the same everywhere that it can: the bounds of the space are as free as its middle.

DENSITY = {2: 25.0, 3: 60.0}
"""Dimension of the place -> boxes in a unit of area or volume."""

BODY = {
    2: (OrientedBox((0.0, -0.04), (0.10, 0.02)), OrientedBox((-0.08, 0.04), (0.02, 0.06))),
    3: (
        OrientedBox((0.0, -0.06, 0.0), (0.14, 0.03, 0.03)),
        OrientedBox((-0.11, 0.05, 0.0), (0.03, 0.08, 0.03)),
        OrientedBox((0.11, -0.06, 0.08), (0.03, 0.03, 0.05)),
    ),
}
"""An L in the plane, and in space one with a foot: each side of them can be in the way."""

BODY_REACH = {2: 0.15, 3: 0.22}
"""How far the body reaches from its reference point, at most."""
RESOLUTION = {2: (0.01, 0.05), 3: (0.02, 0.08)}
"""Distance, and rotation [rad] as the space measures it, between states that are tested on a motion."""
ROTATION_WEIGHT = {2: 0.15, 3: 0.3}
"""What a radian of the space's metric counts: about the way that it moves the far end of the body."""


def draw_clutter(dim: int, size: float, rng: np.random.Generator) -> SolidWorld:
    """Return a body in the unit square or cube among rotated boxes, half extents in [0.4, 1.6] times `size`."""
    margin = BODY_REACH[dim] + 1.6 * size * np.sqrt(dim)
    count = rng.poisson(DENSITY[dim] * (1.0 + 2.0 * margin) ** dim)
    centres = -margin + (1.0 + 2.0 * margin) * rng.random((count, dim))
    half_extents = size * (0.4 + 1.2 * rng.random((count, dim)))
    rotations = [_random_rotation(dim, rng) for _ in range(count)]
    obstacles = list(map(OrientedBox, centres.tolist(), half_extents.tolist(), rotations))
    kind = SE2 if dim == 2 else SE3
    space = kind([0.0] * dim, [1.0] * dim, weights=(1.0, ROTATION_WEIGHT[dim]))
    return SolidWorld(space, BODY[dim], obstacles, RESOLUTION[dim])


def places_far_apart(dim: int, a: Floats, b: Floats) -> Bools:
    """Return which rows of the unit cube have places as far apart as :func:`far_on_torus` asks; rotations are free."""
    return far_on_torus(a[:, :dim], b[:, :dim])


def _random_rotation(dim: int, rng: np.random.Generator) -> tuple[float, ...]:
    if dim == 2:
        return rotation_from_heading(float(rng.uniform(-np.pi, np.pi)))
    w, x, y, z = rng.standard_normal(4).tolist()
    return rotation_from_quaternion(xyzw=(x, y, z, w))


DIFFICULTIES = (25, 50, 75)
"""Success of uniform points [%]."""
_TABLE = tomllib.loads((Path(__file__).parent / "fair.toml").read_text(encoding="utf-8"))
_MEASURED = {(Family[name.upper()], int(d)): of for name, by_d in _TABLE.items() for d, of in by_d.items()}
CALIBRATED_AT: Mapping[tuple[Family, int], int] = {key: of["n"] for key, of in _MEASURED.items()}
"""Family and dimension of the sets -> N of the calibration."""

SIZES: Mapping[tuple[Family, int], tuple[float, float, float]] = {
    key: tuple(of["sizes"]) for key, of in _MEASURED.items()
}
"""Family and dimension -> size for each difficulty: radius, middle half extent, for mazes width of doors [pixels]."""

ABOUT = {
    Family.BALLS: "random balls on the torus, exact straight motions",
    Family.BOXES: "random boxes that bound 3 random coordinates, exact straight motions",
    Family.MAZE: "random maze of rooms, disk of radius 6",
    Family.SE2: "an L of two boxes turns among random boxes in the plane",
    Family.SE3: "a body of three boxes turns among random boxes in space",
}

TUNED_ON = (Family.BALLS, Family.BOXES)
"""Families that may choose a default; the others are there to be reported on alone."""


class FairProblem(NamedTuple):
    """What decides a stream of random problems.

    `d` is the dimension of the point sets, `difficulty` the success of uniform points [%] with k = 10 symmetrised, and
    `size` that of the obstacles, as calibrated.
    """

    stream: Stream
    family: Family
    d: int
    difficulty: int
    size: float

    @property
    def name(self) -> str:
        """``fair-balls-5d-50``, ``tune-balls-5d-50``, ``fair-se2-25``, ..."""
        dimension = f"-{self.d}d" if self.tuned_on else ""
        return f"{PREFIX[self.stream]}-{self.family.name.lower()}{dimension}-{self.difficulty}"

    @property
    def n(self) -> int:
        """Points with which the difficulty was calibrated."""
        return CALIBRATED_AT[self.family, self.d]

    @property
    def tuned_on(self) -> bool:
        """Whether the family may choose a default."""
        return self.family in TUNED_ON

    def source(self) -> ProblemSource:
        """Return the problems by the number of their instance."""
        make = partial(make_instance, *self)
        about = f"{ABOUT[self.family]}; uniform solves {self.difficulty} % with N = {self.n}"
        return ProblemSource(self.name, self.d, make, random=True, about=about)


_EVERY = (
    FairProblem(stream, family, d, difficulty, size)
    for stream in PREFIX
    for (family, d), sizes in SIZES.items()
    for difficulty, size in zip(DIFFICULTIES, sizes, strict=True)
)
FAIR_PROBLEMS = {each.name: each for each in _EVERY if each.stream is Stream.REPORTING or each.tuned_on}
"""Name -> problem: ``fair-..`` for what is reported, ``tune-..`` for what chooses."""
FAIR = tuple(problem.source() for problem in FAIR_PROBLEMS.values())
