"""The bank of trained sets: one folder per family, one float32 array (sets, n, d) per cell, one index.

``data/hickernell/d02-n0512.npy`` is in the bank if ``data/index.json`` has its record: ``{"hickernell": {"2": {"512":
{...}}}}``.  The wheel of evenroad has the files of up to 32 points; larger ones come with evenroad-studies.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_known
from evenroad._npz import read_array
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import BrokenFile, NotAvailable, shown
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry

DATA = Path(__file__).parent / "data"
INDEX = "index.json"
STUDIES, LARGE_SETS = "evenroad_studies", "sets"
"""The package with the files of larger sets, and their folder in it."""
MAKERS = "evenroad.trained"
"""Group of entry points, family -> function: other packages make sets that the bank does not have."""
MOST_IN_THE_CORE = 32
"""Number of points of the largest sets in evenroad's own wheel."""
SEED = 20261121
"""Seed of the bank: set i of every cell is of ``SeedSequence(SEED, spawn_key=(i,))``."""


@dataclass(frozen=True)
class Cell:
    """The sets of one family at one n and d, with `hashes` of the stored float32 values."""

    path: Path
    n: int
    d: int
    method: str
    objective: str
    version: str
    steps: int
    hashes: tuple[str, ...]

    @property
    def sets(self) -> int:
        """Number of sets."""
        return len(self.hashes)

    def load(self) -> npt.NDArray[np.float32]:
        """Return the sets, (sets, n, d), float32 in [0, 1); BrokenFile if the file is missing or damaged."""
        return _load_checked(self.path, (self.sets, self.n, self.d), self.hashes)


@dataclass(frozen=True)
class Bank:
    """A folder of trained sets, by default the shipped one."""

    folder: Path = DATA

    def has(self, family: str, n: int, d: int) -> bool:
        """Return whether the bank has a pool of this family at this n and d."""
        return str(n) in _index(self.folder).get(family, {}).get(str(d), {})

    def cell(self, family: str, n: int, d: int) -> Cell:
        """Return the pool of one family at one n and d.

        UnknownName for an unknown family, NotAvailable if it has no such pool or its package is not installed,
        BrokenFile if the index is damaged.
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
            path = _file(self.folder, family, n, d)
            return Cell(path, n, d, hashes=tuple(record["hashes"]), **made_by)
        except (KeyError, TypeError, AttributeError) as error:
            raise BrokenFile(
                f"the index of the bank {self.folder}: {family} n={n} d={d} is no record ({shown(error)})"
            ) from error


def _file(folder: Path, family: str, n: int, d: int) -> Path:
    """Return the file of a cell, in the bank's folder or in the studies."""
    path = folder / family / cell_name(n, d)
    return path if folder != DATA or path.exists() else large_file(family, path.name, f" of n={n} in d={d}")


def large_file(family: str, name: str, which: str = "") -> Path:
    """Return a file of a family in the studies; NotAvailable if they are not installed."""
    for location in _large_folders():
        if (large := location / family / name).exists():
            return large
    raise NotAvailable(
        f"the {family} sets{which} are in the package evenroad-studies, which is not installed:"
        " pip install evenroad-studies, in a clone ./studies"
    )


def has_large_sets() -> bool:
    """Return whether the sets of more than 32 points are installed, with the studies."""
    return bool(_large_folders())


def _large_folders() -> list[Path]:
    """Return the folders of large sets of installed studies."""
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
    """Parse the index; `mtime_ns` is part of the cache's key, so a changed index is read again."""
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


TRAINED_FAMILIES: dict[str, str] = {
    "hickernell": "sets annealed for the Hickernell L2 discrepancy",
    "mpmc": "sets of the paper's message-passing network, for the same measure as hickernell",
}
"""Name -> one line about the family."""


POOL, STEPS, FEWEST_STEPS, WORK = 8, 5000, 300, 1.5e10
"""`POOL`: sets of a pool that is annealed on demand.  `STEPS`: steps of each set.  `WORK`: limit on the coordinates of
pairs examined, some seconds.  Beyond it a set takes fewer steps; it is not made in fewer than `FEWEST_STEPS`."""


@dataclass(frozen=True)
class Trained:
    """Draws a set of a trained family, ``hickernell`` or ``mpmc``, from a bank, by default the shipped one.

    If the bank has no pool, sets of ``hickernell`` are annealed once per process: 0.3 s for 96 points in the plane,
    5 s for 512 in ten dimensions.  The network of evenroad-studies makes sets of ``mpmc`` in the same time.
    """

    family: str
    bank: Bank = field(default_factory=Bank)
    symmetries = frozenset({Symmetry.PERMUTATION})

    def __post_init__(self) -> None:
        require_known("trained family", self.family, TRAINED_FAMILIES)

    @property
    def name(self) -> str:
        """The family's name."""
        return self.family

    @property
    def any_n(self) -> bool:
        """Whether it has a set of every n that some seconds suffice to make."""
        return self.family == "hickernell" or _maker(self.family) is not None

    @property
    def about(self) -> str:
        """One line about the family."""
        return TRAINED_FAMILIES[self.family]

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return one set of n points in d dimensions; NotAvailable if there is none and making one takes long."""
        n, d = require_count("n", n), require_count("d", d)
        try:
            cell = self.bank.cell(self.family, n, d)
        except NotAvailable as error:
            if "pip install" in str(error):
                # Not annealed, because that gives another set than an installation with the studies.
                raise
            replica = int(generator(rng).integers(POOL))
            made = _made(self.family, n, d, replica)
            if made is not None:
                return made.with_origin(seed=seed_of(rng))
            if self.family == "mpmc" and _maker("mpmc") is None:
                raise NotAvailable(f"{error}; for other sets: pip install evenroad-studies") from None
            how = "--method mpmc" if self.family == "mpmc" else "--objective hickernell"
            command = f"evenroad train -n {n} -d {d} {how} --sets 1 -o sets/"
            raise NotAvailable(f"{error}; evenroad-studies makes one: {command}") from None
        replica = int(generator(rng).integers(cell.sets))
        made_by = {name: getattr(cell, name) for name in ("method", "objective", "steps", "version")}
        origin = Origin(family=self.family, seed=seed_of(rng), replica=replica, **made_by)
        return PointSet(cell.load()[replica], origin)


@lru_cache(maxsize=64)
def _made(family: str, n: int, d: int, replica: int) -> PointSet | None:
    """Return a set of a pool that is made on demand, from the bank's seeds; None if that takes long."""
    seeds = np.random.SeedSequence(SEED, spawn_key=(replica,))
    if family == "mpmc":
        maker = _maker(family)
        made: PointSet | None = None if maker is None else maker(n, d, seeds)
        return made if made is None else made.with_origin(replica=replica)
    steps = min(STEPS, int(WORK / (n * n * d)))
    if steps < FEWEST_STEPS:
        return None
    # Imported late: most draws find their set in a file.
    from evenroad.points.anneal import anneal
    from evenroad.points.measures import MEASURES

    points = anneal(n, d, MEASURES["hickernell"], steps=steps, rng=seeds).points
    origin = Origin(family="hickernell", method="annealed", objective="hickernell", steps=steps, replica=replica)
    return PointSet(points, origin)


@lru_cache(maxsize=4)
def _maker(family: str) -> Callable[[int, int, np.random.SeedSequence], PointSet | None] | None:
    """Return the function of an installed package that makes sets of a family."""
    # Imported late, since it takes long.
    from importlib.metadata import entry_points

    for found in entry_points(group=MAKERS):
        if found.name == family:
            maker: Callable[[int, int, np.random.SeedSequence], PointSet | None] = found.load()
            return maker
    return None
