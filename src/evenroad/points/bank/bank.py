"""Reading the bank: one folder per family, one float32 array (sets, n, d) per cell, one index for all.

::

    data/index.json                    {"hickernell": {"2": {"512": {cell record}}}}
    data/hickernell/d02-n0512.npy

The index alone says what is in the bank: a file without a record is a build that has not finished.  The wheel of
evenroad has the files of up to 256 points; those of more, which studies draw, come with evenroad-studies.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_known
from evenroad._npz import read_array
from evenroad.errors import BrokenFile, NotAvailable, shown
from evenroad.points.pointset import PointSet

DATA = Path(__file__).parent / "data"
INDEX = "index.json"
STUDIES, LARGE_SETS = "evenroad_studies", "sets"
"""The package with the files of larger sets, and their folder in it."""
MOST_IN_THE_CORE = 256
"""Number of points of the largest sets in evenroad's own wheel."""
SEED = 20261121
"""Seed of the bank: set i of every cell is annealed with ``SeedSequence(SEED, spawn_key=(i,))``."""


@dataclass(frozen=True)
class Cell:
    """The pool of one family at one n and d: how its sets were made, and by which version.

    `hashes` are the ``PointSet.hash`` of the stored float32 values; `measures` has the values of every set.
    """

    path: Path
    n: int
    d: int
    method: str
    objective: str
    version: str
    steps: int
    hashes: tuple[str, ...]
    measures: dict[str, tuple[float, ...]]

    @property
    def sets(self) -> int:
        """How many sets the pool has."""
        return len(self.hashes)

    def load(self) -> npt.NDArray[np.float32]:
        """Return the sets, shape (sets, n, d), float32 in [0, 1).

        Raises BrokenFile if the file is missing or damaged, or a set does not have the hash of the index.
        """
        return _load_checked(self.path, (self.sets, self.n, self.d), self.hashes)


@dataclass(frozen=True)
class Bank:
    """A folder of trained sets, by default the one that ships; see the module for its layout."""

    folder: Path = DATA

    def has(self, family: str, n: int, d: int) -> bool:
        """Say whether the bank holds a pool of this family at this n and d."""
        return str(n) in _index(self.folder).get(family, {}).get(str(d), {})

    def cell(self, family: str, n: int, d: int) -> Cell:
        """Return the pool of one family at one n and d.

        UnknownName if the bank has no such family, NotAvailable, with what there is, if the family has no such pool or
        its package is not installed; BrokenFile if the index is damaged.
        """
        index = _index(self.folder)
        require_known("family in the bank:", family, index)
        cells = index[family].get(str(d), {})
        if not cells:
            raise NotAvailable(f"{family} has no sets in d={d}; it has d = {_listed(index[family])}")
        if str(n) not in cells:
            raise NotAvailable(f"{family} has no set of n={n} in d={d}; it has n = {_listed(cells)}")
        record = cells[str(n)]
        try:
            made_by = {name: record[name] for name in ("method", "objective", "version", "steps")}
            measures = {name: tuple(values) for name, values in record["measures"].items()}
            path = _file(self.folder, family, n, d)
            return Cell(path, n, d, hashes=tuple(record["hashes"]), measures=measures, **made_by)
        except (KeyError, TypeError, AttributeError) as error:
            raise BrokenFile(
                f"the index of the bank {self.folder}: {family} n={n} d={d} is no record ({shown(error)})"
            ) from error


def _file(folder: Path, family: str, n: int, d: int) -> Path:
    """Return where the sets of a cell are: in the bank's folder, or for the one that ships in the studies."""
    path = folder / family / cell_name(n, d)
    if folder != DATA or path.exists():
        return path
    for location in _large_folders():
        if (large := location / family / path.name).exists():
            return large
    raise NotAvailable(
        f"the {family} sets of n={n} in d={d} are in the package evenroad-studies, which is not installed:"
        " pip install evenroad-studies, in a clone ./studies"
    )


def has_large_sets() -> bool:
    """Return whether the sets of more than 256 points are here: those of the studies."""
    return bool(_large_folders())


def _large_folders() -> list[Path]:
    """Return where the studies, if they are installed, keep the large sets."""
    studies = find_spec(STUDIES)
    locations = [] if studies is None else studies.submodule_search_locations or []
    return [folder for location in locations if (folder := Path(location, LARGE_SETS)).is_dir()]


def cell_name(n: int, d: int) -> str:
    """Return the file name of a cell inside its family's folder."""
    return f"d{d:02d}-n{n:04d}.npy"


def _listed(numbers: dict[str, Any]) -> str:
    return ", ".join(sorted(numbers, key=int))


def _index(folder: Path) -> dict[str, Any]:
    path = folder / INDEX
    try:
        return _parse_index(path, path.stat().st_mtime_ns)
    except FileNotFoundError:
        return {}


@lru_cache(maxsize=8)
def _parse_index(path: Path, mtime_ns: int) -> dict[str, Any]:
    """Parse the index; `mtime_ns` is part of the key so that a bank being built is seen to grow."""
    try:
        index = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BrokenFile(f"the bank's index {path} cannot be read: {error}") from error
    if not isinstance(index, dict):
        raise BrokenFile(f"the bank's index {path} must be a JSON object")
    return index


@lru_cache(maxsize=32)
def _load_checked(path: Path, shape: tuple[int, ...], hashes: tuple[str, ...]) -> npt.NDArray[np.float32]:
    try:
        with open(path, "rb") as file:
            sets = read_array(file, path.stat().st_size)
    except Exception as error:  # no list is complete: see evenroad._npz
        raise BrokenFile(f"the bank's file {path} cannot be read: {shown(error)}") from error
    if sets.dtype != np.float32 or sets.shape != shape:
        raise BrokenFile(f"the bank's file {path} is not a float32 array of shape {shape}")
    for replica, expected in enumerate(hashes):
        if PointSet(sets[replica]).hash != expected:
            raise BrokenFile(f"{path}: set {replica} does not match the hash in the index")
    sets.setflags(write=False)
    return sets
