"""The three shipped mazes: 640 x 480 pixels, a disk of radius 6."""

from __future__ import annotations

from functools import partial

import numpy as np

from evenroad.research.bench.task import Problem, ProblemSource
from evenroad.research.mazes import LEVELS, load_maze


def _maze(level: int, instance: int) -> Problem:
    maze = load_maze(level)
    return Problem(maze.world(), np.array(maze.start), np.array(maze.goal), set_dim=2)


MAZES = tuple(
    ProblemSource(
        f"maze-{level}", 2, partial(_maze, level), about=f"2-D maze, level {level}, disk of radius 6"
    )
    for level in LEVELS
)
