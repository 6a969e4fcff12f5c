"""Rigid bodies that have to find their way in space, built of boxes: Twistycool, and Cubicles."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from evenroad.geometry import rotation_from_heading
from evenroad.research.bench.task import Problem
from evenroad.research.worlds.rigid import OrientedBox, SolidWorld
from evenroad.space import SE3

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


Range = tuple[float, float]

_LOW, _HIGH = (-508.88, -230.13, -123.75), (319.62, 531.87, 101.0)
_HOUSE_X, _HOUSE_Y = (-508.9, 319.6), (-230.1, 531.9)
_BASEMENT_X = (53.2, 319.6)
_BASEMENT, _FLOOR, _GROUND, _ALL = (-123.75, 0.0), (9.84, 101.0), (0.0, 101.0), (-123.75, 101.0)
"""Ranges of z: of the walls of the basement, of the floor above, and of the outer walls without and with a basement."""

_HOLES_X, _HOLES_Y = (110.0, 296.0), ((-200.0, -91.0), (303.0, 465.0))
"""Holes in the slab between floor and basement, under the room of the goal, which has no door, and under another.

Of the first, only the area is known, from the share of free poses; where in the room it is does not matter to success.
"""

# fmt: off
_WALLS = (
    ("outer wall", 0, _GROUND, ((-508.9, *_HOUSE_Y),)),
    ("outer wall", 0, _ALL, ((319.6, *_HOUSE_Y),)),
    ("outer wall", 1, _GROUND, ((-230.1, _HOUSE_X[0], _BASEMENT_X[0]),)),
    ("outer wall", 1, _ALL, ((-230.1, *_BASEMENT_X),)),
    ("outer wall", 1, _GROUND, ((531.9, _HOUSE_X[0], _BASEMENT_X[0]),)),
    ("outer wall", 1, _ALL, ((531.9, *_BASEMENT_X),)),
    ("wall", 0, _FLOOR, (
        (-483.2, -209.9, -49.1), (-483.2, -20.6, 486.9), (-349.9, -49.1, -20.6), (-245.0, 45.3, 80.3),
        (-98.5, -107.8, 45.3), (-98.5, 80.3, 323.9), (-71.0, -107.8, 37.1), (-71.0, 72.4, 323.9),
        (71.5, -209.9, 37.1), (74.6, 266.9, 486.9), (98.6, 266.9, 486.9), (89.9, -213.5, 6.8),
        (89.9, 30.7, 72.4), (306.3, -213.5, 6.8), (306.3, 30.7, 486.9),
    )),
    ("wall", 1, _FLOOR, (
        (-213.5, 89.9, 306.3), (-209.9, -483.2, 71.5), (-107.8, -98.5, -71.0), (-49.1, -483.2, -349.9),
        (-20.6, -483.2, -349.9), (6.8, 89.9, 306.3), (30.7, 89.9, 306.3), (37.1, -71.0, 71.5),
        (45.3, -245.0, -98.5), (80.3, -245.0, -98.5), (72.4, -71.0, 89.9), (266.9, 74.6, 98.6),
        (323.9, -98.5, -71.0), (486.9, -483.2, 74.6), (486.9, 98.6, 306.3),
    )),
    ("basement wall", 0, _BASEMENT, (
        (53.2, *_HOUSE_Y), (72.3, -203.9, 531.9), (73.0, 476.8, 531.9), (301.8, -203.9, 301.0),
        (307.8, 301.0, 476.8),
    )),
    ("basement wall", 1, _BASEMENT, (
        (-203.9, 72.3, 301.8), (301.0, 301.8, 307.8), (476.8, 73.0, 307.8),
    )),
)
# fmt: on
"""Walls by name, the axis that they are across (x or y), their range of z, and of each its place on that axis and its
range on the other."""

_PILLARS: tuple[tuple[Range, Range, Range], ...] = (
    ((-381.0, -315.0), (287.0, 344.0), _FLOOR),
    ((-210.0, -152.0), (167.0, 217.0), _FLOOR),
    ((-247.0, -181.0), (-141.0, -65.0), _FLOOR),
    ((170.0, 233.0), (74.0, 146.0), _FLOOR),
    ((90.5, 154.0), (-84.0, -27.0), _BASEMENT),
)
"""Bounding boxes of hexagonal pillars: their x, y and z."""

_ARM = ((-22.0, -46.0, -13.24), (-3.0, 31.5, 13.24))
_FOOT = ((-3.0, 15.0, -13.24), (24.4, 31.4, 13.24))
_ANGLES_OF_BODY = (1.2, 1.7)
"""Degrees by which the body is rotated about z, and before that about x."""


def cubicles() -> Puzzle:
    """Return the puzzle: the body gets from a room of the floor into a closed one, through the basement.

    The scene of OMPL.app's problem of that name, built anew of boxes and rectangles after its measures.  Walls are
    surfaces: below the floor, outside of the basement, the body is free, as it is there.  Pillars are solid; of all
    poses 2 in 100 000 would be free inside of hollow ones.
    """
    pillars = (box for x, y, z in _PILLARS for box in pillar(x, y, z))
    return Puzzle(
        low=_LOW,
        high=_HIGH,
        start=(-4.96, -40.62, 70.57),
        goal=(200.0, -40.62, 70.57),
        body=_body(),
        obstacles=(*_walls(), *_slab(), *pillars),
    )


def _body() -> tuple[OrientedBox, ...]:
    about_z, about_x = (math.radians(angle) for angle in _ANGLES_OF_BODY)
    c, s = math.cos(about_z), math.sin(about_z)
    d, t = math.cos(about_x), math.sin(about_x)
    rotation = np.array([[c, -s * d, s * t], [s, c * d, -c * t], [0.0, t, d]])
    boxes = (OrientedBox.spanning(low, high) for low, high in (_ARM, _FOOT))
    return tuple(
        OrientedBox(
            (rotation @ box.centre).tolist(), box.half_extents, rotation.ravel().tolist(), name="body"
        )
        for box in boxes
    )


def _walls() -> Iterator[OrientedBox]:
    for name, axis, (bottom, top), walls in _WALLS:
        for at, *ends in walls:
            low, high = ((at, end) if axis == 0 else (end, at) for end in ends)
            yield OrientedBox.spanning((*low, bottom), (*high, top), name)


def _slab() -> list[OrientedBox]:
    """Return the floor around its holes.  Too thin for the body to fit inside, it may as well be solid."""
    beside_the_holes = ((_HOUSE_X[0], _HOLES_X[0]), (_HOLES_X[1], _HOUSE_X[1]))
    edges = (_HOUSE_Y[0], *(y for hole in _HOLES_Y for y in hole), _HOUSE_Y[1])
    between_the_holes = zip(edges[::2], edges[1::2], strict=True)
    pieces = [*((x, _HOUSE_Y) for x in beside_the_holes), *((_HOLES_X, y) for y in between_the_holes)]
    bottom, top = _GROUND[0], _FLOOR[0]
    return [OrientedBox.spanning((x[0], y[0], bottom), (x[1], y[1], top), name="slab") for x, y in pieces]


_ANGLES = 600
"""Headings among which the best is looked for; a hexagon looks the same after 60 degrees."""


def pillar(x: Range, y: Range, z: Range) -> tuple[OrientedBox, ...]:
    """Return the regular hexagon that fills the ranges of x and y best, over the range of z, as three boxes.

    A regular hexagon is the union of the three rectangles that two opposite sides span.
    """
    side, heading = _hexagon(x[1] - x[0], y[1] - y[0])
    middle = [(low + high) / 2.0 for low, high in (x, y, z)]
    half = [side * math.sqrt(3.0) / 2.0, side / 2.0, (z[1] - z[0]) / 2.0]
    boxes = []
    for k in range(3):
        a, b, c, d = rotation_from_heading(heading + (k + 0.5) * math.pi / 3.0)
        boxes.append(OrientedBox(middle, half, (a, b, 0.0, c, d, 0.0, 0.0, 0.0, 1.0), name="pillar"))
    return tuple(boxes)


def _hexagon(width: float, depth: float) -> tuple[float, float]:
    """Return the side of the regular hexagon that is so wide and deep, and the heading of one of its corners.

    A corner with the heading h is ``side cos h`` to the right, so that each heading asks for one side to be as wide
    and for another to be as deep; the heading where the two agree best is taken, and their mean.
    """
    best = (math.inf, 0.0, 0.0)
    for number in range(_ANGLES + 1):
        heading = number / _ANGLES * math.pi / 3.0
        corners = [heading + k * math.pi / 3.0 for k in range(6)]
        side_x = width / 2.0 / max(math.cos(corner) for corner in corners)
        side_y = depth / 2.0 / max(math.sin(corner) for corner in corners)
        best = min(best, (abs(side_x - side_y), (side_x + side_y) / 2.0, heading))
    return best[1], best[2]
