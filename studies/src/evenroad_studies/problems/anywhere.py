"""Random worlds with start and goal anywhere: blocks, blocks as dense at the faces, corridors, arms in clutter.

Blocks bound all axes.  If their centres are uniform in the cube, places near the faces are freer than the middle, and
paths lead there.  If centres also lie beyond the faces, no place is freer.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from evenroad import ArmWorld, Box, Scene
from evenroad._arrays import Floats
from evenroad.errors import UnknownName
from evenroad.robot import Robot, load_robot
from evenroad.world import World
from evenroad_studies.arms.robots import DATA
from evenroad_studies.bench.task import Problem
from evenroad_studies.problems.apart import COUNTS as POINTS
from evenroad_studies.problems.apart import Use
from evenroad_studies.worlds.obstacles import Boxes, Cave

ENTROPY = 20_261_129
"""Root of every world of these families."""

PAIRS = 64
"""Pairs of start and goal that are tried in one world."""


class Kind(IntEnum):
    """Kinds of worlds; the number is part of the seed."""

    BLOCKS = 0
    FACES = 1
    CORRIDOR = 2
    UR5 = 3
    ARM7 = 4
    TWOARM = 5
    PANDA = 6


BLOCKS = (20, 40)
"""Number of blocks in the cube, to tune and to report."""

DENSITY = (6, 10)
"""Blocks per unit of volume where they also lie beyond the faces."""

NODES = (4, 6)
"""Number of corners of a corridor, with its ends, to tune and to report."""

OBSTACLES = ((6, 12), (9, 19))
"""Range of the number of boxes around an arm, to tune and to report; the upper end is excluded."""

NEAR, FAR = 0.25, 0.9
"""Distances of the boxes' centres from the base [m]."""

ARMS: Mapping[Kind, tuple[str | Path, int]] = {
    Kind.UR5: ("ur5", 6),
    Kind.ARM7: ("arm7", 7),
    Kind.TWOARM: (DATA / "twoarm.urdf", 8),
    Kind.PANDA: ("panda", 7),
}
"""Kind -> the robot's file, or name, and its number of joints; a Panda comes with the extra [robots]."""


def blocks(beyond: float, use: Use, d: int, half: float, rng: np.random.Generator) -> World:
    """Return boxes of half extents 0.5 to 1.5 times `half`; centres lie up to `beyond` times that outside the cube."""
    margin = beyond * 1.5 * half
    count = round(DENSITY[use] * (1.0 + 2.0 * margin) ** d) if beyond else BLOCKS[use]
    centres = -margin + (1.0 + 2.0 * margin) * rng.random((count, d))
    halves = half * (0.5 + rng.random((count, d)))
    low, high = centres - halves, centres + halves
    meets = ((low < 1.0) & (high > 0.0)).all(axis=1)
    return Boxes(low[meets], high[meets])


def corridor(use: Use, d: int, radius: float, rng: np.random.Generator) -> World:
    """Return one bent corridor of this radius between random corners."""
    nodes = rng.random((NODES[use], d))
    centres = [nodes]
    for first, last in pairwise(nodes):
        count = 2 + int(4.0 * np.linalg.norm(last - first) / radius)
        centres.append(first + np.linspace(0.0, 1.0, count)[:, np.newaxis] * (last - first))
    # The ends come first, for `ends_of`.
    every = np.concatenate([nodes[[0, -1]], *centres])
    return Cave(every, np.full(len(every), radius))


@lru_cache
def _robot(kind: Kind) -> Robot:
    return load_robot(ARMS[kind][0])


def clutter(kind: Kind, use: Use, d: int, half: float, rng: np.random.Generator) -> World:
    """Return an arm among boxes anywhere within its reach, half extents 0.4 to 1.6 times `half` [m]."""
    count = int(rng.integers(*OBSTACLES[use]))
    directions = rng.standard_normal((count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    # Uniform in the volume between two spheres.
    away = np.cbrt(rng.uniform(NEAR**3, FAR**3, count))
    extents = 2.0 * half * rng.uniform(0.4, 1.6, (count, 3))
    boxes = [
        Box(tuple(size), xyz=tuple(place), name=f"box {i}")
        for i, (size, place) in enumerate(zip(extents.tolist(), (directions * away[:, None]).tolist(), strict=True))
    ]
    return ArmWorld(_robot(kind), Scene(boxes))


def is_here(kind: Kind) -> bool:
    """Return whether the robot of a kind is installed; other kinds have none."""
    try:
        if kind in ARMS:
            _robot(kind)
    except UnknownName:
        return False
    return True


MAKERS: Mapping[Kind, Callable[[Use, int, float, np.random.Generator], World]] = {
    Kind.BLOCKS: partial(blocks, 0.0),
    Kind.FACES: partial(blocks, 1.0),
    Kind.CORRIDOR: corridor,
    **{kind: partial(clutter, kind) for kind in ARMS},
}


def make(use: Use, kind: Kind, d: int, size: float, number: int) -> Problem:
    """Return the problem of this number >= 0, the same in every process.

    Start and goal are uniform in free space, in a corridor near its ends; the straight motion is blocked.  A world in
    which none of 64 pairs will do is replaced by the next.
    """
    rng = np.random.default_rng(np.random.SeedSequence(ENTROPY, spawn_key=(int(use), int(kind), d, number)))
    while True:
        world = MAKERS[kind](use, d, size, rng)
        first, second = ends_of(world, rng)
        both = world.valid(first) & world.valid(second)
        first, second = first[both], second[both]
        blocked = np.flatnonzero(~world.motion_valid(first, second))
        if len(blocked):
            return Problem(world, first[blocked[0]], second[blocked[0]], set_dim=d)


def ends_of(world: World, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return candidates for start and goal, (64, d) each."""
    d = world.space.cube_dim
    first, second = rng.random((2, PAIRS, d))
    if isinstance(world, Cave):
        offsets = world.radii[0] / np.sqrt(d) * (2.0 * rng.random((2, PAIRS, d)) - 1.0)
        first, second = np.clip(world.centres[:2, np.newaxis] + offsets, 0.0, 1.0)
        return first, second
    return world.space.from_cube(first), world.space.from_cube(second)


ARM_POINTS = 256
"""N of the calibration of arms; that of other kinds is that of the worlds apart."""

DIMENSIONS = range(2, 9)
COUNTS: Mapping[tuple[Kind, int], int] = {
    **{(kind, d): POINTS[d] for kind in Kind if kind not in ARMS for d in DIMENSIONS},
    **{(kind, joints): ARM_POINTS for kind, (_, joints) in ARMS.items()},
}
"""Kind and dimension -> N of the calibration."""

_TABLE = tomllib.loads((Path(__file__).parent / "anywhere.toml").read_text(encoding="utf-8"))
SIZES: Mapping[tuple[Use, Kind, int], float] = {
    (Use[use.upper()], Kind[kind.upper()], int(d)): size
    for use, kinds in _TABLE.items()
    for kind, sizes in kinds.items()
    for d, size in sizes.items()
}
"""Use, kind and dimension -> size, with which uniform points solve a quarter to three quarters."""
