"""Trained families: a set of any n and d, from the bank, from the user's cache, or annealed on demand."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from evenroad import __version__
from evenroad._checks import require_count, require_known
from evenroad._files import cache_folder, require_writable_folder
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.points.bank.bank import SEED, Bank, open_bank
from evenroad.points.npz import load_points, save_points
from evenroad.points.pointset import BELOW_ONE, Origin, PointSet
from evenroad.points.sampler import Symmetry

ON_DEMAND_SETS = 8
"""Size of the pool of an (n, d) that is not in the bank; its sets are made one by one, as they are drawn."""

ON_DEMAND_STEPS = 5000

TRAINED_FAMILIES: dict[str, str] = {
    "hickernell": "sets annealed for the Hickernell L2 discrepancy",
    "mpmc": "sets of the paper's message-passing network, for the same measure as hickernell; only those that ship",
}
"""Name -> one line about the family."""

Callback = Callable[[int, int, float], object]


@dataclass(frozen=True)
class Trained:
    """Draws a set of a trained family, and can make those that do not ship.

    Which set is drawn depends on `rng` alone, never on what the cache holds.

    Parameters
    ----------
    family : str
        ``hickernell`` or ``mpmc``.
    train : bool
        Anneal a set that is neither in the bank nor in the cache; else refuse, naming the n that there are.
        The network's sets are never made on demand.
    callback : callable, optional
        Progress of an annealing, as for :func:`evenroad.points.bank.anneal.anneal`.
    bank : Bank, optional
        By default the one that ships with evenroad.
    """

    family: str
    train: bool = False
    callback: Callback | None = field(default=None, compare=False)
    bank: Bank | None = None
    any_n = False
    symmetries = frozenset({Symmetry.PERMUTATION})

    def __post_init__(self) -> None:
        require_known("trained family", self.family, TRAINED_FAMILIES)

    @property
    def name(self) -> str:
        """The family's name."""
        return self.family

    @property
    def about(self) -> str:
        """One line about the family."""
        return TRAINED_FAMILIES[self.family]

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return one set of n points in d dimensions; see :meth:`find`."""
        return self.find(n, d, rng=rng)[0]

    def find(self, n: int, d: int, *, rng: RngLike = 0) -> tuple[PointSet, str]:
        """Return one set of n points in d dimensions, and where it came from.

        Returns
        -------
        points : PointSet
        source : str
            ``exact`` (shipped), ``cached`` (made before, on this machine) or ``fresh``.

        Raises
        ------
        NotAvailable
            If there is no such set and it may not be made.
        BrokenFile
            If a new set could not be kept; nothing is annealed then.
        """
        n, d = require_count("n", n), require_count("d", d)
        bank = self.bank or open_bank()
        if bank.has(self.family, n, d):
            return self._from_bank(bank, n, d, rng), "exact"
        if self.family == "mpmc":
            bank.cell(self.family, n, d)  # raises, and says what there is
        replica = int(generator(rng).integers(ON_DEMAND_SETS))
        # The family's name is that of what it minimises.
        origin = Origin(
            family=self.family,
            method="annealed",
            objective=self.family,
            replica=replica,
            steps=ON_DEMAND_STEPS,
        )
        file = _cache_file(origin, n, d)
        points, source = _cached(file, origin, n, d), "cached"
        if points is None:
            if not self.train:
                raise NotAvailable(self._what_there_is(bank, n, d, rng))
            points, source = self._anneal(file, origin, n, d), "fresh"
        return points.with_origin(seed=seed_of(rng)), source

    def _from_bank(self, bank: Bank, n: int, d: int, rng: RngLike) -> PointSet:
        cell = bank.cell(self.family, n, d)
        replica = int(generator(rng).integers(cell.sets))
        origin = Origin(
            family=self.family,
            method=cell.method,
            objective=cell.objective,
            seed=seed_of(rng),
            replica=replica,
            steps=cell.steps,
            version=cell.version,
        )
        return PointSet(cell.load()[replica], origin)

    def _anneal(self, file: Path, origin: Origin, n: int, d: int) -> PointSet:
        """Make a set and keep it.

        One kind of processor always makes the same bits, and a file appears in one step: two processes that anneal
        it at once write the same content, whichever comes last.
        """
        from evenroad.points.bank.anneal import anneal
        from evenroad.points.measures import MEASURES

        _require_cache(file)
        seed = np.random.SeedSequence(SEED, spawn_key=(origin.replica or 0,))
        made = anneal(
            n, d, MEASURES[origin.objective], steps=ON_DEMAND_STEPS, rng=seed, callback=self.callback
        )
        points = PointSet(np.minimum(made.points.astype(np.float32), np.float32(BELOW_ONE)), origin)
        save_points(file, points)
        return points

    def _what_there_is(self, bank: Bank, n: int, d: int, rng: RngLike) -> str:
        try:
            bank.cell(self.family, n, d)
        except (NotAvailable, UnknownName) as error:
            known = str(error)
        command = (
            f"evenroad points -n {n} -d {d} --family {self.family} --seed {seed_of(rng) or 0} -o set.npy"
        )
        return f"{known}; this one is made by: {command}"


def _cache_file(origin: Origin, n: int, d: int) -> Path:
    # All that decides the bits is part of the name: sets of an earlier recipe are not mistaken for today's.
    recipe = f"{origin.objective}|{origin.steps}|{SEED}|{__version__}"
    digest = hashlib.sha256(recipe.encode()).hexdigest()[:8]
    name = f"{origin.family}-{digest}-d{d:02d}-n{n:05d}-{origin.replica:03d}.npz"
    return cache_folder() / "sets" / name


def _cached(file: Path, origin: Origin, n: int, d: int) -> PointSet | None:
    """Return the set from the cache; None where it is missing, damaged or another one, and to be made again."""
    try:
        points = load_points(file)
    except BrokenFile:
        return None
    return points if (points.n, points.d, points.origin) == (n, d, origin) else None


def _require_cache(file: Path) -> None:
    """Raise BrokenFile unless a set could be kept now: before the minutes that annealing it may take."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BrokenFile(
            f"cannot make the cache folder {file.parent}: {error.strerror or error} (EVENROAD_CACHE names another)"
        ) from error
    require_writable_folder(file)
