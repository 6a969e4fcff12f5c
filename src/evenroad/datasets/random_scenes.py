"""Random scenes, and where the tool goes in them: shelf, clutter, tight, boxes and cage."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene


class Region(NamedTuple):
    """A box for the tool's position: centre and half extents, (3,) each [m], turned about z by an angle."""

    centre: Floats
    half: Floats
    angle: float


def inside_of(positions: Floats, region: Region) -> Bools:
    """Return which positions, (n, 3), are in a region, (n,)."""
    cosine, sine = np.cos(region.angle), np.sin(region.angle)
    x, y, z = (positions - region.centre).T
    own = np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=1)
    inside: Bools = (np.abs(own) <= region.half).all(axis=1)
    return inside


Drawn = tuple[list[Obstacle], list[Region]]
"""Obstacles, and regions for the tool at start and goal; without regions it is anywhere."""


def _about_z(angle: float) -> Floats:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _boxes(centre: Floats, angle: float, parts: list[tuple[list[float], list[float]]]) -> list[Obstacle]:
    """Return boxes, each given by its position and full extents in a frame at `centre` turned about z."""
    turn = _about_z(angle)
    return [_box(size, centre + turn @ position, turn) for position, size in parts]


def _box(size: list[float] | Floats, position: Floats, turn: Floats) -> Obstacle:
    return Obstacle.of("", "box", tuple(map(float, size)), tuple(map(float, position)), tuple(turn.ravel().tolist()))


def _before(rng: np.random.Generator) -> Region:
    """Return a region above the table, anywhere around the robot, where arms wait."""
    angle = rng.uniform(-np.pi, np.pi)
    return Region(np.array([0.45 * np.cos(angle), 0.45 * np.sin(angle), 0.55]), np.full(3, 0.1), angle)


class Ranges(NamedTuple):
    """Ranges of uniform draws [m, rad]; of counts the upper end is excluded."""

    shelf_angle: tuple[float, float]
    shelf_away: tuple[float, float]
    shelf_width: tuple[float, float]
    shelf_height: tuple[float, float]
    shelf_columns: tuple[int, int]
    things: tuple[int, int]
    thing_height: tuple[float, float]
    window: tuple[float, float]
    wall_away: tuple[float, float]
    boxes: tuple[int, int]
    box_half: tuple[float, float]
    cage_width: tuple[float, float]
    cage_bars: tuple[int, int]


REPORT = Ranges(
    shelf_angle=(-1.2, 1.2),
    shelf_away=(0.58, 0.78),
    shelf_width=(0.30, 0.46),
    shelf_height=(0.26, 0.36),
    shelf_columns=(2, 4),
    things=(8, 16),
    thing_height=(0.1, 0.45),
    window=(0.20, 0.28),
    wall_away=(0.46, 0.62),
    boxes=(9, 19),
    box_half=(0.03, 0.18),
    cage_width=(0.46, 0.64),
    cage_bars=(1, 3),
)
"""Ranges of data sets and of published figures."""


def _shelf(ranges: Ranges, rng: np.random.Generator) -> Drawn:
    """Return a shelf of three rows, its open side towards the robot; the tool goes into compartments."""
    angle, away = rng.uniform(*ranges.shelf_angle), rng.uniform(*ranges.shelf_away)
    columns, board, depth = int(rng.integers(*ranges.shelf_columns)), 0.02, 0.3
    width, height = rng.uniform(*ranges.shelf_width), rng.uniform(*ranges.shelf_height)
    centre = np.array([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.02, 0.15)])
    pitch = width + board
    sides = pitch * (np.arange(columns + 1) - 0.5 * columns)
    parts = [([0.0, 0.0, row * height], [depth, columns * pitch + board, board]) for row in range(4)]
    parts += [([0.0, side, 1.5 * height], [depth, board, 3.0 * height]) for side in sides]
    turn = _about_z(angle)
    regions = [
        Region(
            centre + turn @ np.array([-0.03, side + 0.5 * pitch, (row + 0.5) * height]),
            np.array([0.08, 0.3 * width, 0.25 * height]),
            angle,
        )
        for side in sides[:-1]
        for row in range(3)
    ]
    return _boxes(centre, angle, parts), [*regions, _before(rng)]


def _clutter(ranges: Ranges, rng: np.random.Generator) -> Drawn:
    """Return a table with things on it; the tool goes low between them."""
    obstacles = []
    for _ in range(int(rng.integers(*ranges.things))):
        angle, away, tall = rng.uniform(-1.4, 1.4), rng.uniform(0.35, 0.8), rng.uniform(*ranges.thing_height)
        position = np.array([away * np.cos(angle), away * np.sin(angle), 0.5 * tall])
        if rng.random() < 0.5:
            size = (float(rng.uniform(0.03, 0.07)), float(tall))
            obstacles.append(Obstacle.of("", "cylinder", size, tuple(position.tolist())))
        else:
            size2 = [*rng.uniform(0.05, 0.15, 2), tall]
            obstacles.append(_box(size2, position, _about_z(rng.uniform(-np.pi, np.pi))))
    regions = []
    for _ in range(2):
        angle, away = rng.uniform(-1.2, 1.2), rng.uniform(0.4, 0.7)
        centre = np.array([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.1, 0.2)])
        regions.append(Region(centre, np.array([0.08, 0.08, 0.06]), angle))
    return obstacles, regions


def _wall(ranges: Ranges, rng: np.random.Generator) -> Drawn:
    """Return a wall with two windows, hardly larger than the hand; the tool goes through them."""
    angle, away, thick = rng.uniform(-0.8, 0.8), rng.uniform(*ranges.wall_away), 0.02
    centre = np.array([away * np.cos(angle), away * np.sin(angle), 0.0])
    tall, half = 0.9, 0.5
    windows = []
    for side in (-1.0, 1.0):
        wide, high = rng.uniform(*ranges.window, 2)
        windows.append((side * rng.uniform(0.18, 0.3), rng.uniform(0.25, 0.6), wide, high))
    # Upright strips beside the windows, and what is below and above each.
    edges = [-half, *(y + s * 0.5 * wide for y, _, wide, _ in windows for s in (-1, 1)), half]
    parts = []
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        parts.append(([0.0, 0.5 * (low + high), 0.5 * tall], [thick, high - low, tall]))
    for y, z, wide, high in windows:
        for bottom, top in ((0.0, z - 0.5 * high), (z + 0.5 * high, tall)):
            parts.append(([0.0, y, 0.5 * (bottom + top)], [thick, wide, top - bottom]))
    turn = _about_z(angle)
    regions = [
        Region(centre + turn @ np.array([0.09, y, z]), np.array([0.05, 0.3 * wide, 0.3 * high]), angle)
        for y, z, wide, high in windows
    ]
    return _boxes(centre, angle, parts), [*regions, _before(rng)]


def _random_boxes(ranges: Ranges, rng: np.random.Generator) -> Drawn:
    """Return boxes anywhere in reach, turned about z; start and goal are anywhere."""
    obstacles = []
    for _ in range(int(rng.integers(*ranges.boxes))):
        angle, away = rng.uniform(-np.pi, np.pi), rng.uniform(0.3, 1.0)
        position = np.array([away * np.cos(angle), away * np.sin(angle), rng.uniform(0.0, 1.0)])
        size = 2.0 * rng.uniform(*ranges.box_half, 3)
        obstacles.append(_box(size, position, _about_z(rng.uniform(-np.pi, np.pi))))
    return obstacles, []


def _cage(ranges: Ranges, rng: np.random.Generator) -> Drawn:
    """Return a cage of bars, one along every edge and some between; the tool goes in between bars."""
    angle, away, bar = rng.uniform(-0.8, 0.8), rng.uniform(0.5, 0.62), 0.015
    width, height = rng.uniform(*ranges.cage_width), rng.uniform(0.45, 0.6)
    between = int(rng.integers(*ranges.cage_bars))
    centre = np.array([away * np.cos(angle), away * np.sin(angle), 0.0])
    half = 0.5 * width
    parts = []
    for side in (-half, half):
        for u in np.linspace(-half, half, between + 2):
            parts.append(([side, u, 0.5 * height], [bar, bar, height]))
        for u in np.linspace(-half, half, between + 2)[1:-1]:
            parts.append(([u, side, 0.5 * height], [bar, bar, height]))
        for z in (0.5 * height, height):
            parts.append(([side, 0.0, z], [bar, width, bar]))
            parts.append(([0.0, side, z], [width, bar, bar]))
    inside = Region(centre + np.array([0.0, 0.0, 0.45 * height]), np.full(3, 0.12), angle)
    return _boxes(centre, angle, parts), [inside, _before(rng)]


GENERATORS: dict[str, Callable[[Ranges, np.random.Generator], Drawn]] = {
    "shelf": _shelf,
    "clutter": _clutter,
    "tight": _wall,
    "boxes": _random_boxes,
    "cage": _cage,
}
"""Name -> function that draws obstacles without names, and regions."""


def draw_scene(generator: str, rng: np.random.Generator, ranges: Ranges = REPORT) -> Drawn:
    """Return the obstacles and regions that a generator draws."""
    return GENERATORS[generator](ranges, rng)


def cell_of(robot: Robot) -> Scene:
    """Return the cell of all problems of the studies: the table that the robot stands on."""
    table = Obstacle.of("table", "box", (1.6, 1.6, 0.05), (0.3, 0.0, -0.03))
    bodied = [link for link in robot.links if any(capsule.link == link for capsule in robot.capsules)]
    return Scene((table,), name="table", allowed=frozenset((link, "table") for link in bodied[:2]))
