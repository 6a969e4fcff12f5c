"""Problems by name."""

from __future__ import annotations

from functools import partial

from evenroad._checks import require_known
from evenroad_studies.arms.problems import ARM_PROBLEMS
from evenroad_studies.bench.task import ProblemSource
from evenroad_studies.problems.apart import APART
from evenroad_studies.problems.fair import FAIR
from evenroad_studies.problems.paper import CHAINS, CORRIDORS, MAZES, UR5
from evenroad_studies.problems.puzzles import cubicles, problem_of, twistycool

PUZZLES = tuple(
    ProblemSource(f"{name}{end}", set_dim, partial(problem_of, make, set_dim), about=f"{about}; the sets give {given}")
    for name, make, about in (
        ("cubicles", cubicles, "an L-shaped body changes rooms through the basement (OMPL.app's, of boxes)"),
        ("twistycool", twistycool, "a hooked body goes through a window (OMPL.app's, of boxes)"),
    )
    for end, set_dim, given in (
        ("", 3, "translations, rotations are uniform"),
        ("-6d", 6, "translations and rotations"),
    )
)
"""With sets that give the translation, as published, and with sets that give the rotation, too."""

PROBLEMS = {
    source.name: source for source in (*MAZES, *CORRIDORS, *CHAINS, *PUZZLES, *UR5, *FAIR, *APART, *ARM_PROBLEMS)
}
"""Name -> where the problem comes from."""


def source_named(name: str) -> ProblemSource:
    """Return the problem source of this name; UnknownName, with the known ones, if there is none."""
    require_known("problem", name, PROBLEMS)
    return PROBLEMS[name]
