"""A path as CSV: one waypoint a row."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from evenroad._files import atomic_write


def save_path_csv(path: str | os.PathLike[str], waypoints: npt.ArrayLike, names: Sequence[str]) -> None:
    """Write waypoints, shape (p, dim), under a header of column names, atomically; floats round-trip."""
    rows = [
        ",".join(names),
        *(",".join(map(repr, row)) for row in np.asarray(waypoints, dtype=float).tolist()),
    ]
    with atomic_write(path) as file:
        file.write(("\n".join(rows) + "\n").encode())
