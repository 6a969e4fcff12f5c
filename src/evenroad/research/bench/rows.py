"""Rows: the finished tasks of a store as columns, ready for statistics."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import numpy.typing as npt

FAILURES = ("failed", "lost", "timeout")
"""Statuses that are failures of a run, not answers."""


@dataclass(frozen=True, eq=False)
class Labels:
    """A column of texts.

    Attributes
    ----------
    codes : ndarray of int32, shape (rows,)
        Place of each row's text in `names`; read-only.
    names : tuple of str
        The different texts, in alphabetical order; some may not occur after a selection.
    """

    codes: npt.NDArray[np.int32]
    names: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.codes)

    def __getitem__(self, row: int) -> str:
        return self.names[self.codes[row]]

    def values(self) -> npt.NDArray[np.object_]:
        """Return the texts, one a row."""
        return np.array(self.names, dtype=object)[self.codes]

    def is_in(self, names: Iterable[str]) -> npt.NDArray[np.bool_]:
        """Return which rows have one of these texts; those that no row has are passed over."""
        wanted = set(names)
        return np.array([name in wanted for name in self.names], dtype=np.bool_)[self.codes]

    def present(self) -> tuple[str, ...]:
        """Return the texts that occur, in alphabetical order."""
        return tuple(self.names[code] for code in np.unique(self.codes))


@dataclass(frozen=True, eq=False)
class Rows:
    """Columns of equal length, one row a task, in the order of the task's fields; never in that of arrival.

    The fields are those of `Task` and `Outcome`, and:

    Attributes
    ----------
    suite : Labels
        Which suite asked first.
    worker : Labels
        Host and process that ran it.
    instance, n, run, seed, valid, edges_checked : ndarray of int64
    valid_at_solution : ndarray of int64
        -1 where there is none.
    length, seconds : ndarray of float64
        NaN where there is none.
    """

    suite: Labels
    problem: Labels
    instance: npt.NDArray[np.int64]
    sampler: Labels
    n: npt.NDArray[np.int64]
    rule: Labels
    search: Labels
    run: npt.NDArray[np.int64]
    seed: npt.NDArray[np.int64]
    status: Labels
    valid: npt.NDArray[np.int64]
    valid_at_solution: npt.NDArray[np.int64]
    edges_checked: npt.NDArray[np.int64]
    length: npt.NDArray[np.float64]
    seconds: npt.NDArray[np.float64]
    set_id: Labels
    error: Labels
    worker: Labels

    def __len__(self) -> int:
        return len(self.n)

    @property
    def solved(self) -> npt.NDArray[np.bool_]:
        """Which rows have a path."""
        return self.status.is_in(["solved"])

    @property
    def answered(self) -> npt.NDArray[np.bool_]:
        """Which rows are answers, a path or none, and not failures of the run."""
        return ~self.status.is_in(FAILURES)

    def where(self, chosen: npt.NDArray[np.bool_] | npt.NDArray[np.integer]) -> Rows:
        """Return the rows that a mask or row numbers choose, in that order."""
        selected: dict[str, Any] = {}
        for field in fields(self):
            column = getattr(self, field.name)
            if isinstance(column, Labels):
                selected[field.name] = replace(column, codes=column.codes[chosen])
                selected[field.name].codes.setflags(write=False)
            else:
                selected[field.name] = column[chosen]
                selected[field.name].setflags(write=False)
        return Rows(**selected)


def rows_from(columns: dict[str, npt.NDArray[np.generic]], texts: dict[int, str]) -> Rows:
    """Return rows sorted by the fields of the task.

    Parameters
    ----------
    columns : dict of str to ndarray
        Every field of :class:`Rows`; texts as numbers.
    texts : dict of int to str
        What the numbers stand for.
    """
    in_order: dict[str, Any] = {}
    for field in fields(Rows):
        column = columns[field.name]
        in_order[field.name] = _labels(column, texts) if field.type == "Labels" else column
    of_task = ("problem", "instance", "sampler", "n", "rule", "search", "run", "seed")
    keys = [getattr(in_order[name], "codes", in_order[name]) for name in of_task]
    return Rows(**in_order).where(np.lexsort(keys[::-1]))


def _labels(numbers: npt.NDArray[np.generic], texts: dict[int, str]) -> Labels:
    present, place = np.unique(numbers, return_inverse=True)
    names = [texts[number] for number in present.tolist()]
    order = sorted(range(len(names)), key=names.__getitem__)
    rank = np.empty(len(names), dtype=np.int32)
    rank[order] = np.arange(len(names))
    return Labels(rank[place], tuple(names[i] for i in order))
