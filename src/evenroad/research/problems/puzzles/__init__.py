"""Rigid bodies that have to find their way in space: Cubicles and Twistycool, built of boxes."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from evenroad.research.bench.task import Problem, ProblemSource
from evenroad.research.problems.puzzles.cubicles import cubicles
from evenroad.research.problems.puzzles.puzzle import Puzzle, problem_of
from evenroad.research.problems.puzzles.twistycool import twistycool


def _problem(make: Callable[[], Puzzle], set_dim: int, instance: int) -> Problem:
    return problem_of(make(), set_dim)


def _sources(name: str, make: Callable[[], Puzzle], about: str) -> tuple[ProblemSource, ProblemSource]:
    """Return the puzzle with sets that give the translation, as published, and with sets that give the turn, too."""
    return (
        ProblemSource(
            name,
            3,
            partial(_problem, make, 3),
            about=f"{about}; the sets give translations, turns are uniform",
        ),
        ProblemSource(
            f"{name}-6d",
            6,
            partial(_problem, make, 6),
            about=f"{about}; the sets give translations and turns",
        ),
    )


PUZZLES = (
    *_sources(
        "cubicles", cubicles, "an L-shaped body changes rooms through the basement (OMPL.app's, of boxes)"
    ),
    *_sources("twistycool", twistycool, "a hooked body goes through a window (OMPL.app's, of boxes)"),
)
