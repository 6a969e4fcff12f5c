"""One instance of the fair suite, whatever its family."""

from __future__ import annotations

from evenroad.research.bench.task import Problem
from evenroad.research.problems.fair.cubes import cube_problem
from evenroad.research.problems.fair.mazes import maze_problem
from evenroad.research.problems.fair.rigid import rigid_problem
from evenroad.research.problems.fair.streams import Family, Stream


def make_instance(
    stream: Stream, family: Family, d: int, difficulty: int, size: float, instance: int
) -> Problem:
    """Return the problem of this number; the same arguments give the same one, in every process.

    Parameters
    ----------
    stream : Stream
        What it is for.
    family : Family
        Kind of world.
    d : int
        Dimension of the point sets: any with a number of obstacles for balls and boxes, 2 for mazes, 3 for SE(2) and
        6 for SE(3).
    difficulty : int
        Success of uniform points in % that `size` is meant to give; part of the seed.
    size : float
        Of the obstacles: radius, half extent; width of the doors in mazes.
    instance : int
        Number, >= 0.
    """
    if family in (Family.BALLS, Family.BOXES):
        return cube_problem(stream, family, d, difficulty, size, instance)
    if family is Family.MAZE:
        return maze_problem(stream, difficulty, size, instance)
    return rigid_problem(stream, family, difficulty, size, instance)
