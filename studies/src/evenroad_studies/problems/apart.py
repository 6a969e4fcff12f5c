"""Random worlds where nothing repeats, start and goal at opposite faces: slots, forests, rooms, caves and bars.

The fair suite's obstacles repeat along every axis, so that no place of the cube is freer than another.  A robot's do
not: walls end at faces, and who wants to cross the cube begins near one face and ends near another.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from enum import IntEnum
from functools import partial
from pathlib import Path

import numpy as np

from evenroad._arrays import Ints
from evenroad.world import World
from evenroad_studies.bench.task import Problem, ProblemSource
from evenroad_studies.worlds.obstacles import Boxes, Cave, Rods

ENTROPY = 20_261_124
"""Root of every world of these families."""

FACE = 0.1
"""Depth of the two layers, at opposite faces, that start and goal are drawn from."""

PAIRS = 256
"""Pairs of start and goal that are tried in one world."""


class Use(IntEnum):
    """What worlds are for.  The two have other numbers of obstacles, other proportions and other seeds."""

    TUNING = 0
    REPORTING = 1


class Kind(IntEnum):
    """Kinds of worlds; the number is part of the seed."""

    SLOTS = 0
    FOREST = 1
    ROOMS = 2
    CAVE = 3
    BARS = 4


def slots(use: Use, order: Ints, width: float, rng: np.random.Generator) -> World:
    """Return walls across one axis, each with an opening of this width in at most two of the other axes."""
    d = len(order)
    walls, thickness = ((2, 0.06), (3, 0.03))[use]
    low, high = [], []
    for wall in range(walls):
        at = (wall + 0.6 + 0.8 * rng.random()) / (walls + 1)
        others = rng.permutation(order[1:])[:2]
        begin = rng.random(len(others)) * (1.0 - width)
        for axis, edge in zip(others, begin, strict=True):
            for side in (0, 1):
                box = np.full((2, d), [[-np.inf], [np.inf]])
                box[:, order[0]] = at, at + thickness
                box[1 - side, axis] = edge if side == 0 else edge + width
                low.append(box[0])
                high.append(box[1])
    return Boxes(np.array(low), np.array(high))


COLUMNS = (30, 50)
"""Number of columns of a forest, to tune and to report."""


def forest(use: Use, order: Ints, radius: float, rng: np.random.Generator) -> World:
    """Return columns: disks in two random axes."""
    count, d = COLUMNS[use], len(order)
    axes = np.argsort(rng.random((count, d)), axis=1)[:, :2]
    centres = 1.1 * rng.random((count, 2)) - 0.05
    return Rods(d, axes, centres, centres, radius)


def rooms(use: Use, order: Ints, width: float, rng: np.random.Generator) -> World:
    """Return rooms in a grid over at most three axes; doors of this width join them in a random tree and some more."""
    d = len(order)
    axes = min(d, 3)
    each, thickness, loops = {2: ((4, 0.03, 0.1), (5, 0.02, 0.2)), 3: ((3, 0.05, 0.1), (4, 0.03, 0.2))}[axes][use]
    if d > 3:
        each = 2 if use is Use.TUNING else 3
    size = 1.0 / each
    cells = np.stack(np.meshgrid(*[np.arange(each)] * axes, indexing="ij"), axis=-1).reshape(-1, axes)
    walls = [(cell, axis) for cell in cells for axis in range(axes) if cell[axis] + 1 < each]
    group = {tuple(cell): i for i, cell in enumerate(cells)}
    low, high = [], []
    for i in rng.permutation(len(walls)):
        cell, axis = walls[i]
        beyond = cell.copy()
        beyond[axis] += 1
        one, other = group[tuple(cell)], group[tuple(beyond)]
        open_ = one != other or rng.random() < loops
        group = {key: one if value == other else value for key, value in group.items()}
        wall = np.full((2, d), [[-np.inf], [np.inf]])
        wall[:, order[:axes]] = cell * size, (cell + 1) * size
        wall[:, order[axis]] = (cell[axis] + 1) * size - thickness / 2, (cell[axis] + 1) * size + thickness / 2
        door = min(width, 1.0) * size
        parts = [wall] if not open_ else []
        for along in range(axes) if open_ else ():
            if along != axis:
                begin = wall[0, order[along]] + rng.random() * (size - door)
                before, after = wall.copy(), wall.copy()
                before[1, order[along]], after[0, order[along]] = begin, begin + door
                parts += [before, after]
        low += [part[0] for part in parts]
        high += [part[1] for part in parts]
    return Boxes(np.array(low), np.array(high))


def cave(use: Use, order: Ints, radius: float, rng: np.random.Generator) -> World:
    """Return tunnels of about this radius along the shortest tree of random chambers, and along some more ways."""
    chambers, more = ((10, 3), (16, 4))[use]
    nodes = rng.random((chambers, len(order)))
    # From one face to the other.
    nodes[0, order[0]], nodes[1, order[0]] = 0.05, 0.95
    gaps = np.linalg.norm(nodes[:, np.newaxis] - nodes, axis=2)
    joined, pairs = {0}, []
    while len(joined) < chambers:
        inside = sorted(joined)
        outside = [i for i in range(chambers) if i not in joined]
        i, j = np.unravel_index(gaps[np.ix_(inside, outside)].argmin(), (len(inside), len(outside)))
        pairs.append((inside[i], outside[j]))
        joined.add(outside[j])
    pairs += [tuple(rng.choice(chambers, 2, replace=False)) for _ in range(more)]
    centres, radii = [nodes], [np.full(chambers, 1.4 * radius)]
    for i, j in pairs:
        count = 2 + int(3.0 * gaps[i, j] / radius)
        at = np.linspace(0.0, 1.0, count)[:, np.newaxis]
        centres.append(nodes[i] + at * (nodes[j] - nodes[i]))
        radii.append(radius * (0.8 + 0.4 * rng.random(count)))
    return Cave(np.concatenate(centres), np.concatenate(radii))


def bars(use: Use, order: Ints, radius: float, rng: np.random.Generator) -> World:
    """Return rods of random directions, each in at most three random axes."""
    d = len(order)
    count, longest = (((20, 0.5), (30, 0.4)) if d == 2 else ((40, 0.5), (60, 0.8)))[use]
    axes = np.argsort(rng.random((count, d)), axis=1)[:, : min(d, 3)]
    first = 1.1 * rng.random(axes.shape) - 0.05
    direction = rng.standard_normal(axes.shape)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return Rods(d, axes, first, first + longest * rng.random((count, 1)) * direction, radius)


MAKERS: Mapping[Kind, Callable[[Use, Ints, float, np.random.Generator], World]] = {
    Kind.SLOTS: slots,
    Kind.FOREST: forest,
    Kind.ROOMS: rooms,
    Kind.CAVE: cave,
    Kind.BARS: bars,
}


def make(use: Use, kind: Kind, d: int, size: float, number: int) -> Problem:
    """Return the problem of this number >= 0, the same in every process.

    Start and goal are uniform in layers at two opposite faces, in caves in two chambers there; both are free, and the
    straight motion is blocked.  A world in which none of 256 pairs will do is replaced by the next.
    """
    rng = np.random.default_rng(np.random.SeedSequence(ENTROPY, spawn_key=(int(use), int(kind), d, number)))
    while True:
        order = rng.permutation(d)
        world = MAKERS[kind](use, order, size, rng)
        first, second = rng.random((2, PAIRS, d))
        first[:, order[0]] *= FACE
        second[:, order[0]] = 1.0 - FACE * second[:, order[0]]
        if isinstance(world, Cave):
            # In the first two chambers: in many dimensions hardly a point of a layer is in a tunnel.
            offsets = world.radii[0] / np.sqrt(d) * (2.0 * rng.random((2, PAIRS, d)) - 1.0)
            first, second = np.clip(world.centres[:2, np.newaxis] + offsets, 0.0, 1.0)
        both = world.valid(first) & world.valid(second)
        first, second = first[both], second[both]
        blocked = np.flatnonzero(~world.motion_valid(first, second))
        if len(blocked):
            return Problem(world, first[blocked[0]], second[blocked[0]], set_dim=d)


COUNTS: Mapping[int, int] = {2: 128, 3: 256, 4: 256, 5: 256, 6: 512, 7: 512, 8: 512, 9: 512, 10: 512}
"""Dimension -> N of the calibration."""

_TABLE = tomllib.loads((Path(__file__).parent / "apart.toml").read_text(encoding="utf-8"))
SIZES: Mapping[tuple[Use, Kind, int], float] = {
    (Use[use.upper()], Kind[kind.upper()], int(d)): size
    for use, kinds in _TABLE.items()
    for kind, sizes in kinds.items()
    for d, size in sizes.items()
}
"""Use, kind and dimension -> size, with which uniform points solve about half: ``studies.benchmarks.apart_sizes``."""

ABOUT = {
    Kind.SLOTS: "walls with slots across the cube",
    Kind.FOREST: "columns in random pairs of axes",
    Kind.ROOMS: "rooms with doors",
    Kind.CAVE: "tunnels between chambers",
    Kind.BARS: "rods in random directions",
}
DIMENSION = {f"apart-{kind.name.lower()}-{d}d": d for kind in Kind for d in COUNTS}
"""Name of a problem that is reported -> its dimension."""
APART = tuple(
    ProblemSource(
        f"apart-{kind.name.lower()}-{d}d",
        d,
        partial(make, Use.REPORTING, kind, d, SIZES[Use.REPORTING, kind, d]),
        random=True,
        about=f"{ABOUT[kind]}; start and goal at opposite faces, N = {n}",
    )
    for kind in Kind
    for d, n in COUNTS.items()
)
