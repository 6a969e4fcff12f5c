"""Suite: the tasks of one benchmark, and what it cannot have."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from evenroad.bench.task import Task
from evenroad.errors import UnknownName


@dataclass(frozen=True)
class Absent:
    """A cell of a table that stays empty.

    Attributes
    ----------
    problem, sampler : str
    n : int
    reason : str
        One sentence, e.g. which n there are.
    """

    problem: str
    sampler: str
    n: int
    reason: str


@dataclass(frozen=True)
class Suite:
    """What to run.

    Attributes
    ----------
    name : str
        The label of its rows in a store.
    tasks : tuple of Task
        In an order that suits caches: what shares a problem, and then a set, stands together.
    absent : tuple of Absent
        Cells without a set.
    """

    name: str
    tasks: tuple[Task, ...]
    absent: tuple[Absent, ...] = ()


def chosen_names(only: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """Return those of the `known` problem names that `only` asks for, in the order of `known`; all if it is empty.

    Raises
    ------
    UnknownName
        If one of `only` is not known; the text lists those that are.
    """
    known, wanted = tuple(known), tuple(only)
    for name in wanted:
        if name not in known:
            raise UnknownName.among("problem of this suite", name, known)
    return tuple(name for name in known if not wanted or name in wanted)
