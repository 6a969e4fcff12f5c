"""Rigid bodies that have to find their way in space, built of boxes: Twistycool, and Cubicles."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from evenroad.geometry import rotation_from_heading
from evenroad.space import SE3
from evenroad_studies.bench.task import Problem
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld

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


Range = Sequence[float]
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
    scene = tomllib.loads((Path(__file__).parent / "cubicles.toml").read_text(encoding="utf-8"))
    heights = scene["z"]
    pillars = (box for of in scene["pillars"] for box in pillar(of["x"], of["y"], heights[of["z"]]))
    return Puzzle(
        low=tuple(scene["low"]),
        high=tuple(scene["high"]),
        start=(-4.96, -40.62, 70.57),
        goal=(200.0, -40.62, 70.57),
        body=_body(),
        obstacles=(*_walls(scene), *_slab(scene), *pillars),
    )


def _body() -> tuple[OrientedBox, ...]:
    about_z, about_x = (math.radians(angle) for angle in _ANGLES_OF_BODY)
    c, s = math.cos(about_z), math.sin(about_z)
    d, t = math.cos(about_x), math.sin(about_x)
    rotation = np.array([[c, -s * d, s * t], [s, c * d, -c * t], [0.0, t, d]])
    boxes = (OrientedBox.spanning(low, high) for low, high in (_ARM, _FOOT))
    rows = rotation.ravel().tolist()
    return tuple(OrientedBox((rotation @ box.centre).tolist(), box.half_extents, rows, name="body") for box in boxes)


def _walls(scene: dict[str, Any]) -> Iterator[OrientedBox]:
    for walls in scene["walls"]:
        bottom, top = scene["z"][walls["z"]]
        for at, *ends in walls["at"]:
            low, high = ((at, end) if walls["axis"] == 0 else (end, at) for end in ends)
            yield OrientedBox.spanning((*low, bottom), (*high, top), walls["name"])


def _slab(scene: dict[str, Any]) -> list[OrientedBox]:
    """Return the floor around its holes.  Too thin for the body to fit inside, it may as well be solid."""
    house, holes = scene["house"], scene["holes"]
    beside_the_holes = ((house["x"][0], holes["x"][0]), (holes["x"][1], house["x"][1]))
    edges = (house["y"][0], *(y for hole in holes["y"] for y in hole), house["y"][1])
    between_the_holes = zip(edges[::2], edges[1::2], strict=True)
    pieces = [*((x, house["y"]) for x in beside_the_holes), *((holes["x"], y) for y in between_the_holes)]
    bottom, top = scene["z"]["ground"][0], scene["z"]["floor"][0]
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
