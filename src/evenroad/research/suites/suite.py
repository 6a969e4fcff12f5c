"""Suite: the tasks of one benchmark."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from evenroad.errors import UnknownName
from evenroad.research.bench.task import Task


@dataclass(frozen=True)
class Suite:
    """What to run.

    Attributes
    ----------
    name : str
        The label of its rows in a store.
    tasks : tuple of Task
        In an order that suits caches: what shares a problem, and then a set, stands together.
    """

    name: str
    tasks: tuple[Task, ...]


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
