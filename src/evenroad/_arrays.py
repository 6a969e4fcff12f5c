"""Names of array types, and conversion of the fields of frozen values."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Bools: TypeAlias = npt.NDArray[np.bool_]
Ints: TypeAlias = npt.NDArray[np.int64]
Ints32: TypeAlias = npt.NDArray[np.int32]
Array: TypeAlias = npt.NDArray[Any]
"""An array of numbers or texts of any kind."""


def set_fields(value: object, **fields: object) -> None:
    """Set fields of a frozen value while it is made; arrays become read-only."""
    for name, field in fields.items():
        if isinstance(field, np.ndarray):
            field.setflags(write=False)
        object.__setattr__(value, name, field)


def unique_rows(rows: Array) -> tuple[Array, Ints]:
    """Return the different rows of an array, (n, k), sorted, and the number of each one's equal among these, (n,).

    It is ``np.unique(rows, axis=0, return_inverse=True)`` in a quarter of the time: that compares rows one by one.
    """
    order = np.lexsort(rows.T[::-1])
    is_new = np.ones(len(order), dtype=np.bool_)
    is_new[1:] = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.cumsum(is_new) - 1
    return rows[order[is_new]], number
