"""Sets of the smallest exact star discrepancy known to us: one per number of points, in two and three dimensions.

``star/d02.npy`` in the studies holds the sets of 1, 2, ... points one after the other, float32, and ``star/d02.csv``
their exact values, who found them, and their hashes.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad._npz import read_array, reading
from evenroad._rng import RngLike
from evenroad.errors import BrokenFile, NotAvailable
from evenroad.points.bank.bank import large_file
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry

DIMENSIONS, LARGEST = (2, 3), 512
"""Dimensions of the sets, and their largest number of points."""

METHODS = {2: "orders placed exactly", 3: "annealed and relaxed"}


@dataclass(frozen=True)
class Record:
    """Record of a set: its exact star discrepancy, who found it, and the hash of its points."""

    value: float
    found: str
    hash: str


@dataclass(frozen=True)
class Star:
    """The set of n points of smallest exact star discrepancy known to us, n <= 512, d = 2 or 3; always the same set.

    It is good for integrals.  For roadmaps use :class:`~evenroad.points.samplers.Even`: separated points plan better.
    """

    name = "star"
    about = "least star discrepancy known to us, n <= 512, d = 2 and 3; always the same set"
    any_n = False
    symmetries = frozenset({Symmetry.PERMUTATION})

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return n points, (n, d); `rng` is not used.  NotAvailable where there is no set, or without the studies."""
        n, d = require_count("n", n), require_count("d", d)
        if d not in DIMENSIONS or n > LARGEST:
            raise NotAvailable(f"star has sets of n = 1 .. {LARGEST} points in d = 2 and 3, not of n={n} in d={d}")
        first = n * (n - 1) // 2
        points = PointSet(_sets(d)[first : first + n].astype(np.float64), Origin(family=self.name, method=METHODS[d]))
        if n not in records(d) or points.hash != records(d)[n].hash:
            raise BrokenFile(f"{_path(d, 'npy')}: the set of {n} points does not match its hash")
        return points


def records(d: int) -> Mapping[int, Record]:
    """Return the record of the set of each n, d = 2 or 3."""
    return _records(_path(d, "csv"))


def _path(d: int, suffix: str) -> Path:
    return large_file(Star.name, f"d{d:02d}.{suffix}")


@lru_cache(maxsize=2)
def _records(path: Path) -> Mapping[int, Record]:
    with reading(path, "table of star discrepancies"), path.open(newline="", encoding="utf-8") as file:
        return {int(row["n"]): Record(float(row["star"]), row["found"], row["hash"]) for row in csv.DictReader(file)}


@lru_cache(maxsize=2)
def _sets(d: int) -> npt.NDArray[np.float32]:
    path = _path(d, "npy")
    with reading(path, "array of star sets"), path.open("rb") as file:
        sets = read_array(file, path.stat().st_size)
    if sets.dtype != np.float32 or sets.shape != (LARGEST * (LARGEST + 1) // 2, d):
        raise BrokenFile(f"{path} is not a float32 array of the sets of 1 .. {LARGEST} points in d={d}")
    sets.setflags(write=False)
    return sets
