"""Checks of counts, shared by the statistics."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue


def as_counts(name: str, values: Any) -> npt.NDArray[np.int64]:
    """Return `values` as int64, or raise InvalidValue unless all are whole numbers >= 0."""
    array = np.asarray(values)
    if array.dtype.kind not in "iub" and not (array.dtype.kind == "f" and np.all(array == np.trunc(array))):
        raise InvalidValue(f"{name} must be whole numbers, got {values!r}")
    if np.any(array < 0):
        raise InvalidValue(f"{name} must be >= 0, got {values!r}")
    return array.astype(np.int64)


def as_successes(solved: Any, runs: Any) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return both as int64, or raise InvalidValue unless 0 <= solved <= runs and runs >= 1 everywhere."""
    successes, trials = as_counts("solved", solved), as_counts("runs", runs)
    if np.any(trials < 1):
        raise InvalidValue(f"runs must be >= 1, got {runs!r}")
    if np.any(successes > trials):
        raise InvalidValue(f"solved must be at most runs, got {solved!r} of {runs!r}")
    return successes, trials


def require_share(name: str, value: float) -> float:
    """Return a share strictly between 0 and 1, or raise InvalidValue."""
    if not 0.0 < value < 1.0:
        raise InvalidValue(f"{name} must be between 0 and 1, both excluded, got {value!r}")
    return float(value)
