"""Runs: the columns that a report is made of, in the order of its tables, and sums over groups of them."""

from __future__ import annotations

import re
from dataclasses import dataclass, fields, replace

import numpy as np
import numpy.typing as npt

from evenroad.research.bench.rows import Labels, Rows
from evenroad.research.bench.samplers import SAMPLERS


@dataclass(frozen=True, order=True)
class Question:
    """What one success table is about: a problem asked with one rule and one search."""

    problem: str
    rule: str
    search: str

    def __str__(self) -> str:
        """``maze-3, k=10 symmetrised, connect``."""
        return f"{self.problem}, {self.rule}, {self.search}"


@dataclass(frozen=True)
class Runs:
    """One entry a run in every array, all of one length.

    Attributes
    ----------
    questions, samplers, sets : tuple
        What the codes in `question`, `sampler` and `set` stand for; set 0 is "drawn afresh".
    solved, failed : ndarray of bool
        A path; no answer at all (exception, time limit, dead worker).
    valid, early : ndarray of float64
        Valid milestones among all points; those that had been added when there was a path (the same where the
        search does not stop early or there was none).
    """

    questions: tuple[Question, ...]
    samplers: tuple[str, ...]
    sets: tuple[str, ...]
    question: npt.NDArray[np.int64]
    sampler: npt.NDArray[np.int64]
    set: npt.NDArray[np.int64]
    n: npt.NDArray[np.int64]
    instance: npt.NDArray[np.int64]
    run: npt.NDArray[np.int64]
    seed: npt.NDArray[np.int64]
    solved: npt.NDArray[np.bool_]
    failed: npt.NDArray[np.bool_]
    valid: npt.NDArray[np.float64]
    early: npt.NDArray[np.float64]
    edges_checked: npt.NDArray[np.float64]
    seconds: npt.NDArray[np.float64]

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.n)

    def where(self, chosen: npt.NDArray[np.bool_] | npt.NDArray[np.int64]) -> Runs:
        """Return the runs that a mask or row numbers choose, in that order."""
        columns = {
            field.name: getattr(self, field.name)[chosen]
            for field in fields(self)
            if isinstance(getattr(self, field.name), np.ndarray)
        }
        return replace(self, **columns)


def runs_of(rows: Rows) -> Runs:
    """Return the runs of a store: questions in alphabetical order, samplers in that of tables."""
    samplers, sampler = _recoded(rows.sampler, sorted(rows.sampler.present(), key=sampler_place))
    sets, set_code = _recoded(rows.set_id, ["", *(name for name in rows.set_id.present() if name)])
    questions, question = _questions(rows)
    valid = rows.valid.astype(np.float64)
    return Runs(
        questions=questions,
        samplers=samplers,
        sets=sets,
        question=question,
        sampler=sampler,
        set=set_code,
        n=rows.n,
        instance=rows.instance,
        run=rows.run,
        seed=rows.seed,
        solved=rows.solved,
        failed=~rows.answered,
        valid=valid,
        early=np.where(rows.valid_at_solution >= 0, rows.valid_at_solution, valid),
        edges_checked=rows.edges_checked.astype(np.float64),
        seconds=rows.seconds,
    )


def _recoded(labels: Labels, names: list[str]) -> tuple[tuple[str, ...], npt.NDArray[np.int64]]:
    """Return the names in this order, and every row's place among them."""
    place = {name: number for number, name in enumerate(names)}
    new_codes = np.array([place.get(name, -1) for name in labels.names], dtype=np.int64)
    return tuple(names), new_codes[labels.codes]


def _questions(rows: Rows) -> tuple[tuple[Question, ...], npt.NDArray[np.int64]]:
    columns = (rows.problem, rows.rule, rows.search)
    code = np.zeros(len(rows), dtype=np.int64)
    for column in columns:
        code = code * len(column.names) + column.codes
    _, first, place = np.unique(code, return_index=True, return_inverse=True)
    found = [Question(*(column[int(row)] for column in columns)) for row in first]
    order = sorted(range(len(found)), key=lambda number: _natural(found[number]))
    rank = np.empty(len(found), dtype=np.int64)
    rank[order] = np.arange(len(found))
    return tuple(found[number] for number in order), rank[place]


def _natural(question: Question) -> list[list[tuple[int, int, str]]]:
    """Sort ``k=4`` before ``k=10``."""
    return [natural_key(text) for text in (question.problem, question.rule, question.search)]


def sampler_place(sampler: str) -> tuple[int, str]:
    """Return what to sort samplers by: the order of :data:`SAMPLERS`, then the name."""
    known = list(SAMPLERS)
    return (known.index(sampler) if sampler in known else len(known)), sampler


def natural_key(text: str) -> list[tuple[int, int, str]]:
    """Return what to sort texts by so that numbers inside them count as numbers: ``5d`` before ``10d``."""
    parts = filter(None, re.split(r"(\d+)", text))
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in parts]


Ints = npt.NDArray[np.int64]

TABLE_LIMIT = 2**25
"""Largest code that a table is made for, of 128 MiB."""
WIDE = 2**31
"""Span of a column from which on its values are numbered first."""


@dataclass(frozen=True)
class UnitSums:
    """Sums per (group, unit), sorted by group and then unit.

    Attributes
    ----------
    begins : ndarray, shape (groups + 1,)
        Group g has the entries ``begins[g]`` up to ``begins[g + 1]``.
    unit : ndarray, shape (entries,)
    runs : ndarray, shape (entries,)
        Rows of each.
    sums : ndarray, shape (entries,)
        Sum of the column.
    """

    begins: Ints
    unit: Ints
    runs: Ints
    sums: Ints

    def of(self, group: int) -> slice:
        """Return where a group's entries are."""
        return slice(int(self.begins[group]), int(self.begins[group + 1]))


def combined(*columns: Ints) -> Ints:
    """Return one code a row, equal where all columns are; codes have no gaps and ascend as the columns do."""
    code = np.zeros(len(columns[0]), dtype=np.int64)
    for column in columns:
        if len(column):
            offset = column - int(column.min())
            if int(offset.max()) >= WIDE:
                # Seeds may be any number: products of those would overflow.
                offset = np.unique(offset, return_inverse=True)[1]
            # Without gaps after each column, so the product stays below rows times span.
            code = _without_gaps(code * (int(offset.max()) + 1) + offset)
    return code


def first_rows(code: Ints) -> Ints:
    """Return the first row of every code, codes being without gaps."""
    first = np.zeros(int(code.max()) + 1 if len(code) else 0, dtype=np.int64)
    # Written from the end on: what is left is the earliest.
    first[code[::-1]] = np.arange(len(code) - 1, -1, -1)
    return first


def _without_gaps(code: Ints) -> Ints:
    """Return codes >= 0 numbered anew from 0, in the same order."""
    span = int(code.max()) + 1
    if span > TABLE_LIMIT:
        return np.unique(code, return_inverse=True)[1]
    # A table of what occurs: a fraction of the time that sorting a million rows takes.
    occurs = np.zeros(span, dtype=np.int32)
    occurs[code] = 1
    return (np.cumsum(occurs, dtype=np.int32)[code] - 1).astype(np.int64)


def sums_by_unit(group: Ints, groups: int, unit: Ints, column: Ints) -> UnitSums:
    """Return the sums of a column over the units of each group.

    Parameters
    ----------
    group : ndarray of int, shape (rows,)
        In [0, groups).
    groups : int
        Groups may be empty.
    unit, column : ndarray of int, shape (rows,)
        Units may have any numbers.
    """
    place = combined(group, unit)
    first = first_rows(place)
    begins = np.searchsorted(group[first], np.arange(groups + 1))
    runs = np.bincount(place, minlength=len(first))
    # Whole numbers below 2^53, so a float sum is exact.
    sums = np.rint(np.bincount(place, weights=column, minlength=len(first))).astype(np.int64)
    return UnitSums(begins.astype(np.int64), unit[first], runs.astype(np.int64), sums)
