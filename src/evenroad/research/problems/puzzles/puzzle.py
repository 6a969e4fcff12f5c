"""Puzzle: a rigid body, its obstacles, and where it shall go."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad.research.bench.task import Problem
from evenroad.space import SE3
from evenroad.world.solids import OrientedBox, SolidWorld

Triple = tuple[float, float, float]

_SHARE = 0.01
"""Resolution of motions, as a share of the extents of the translations and of the rotations: OMPL's default."""

_NOT_TURNED = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Puzzle:
    """A rigid body among boxes in space; it starts and ends not turned.

    Attributes
    ----------
    low, high : tuple of 3 floats
        Bounds of the translation.
    start, goal : tuple of 3 floats
        Translations.
    body, obstacles : tuple of OrientedBox
        As :class:`SolidWorld` takes them.
    """

    low: Triple
    high: Triple
    start: Triple
    goal: Triple
    body: tuple[OrientedBox, ...]
    obstacles: tuple[OrientedBox, ...]


def problem_of(puzzle: Puzzle, set_dim: int) -> Problem:
    """Return the puzzle by OMPL's rules: distance ``|dt| + arccos |q . q'|``, a hundredth of both extents as steps."""
    resolution = (_SHARE * math.dist(puzzle.low, puzzle.high), _SHARE * math.pi / 2.0)
    world = SolidWorld(SE3(puzzle.low, puzzle.high), puzzle.body, puzzle.obstacles, resolution)
    start, goal = (np.array([*place, *_NOT_TURNED]) for place in (puzzle.start, puzzle.goal))
    return Problem(world, start, goal, set_dim)
