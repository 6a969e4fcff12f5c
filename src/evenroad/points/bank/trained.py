"""Trained families: a set of any n and d, from the bank, from the user's cache, or annealed on demand."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from evenroad import __version__
from evenroad._checks import require_count, require_known
from evenroad._files import cache_folder, require_writable_folder
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import BrokenFile, NotAvailable, UnknownName
from evenroad.points.bank.bank import SEED, Bank
from evenroad.points.npz import load_points, save_points
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry

if TYPE_CHECKING:
    from evenroad.points.bank.anneal import Callback

ON_DEMAND_SETS = 8
"""Size of the pool of an (n, d) that is not in the bank; its sets are made one by one, as they are drawn."""

ON_DEMAND_STEPS = 5000

TRAINED_FAMILIES: dict[str, str] = {
    "hickernell": "sets annealed for the Hickernell L2 discrepancy",
    "mpmc": "sets of the paper's message-passing network, for the same measure as hickernell; only those that ship",
}
"""Name -> one line about the family."""


@dataclass(frozen=True)
class Trained:
    """Draws a set of a trained family, and can make those that do not ship (but not the network's).

    Which set is drawn depends on `rng` alone, never on what the cache holds.

    Parameters
    ----------
    family : {"hickernell", "mpmc"}
    train : bool
        Anneal a set that is neither in the bank nor in the cache; else refuse, naming the n that there are.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step of an annealing.
    bank : Bank
        By default the one that ships with evenroad.
    """

    family: str
    train: bool = False
    callback: Callback | None = field(default=None, compare=False)
    bank: Bank = field(default_factory=Bank)
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
        """Return one set of n points in d dimensions, and whether it is ``exact`` (shipped), ``cached`` or ``fresh``.

        Raises NotAvailable if there is no such set and it may not be made, BrokenFile if a new one could not be kept:
        nothing is annealed then.
        """
        n, d = require_count("n", n), require_count("d", d)
        if self.bank.has(self.family, n, d) or self.family == "mpmc":
            return self._from_bank(n, d, rng), "exact"
        replica = int(generator(rng).integers(ON_DEMAND_SETS))
        # The family's name is that of what it minimises.
        name, steps = self.family, ON_DEMAND_STEPS
        origin = Origin(family=name, method="annealed", objective=name, replica=replica, steps=steps)
        file = _cache_file(origin, n, d)
        points, source = _cached(file, origin, n, d), "cached"
        if points is None:
            if not self.train:
                raise NotAvailable(self._advice(n, d, rng))
            points, source = self._anneal(file, origin, n, d), "fresh"
        return points.with_origin(seed=seed_of(rng)), source

    def _from_bank(self, n: int, d: int, rng: RngLike) -> PointSet:
        cell = self.bank.cell(self.family, n, d)
        replica = int(generator(rng).integers(cell.sets))
        made_by = {name: getattr(cell, name) for name in ("method", "objective", "steps", "version")}
        origin = Origin(family=self.family, seed=seed_of(rng), replica=replica, **made_by)
        return PointSet(cell.load()[replica], origin)

    def _anneal(self, file: Path, origin: Origin, n: int, d: int) -> PointSet:
        """Make a set and keep it.

        One kind of processor always makes the same bits, and a file appears in one step: two processes that anneal
        it at once write the same content, whichever comes last.
        """
        # Here, because the kernels take numba.
        from evenroad.points.bank.anneal import anneal
        from evenroad.points.measures import MEASURES

        # Before the minutes that it may take.
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise BrokenFile(
                f"cannot make the cache folder {file.parent}: {error.strerror or error}"
                " (EVENROAD_CACHE names another)"
            ) from error
        require_writable_folder(file)
        seed = np.random.SeedSequence(SEED, spawn_key=(origin.replica or 0,))
        measure = MEASURES[origin.objective]
        made = anneal(n, d, measure, steps=ON_DEMAND_STEPS, rng=seed, callback=self.callback)
        points = PointSet(made.points.astype(np.float32), origin)
        save_points(file, points)
        return points

    def _advice(self, n: int, d: int, rng: RngLike) -> str:
        try:
            self.bank.cell(self.family, n, d)
        except (NotAvailable, UnknownName) as error:
            known = str(error)
        command = (
            f"evenroad points -n {n} -d {d} --sampler {self.family} --seed {seed_of(rng) or 0} -o set.npy"
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
