"""Values that are rows of numbers to NumPy: a plan is its waypoints, a trajectory its positions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue


class Rows:
    """Base of values whose length, items and array are those of an attribute, `_rows`, which may be None."""

    _rows: Floats | None

    def __len__(self) -> int:
        return 0 if self._rows is None else len(self._rows)

    def __getitem__(self, index: Any) -> Any:
        return self._there()[index]

    def __iter__(self) -> Iterator[Floats]:
        return iter(self._there())

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        rows = self._there()
        return np.array(rows, dtype=dtype, copy=True) if copy else np.asarray(rows, dtype=dtype)

    def _there(self) -> Floats:
        if self._rows is None:
            raise InvalidValue(f"there is no path in {self!r}, and so no rows")
        return self._rows
