"""Sums of columns over groups of runs, and over the units (sets, instances) inside each group."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Ints = npt.NDArray[np.int64]


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
    """Return one code a row that is equal where all columns are, and ascends as they do from the first on."""
    code = np.zeros(len(columns[0]), dtype=np.int64)
    for column in columns:
        values, places = np.unique(column, return_inverse=True)
        # Numbered anew after each column: so the product never grows beyond rows squared.
        code = np.unique(code * len(values) + places, return_inverse=True)[1]
    return code


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
    _, first = np.unique(place, return_index=True)
    begins = np.searchsorted(group[first], np.arange(groups + 1))
    runs = np.bincount(place, minlength=len(first))
    # Whole numbers below 2^53, so a float sum is exact.
    sums = np.rint(np.bincount(place, weights=column, minlength=len(first))).astype(np.int64)
    return UnitSums(begins.astype(np.int64), unit[first], runs.astype(np.int64), sums)
