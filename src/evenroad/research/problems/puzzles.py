"""Rigid bodies that have to find their way in space: what a puzzle is, and Twistycool, built of boxes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from evenroad.research.bench.task import Problem
from evenroad.space import SE3
from evenroad.world.solids import OrientedBox, SolidWorld

Triple = tuple[float, float, float]

_SHARE = 0.01
"""Resolution of motions, as a share of the extents of the translations and of the rotations: OMPL's default."""

_NOT_ROTATED = (1.0, 0.0, 0.0, 0.0)


class Puzzle(NamedTuple):
    """A rigid body among boxes in space; it starts and ends not rotated, at translations between `low` and `high`."""

    low: Triple
    high: Triple
    start: Triple
    goal: Triple
    body: tuple[OrientedBox, ...]
    obstacles: tuple[OrientedBox, ...]


def problem_of(make: Callable[[], Puzzle], set_dim: int, instance: int) -> Problem:
    """Return the puzzle by OMPL's rules: distance ``|dt| + arccos |q . q'|``, a hundredth of both extents as steps."""
    puzzle = make()
    resolution = (_SHARE * math.dist(puzzle.low, puzzle.high), _SHARE * math.pi / 2.0)
    world = SolidWorld(SE3(puzzle.low, puzzle.high), puzzle.body, puzzle.obstacles, resolution)
    start, goal = (np.array([*place, *_NOT_ROTATED]) for place in (puzzle.start, puzzle.goal))
    return Problem(world, start, goal, set_dim)


_SECTION = 11.75
"""Width of the body's bars."""

_CORNER = (-16.99, -17.906, -24.839)
"""The bars' common corner, from the body's reference point."""

_TILT = math.atan2(2.63, 54.94)
"""By which the body's axes are rotated about -y."""

_BARS = (
    ((0.0, 0.0, 0.0), (55.0, _SECTION, _SECTION)),
    ((0.0, 0.0, 0.0), (_SECTION, _SECTION, 48.0)),
    ((0.0, 0.0, 36.25), (_SECTION, 54.0, 48.0)),
)
"""Low and high corners of the bars in the body's axes."""


def twistycool() -> Puzzle:
    """Return the puzzle, with bounds of the translation near the window.

    The scene of OMPL.app's problem of that name, built anew of boxes after its measures.  There plate, slabs and body
    are surfaces with nothing inside; here they are solid, which is the same: the plate is thinner than the body's
    bars, and the slabs are too far from the bounds for the body to be inside one.
    """
    return Puzzle(
        low=(244.0, 135.0, -405.0),
        high=(284.0, 175.0, -195.0),
        start=(270.0, 160.0, -200.0),
        goal=(270.0, 160.0, -400.0),
        body=tuple(_bar(low, high) for low, high in _BARS),
        obstacles=_obstacles(),
    )


def _bar(low: Triple, high: Triple) -> OrientedBox:
    cosine, sine = math.cos(_TILT), math.sin(_TILT)
    rotation = (cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine)
    along = OrientedBox.spanning(low, high)
    centre = [_CORNER[i] + sum(rotation[3 * i + j] * along.centre[j] for j in range(3)) for i in range(3)]
    return OrientedBox(centre, along.half_extents, rotation, name="bar")


def _obstacles() -> tuple[OrientedBox, ...]:
    plate_low, plate_high = (62.0, -24.25, -304.105), (457.2, 320.75, -293.855)
    window_x, window_y = (239.375, 287.875), (130.331, 179.581)
    bottom, top = plate_low[2], plate_high[2]
    plate = (
        ((plate_low[0], plate_low[1]), (window_x[0], plate_high[1])),
        ((window_x[1], plate_low[1]), (plate_high[0], plate_high[1])),
        ((window_x[0], plate_low[1]), (window_x[1], window_y[0])),
        ((window_x[0], window_y[1]), (window_x[1], plate_high[1])),
    )
    return (
        *(OrientedBox.spanning((*low, bottom), (*high, top), name="plate") for low, high in plate),
        OrientedBox.spanning((14.46, -24.25, -504.86), (62.0, 321.25, -74.6), name="slab x"),
        OrientedBox.spanning((14.46, -24.25, -504.86), (457.96, -10.0, -72.86), name="slab y"),
    )
