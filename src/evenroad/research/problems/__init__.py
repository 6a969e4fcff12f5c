"""Problems by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

from evenroad._checks import require_known
from evenroad.research.bench.task import Problem, ProblemSource
from evenroad.research.problems.cubicles import cubicles
from evenroad.research.problems.fair import FAIR
from evenroad.research.problems.paper import CHAINS, CORRIDORS, MAZES, UR5
from evenroad.research.problems.puzzles import Puzzle, problem_of, twistycool


def _problem(make: Callable[[], Puzzle], set_dim: int, instance: int) -> Problem:
    return problem_of(make(), set_dim)


def _sources(name: str, make: Callable[[], Puzzle], about: str) -> tuple[ProblemSource, ProblemSource]:
    """Return the puzzle with sets that give the translation, as published, and with sets that give the rotation too."""
    return (
        ProblemSource(
            name,
            3,
            partial(_problem, make, 3),
            about=f"{about}; the sets give translations, rotations are uniform",
        ),
        ProblemSource(
            f"{name}-6d",
            6,
            partial(_problem, make, 6),
            about=f"{about}; the sets give translations and rotations",
        ),
    )


PUZZLES = (
    *_sources(
        "cubicles", cubicles, "an L-shaped body changes rooms through the basement (OMPL.app's, of boxes)"
    ),
    *_sources("twistycool", twistycool, "a hooked body goes through a window (OMPL.app's, of boxes)"),
)


def _by_name(*families: Iterable[ProblemSource]) -> dict[str, ProblemSource]:
    return {source.name: source for family in families for source in family}


PROBLEMS: dict[str, ProblemSource] = _by_name(MAZES, CORRIDORS, CHAINS, PUZZLES, UR5, FAIR)
"""Name -> where the problem comes from."""


def source_named(name: str) -> ProblemSource:
    """Return the problem source of this name; UnknownName, with the known ones, if there is none."""
    require_known("problem", name, PROBLEMS)
    return PROBLEMS[name]
