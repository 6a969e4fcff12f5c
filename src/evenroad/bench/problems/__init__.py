"""Problems by name."""

from __future__ import annotations

from collections.abc import Iterable

from evenroad.bench.problem import ProblemSource
from evenroad.bench.problems.chain import CHAINS
from evenroad.bench.problems.corridors import CORRIDORS
from evenroad.bench.problems.fair import FAIR
from evenroad.bench.problems.mazes import MAZES
from evenroad.bench.problems.puzzles import PUZZLES
from evenroad.bench.problems.ur5 import UR5
from evenroad.errors import UnknownName


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
