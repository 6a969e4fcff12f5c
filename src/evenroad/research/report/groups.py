"""Sums of columns over groups of runs, and over the units (sets, instances) inside each group."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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
