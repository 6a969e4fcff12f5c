"""Random mazes for a disk robot; the three that ship were drawn with them (``studies/tools/draw_mazes.py``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import set_fields
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.world import GridMap

Room = tuple[int, int]
"""Column and row."""


@dataclass(frozen=True)
class MazeDesign:
    """A rectangular maze: a random spanning tree of rooms, with doors in a share `loops` of the remaining walls.

    In pixels: the thickness of a `wall`, >= 2 and less than a room's, odd ones drawn one thinner; the width of a `door`
    between two rooms, at most the whole wall; `width` and `height` of the picture.
    """

    cols: int
    rows: int
    wall: int
    door: int
    loops: float
    width: int = 640
    height: int = 480

    def __post_init__(self) -> None:
        least = {"cols": 1, "rows": 1, "wall": 2, "door": 1, "width": 1, "height": 1}
        for name, at_least in least.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least)})
        if not 0.0 <= self.loops <= 1.0:
            raise InvalidValue(f"loops must be in [0, 1], got {self.loops!r}")
        room = min(self.width // self.cols, self.height // self.rows)
        if self.wall >= room:
            raise InvalidValue(f"wall must be thinner than a room of {room} pixels, got {self.wall!r}")


@dataclass(frozen=True, eq=False)
class DrawnMaze:
    """A random maze, with the centres of two opposite rooms, in pixels: x right, y down."""

    map: GridMap
    start: tuple[float, float]
    goal: tuple[float, float]


def draw_maze(design: MazeDesign, *, rng: RngLike = 0) -> DrawnMaze:
    """Draw a maze in which a disk that fits the doors can reach every room; a passed Generator is spawned."""
    random = generator(rng)
    xs = np.linspace(0, design.width, design.cols + 1).round().astype(int)
    ys = np.linspace(0, design.height, design.rows + 1).round().astype(int)
    wall = np.zeros((design.height, design.width), dtype=np.bool_)
    half = design.wall // 2
    for x in xs:
        wall[:, max(0, x - half) : x + half] = True
    for y in ys:
        wall[max(0, y - half) : y + half, :] = True
    for (col, row), (other_col, other_row) in _doors(design, random):
        # A door is a gap somewhere along the shared wall, not always in the middle.
        if row == other_row:
            x, low, high = xs[max(col, other_col)], ys[row] + half, ys[row + 1] - half
            at = _door_start(low, high, design.door, random)
            wall[at : at + min(design.door, high - low), x - half : x + half] = False
        else:
            y, low, high = ys[max(row, other_row)], xs[col] + half, xs[col + 1] - half
            at = _door_start(low, high, design.door, random)
            wall[y - half : y + half, at : at + min(design.door, high - low)] = False
    start, goal = ((float(xs[i] + xs[i + 1]) / 2, float(ys[i] + ys[i + 1]) / 2) for i in (0, -2))
    return DrawnMaze(GridMap(wall), start, goal)


def _door_start(low: int, high: int, door: int, random: np.random.Generator) -> int:
    return int(random.integers(low, max(low, high - door) + 1))


def _doors(design: MazeDesign, random: np.random.Generator) -> list[tuple[Room, Room]]:
    """Return the pairs of rooms that are joined: a depth-first spanning tree, and some loops."""
    doors = list(_spanning_tree(design, random))
    joined = {frozenset(pair) for pair in doors}
    for col in range(design.cols):
        for row in range(design.rows):
            for other in ((col + 1, row), (col, row + 1)):
                inside = other[0] < design.cols and other[1] < design.rows
                if inside and frozenset(((col, row), other)) not in joined and random.random() < design.loops:
                    doors.append(((col, row), other))
    return doors


def _spanning_tree(design: MazeDesign, random: np.random.Generator) -> Iterator[tuple[Room, Room]]:
    stack: list[Room] = [(0, 0)]
    seen = {(0, 0)}
    while stack:
        room = stack[-1]
        fresh = [other for other in _neighbours(room, design) if other not in seen]
        if not fresh:
            stack.pop()
            continue
        other = fresh[random.integers(len(fresh))]
        yield room, other
        seen.add(other)
        stack.append(other)


def _neighbours(room: Room, design: MazeDesign) -> list[Room]:
    col, row = room
    around = ((col + 1, row), (col - 1, row), (col, row + 1), (col, row - 1))
    return [(x, y) for x, y in around if 0 <= x < design.cols and 0 <= y < design.rows]
