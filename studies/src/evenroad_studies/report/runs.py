"""Runs: the columns that a report is made of, in the order of its tables, and sums over groups of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints
from evenroad_studies.bench.rows import Labels, Rows
from evenroad_studies.bench.samplers import SAMPLERS

TABLE_LIMIT = 2**25
"""Codes are numbered anew with a table of this length at most (128 MiB), beyond it by sorting."""
WIDE = 2**31
"""A column whose values span so much has its values numbered before they are multiplied."""


class Setting(NamedTuple):
    """What one success table is about: a problem, a connection rule and a search."""

    problem: str
    rule: str
    search: str

    def __str__(self) -> str:
        """``maze-3, k=10 symmetrised, connect``."""
        return ", ".join(self)


@dataclass(frozen=True)
class Runs:
    """The runs of a store, as arrays of one length: an entry is a run.

    `settings`, `samplers` and `sets` are what the codes in `setting`, `sampler` and `set` stand for; code 0 of a set is
    "drawn afresh".  `failed` runs gave no answer.  `valid` counts valid milestones among all points, `early` among
    those that were added until there was a path: all where there is none, or the search does not stop early.
    """

    settings: tuple[Setting, ...]
    samplers: tuple[str, ...]
    sets: tuple[str, ...]
    setting: Ints
    sampler: Ints
    set: Ints
    n: Ints
    instance: Ints
    run: Ints
    seed: Ints
    solved: Bools
    failed: Bools
    valid: Floats
    early: Floats
    edges_checked: Floats
    seconds: Floats

    def __len__(self) -> int:
        return len(self.n)

    def where(self, chosen: Bools | Ints) -> Runs:
        """Return the runs that a mask or row numbers choose, in that order."""
        arrays: dict[str, Any] = {
            name: column[chosen] for name, column in vars(self).items() if isinstance(column, np.ndarray)
        }
        return replace(self, **arrays)

    def by_setting(self, property_of: Callable[[Setting], Any]) -> npt.NDArray[Any]:
        """Return a property of every run's setting, shape (rows,)."""
        return np.array([property_of(setting) for setting in self.settings])[self.setting]

    def setting_codes(self, property_of: Callable[[Setting], Any]) -> Ints:
        """Return a code for every run, in the order of a property of its setting."""
        values = sorted({property_of(setting) for setting in self.settings})
        return self.by_setting(lambda setting: values.index(property_of(setting)))


def runs_of(rows: Rows) -> Runs:
    """Return the runs of a store, with settings and samplers in the order of the tables."""
    samplers, sampler = _recoded(rows.sampler, sorted(rows.sampler.present(), key=sampler_place))
    sets, set_code = _recoded(rows.set_id, ["", *filter(None, rows.set_id.present())])
    settings, setting = _settings(rows)
    valid = rows.valid.astype(np.float64)
    return Runs(
        settings=settings,
        samplers=samplers,
        sets=sets,
        setting=setting,
        sampler=sampler,
        set=set_code,
        **{name: getattr(rows, name) for name in ("n", "instance", "run", "seed", "solved", "seconds")},
        failed=~rows.answered,
        valid=valid,
        early=np.where(rows.valid_at_solution >= 0, rows.valid_at_solution, valid),
        edges_checked=rows.edges_checked.astype(np.float64),
    )


def _recoded(labels: Labels, names: list[str]) -> tuple[tuple[str, ...], Ints]:
    """Return the names in this order, and every row's place among them."""
    place = {name: number for number, name in enumerate(names)}
    new_codes = np.array([place.get(name, -1) for name in labels.names], dtype=np.int64)
    return tuple(names), new_codes[labels.codes]


def _settings(rows: Rows) -> tuple[tuple[Setting, ...], Ints]:
    """Return the settings, sorted so that ``k=4`` comes before ``k=10``, and every row's place among them."""
    columns = (rows.problem, rows.rule, rows.search)
    code = combined(*(column.codes.astype(np.int64) for column in columns))
    found = [Setting(*(column[int(row)] for column in columns)) for row in first_rows(code)]
    order = sorted(range(len(found)), key=lambda place: [natural_key(name) for name in found[place]])
    rank = np.empty(len(found), dtype=np.int64)
    rank[order] = np.arange(len(found))
    return tuple(found[place] for place in order), rank[code]


def sampler_place(sampler: str) -> tuple[int, str]:
    """Return the sort key of a sampler: its place in :data:`SAMPLERS`, then its name."""
    known = list(SAMPLERS)
    return (known.index(sampler) if sampler in known else len(known)), sampler


def natural_key(text: str) -> list[tuple[int, int, str]]:
    """Return a sort key by which numbers inside texts count as numbers: ``5d`` comes before ``10d``."""
    parts = filter(None, re.split(r"(\d+)", text))
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in parts]


def combined(*columns: Ints) -> Ints:
    """Return a code for every row; two rows have the same code if they agree in all columns.

    The codes are 0, 1, ... without gaps, in the order of the columns' values.
    """
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


def _without_gaps(code: Ints) -> Ints:
    """Return codes >= 0 numbered anew from 0, in the same order."""
    span = int(code.max()) + 1
    if span > TABLE_LIMIT:
        return np.unique(code, return_inverse=True)[1]
    # A table of the codes that occur takes a fraction of the time of sorting a million rows.
    occurs = np.zeros(span, dtype=np.int32)
    occurs[code] = 1
    return (np.cumsum(occurs, dtype=np.int32)[code] - 1).astype(np.int64)


def first_rows(code: Ints) -> Ints:
    """Return the first row of every code; codes have no gaps."""
    first = np.zeros(int(code.max()) + 1 if len(code) else 0, dtype=np.int64)
    # Written from the end on: what is left is the earliest.
    first[code[::-1]] = np.arange(len(code) - 1, -1, -1)
    return first


class UnitSums(NamedTuple):
    """The units of a group, in order, each with its number of runs and a sum over these; all (units,)."""

    unit: Ints
    runs: Ints
    sums: Ints


def sums_by_unit(group: Ints, groups: int, unit: Ints, column: Ints | Bools) -> list[UnitSums]:
    """Return the sums of a column over the units of each group; groups are in [0, groups), units any numbers."""
    place = combined(group, unit)
    first = first_rows(place)
    runs = np.bincount(place, minlength=len(first))
    # Whole numbers below 2^53, so a float sum is exact.
    sums = np.rint(np.bincount(place, weights=column, minlength=len(first))).astype(np.int64)
    begins = np.searchsorted(group[first], np.arange(1, groups))
    parts = (np.split(each, begins) for each in (unit[first], runs, sums))
    return [UnitSums(*each) for each in zip(*parts, strict=True)]
