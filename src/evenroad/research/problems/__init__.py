"""Problems by name."""

from __future__ import annotations

from collections.abc import Iterable

from evenroad.errors import UnknownName
from evenroad.research.bench.task import ProblemSource
from evenroad.research.problems.chain import CHAINS
from evenroad.research.problems.corridors import CORRIDORS
from evenroad.research.problems.fair import FAIR
from evenroad.research.problems.mazes import MAZES
from evenroad.research.problems.puzzles import PUZZLES
from evenroad.research.problems.ur5 import UR5


def _by_name(*families: Iterable[ProblemSource]) -> dict[str, ProblemSource]:
    return {source.name: source for family in families for source in family}


PROBLEMS: dict[str, ProblemSource] = _by_name(MAZES, CORRIDORS, CHAINS, PUZZLES, UR5, FAIR)
"""Name -> where the problem comes from."""


def source_named(name: str) -> ProblemSource:
    """Return the problem source of this name.

    Raises
    ------
    UnknownName
        If there is none; the text lists them.
    """
    if name not in PROBLEMS:
        raise UnknownName.among("problem", name, PROBLEMS)
    return PROBLEMS[name]
