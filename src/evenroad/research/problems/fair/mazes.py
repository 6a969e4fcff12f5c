"""Random mazes like the shipped ones, for a disk: a family that no default was chosen with."""

from __future__ import annotations

from functools import partial

import numpy as np
import numpy.typing as npt

from evenroad.research.bench.task import Problem
from evenroad.research.mazes import MazeDesign, draw_maze
from evenroad.research.problems.fair.query import draw_query
from evenroad.research.problems.fair.streams import Family, Stream, instance_rng
from evenroad.world import World

ROBOT_RADIUS = 6.0
"""In pixels, as in the shipped mazes."""


def maze_problem(stream: Stream, difficulty: int, door: float, instance: int) -> Problem:
    """Return one maze of 640 x 480 pixels with doors of `door` pixels, and start and goal 320 pixels apart or more."""
    rng = instance_rng(stream, Family.MAZE, 2, difficulty, instance)
    world, start, goal = draw_query(partial(draw_disk_world, door), far_in_map, rng)
    return Problem(world, start, goal, set_dim=2)


def draw_disk_world(door: float, rng: np.random.Generator) -> World:
    """Return a maze of 8 x 6 rooms, a tenth of whose other walls have doors too."""
    design = MazeDesign(cols=8, rows=6, wall=8, door=round(door), loops=0.1)
    return draw_maze(design, rng=rng).map.world(ROBOT_RADIUS)


def far_in_map(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
    """Return which rows of the unit square are half the map's width, 320 pixels, apart in the map: (m,)."""
    return np.asarray(np.hypot(640.0 * (b[:, 0] - a[:, 0]), 480.0 * (b[:, 1] - a[:, 1])) >= 320.0)
