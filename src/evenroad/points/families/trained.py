"""Trained families for any n and d: from the bank, from the user's cache, or annealed on demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import NotAvailable, UnknownName
from evenroad.points.bank import Bank, open_bank
from evenroad.points.bank.bank import SEED
from evenroad.points.even import KOROBOV, even_choice
from evenroad.points.families.cache import cached, keep, require_cache
from evenroad.points.pointset import BELOW_ONE, Origin, PointSet

ON_DEMAND_SETS = 8
"""Size of the pool of an (n, d) that is not in the bank; its sets are made one by one, as they are drawn."""

ON_DEMAND_STEPS = 5000

TRAINED_FAMILIES: tuple[str, ...] = ("even", "hickernell", "mpmc")

Callback = Callable[[int, int, float], object]


@dataclass(frozen=True)
class Trained:
    """Draws a set of a trained family, and can make those that do not ship.

    Which set is drawn depends on `rng` alone, never on what the cache holds.

    Parameters
    ----------
    family : str
        ``even``, ``hickernell`` or ``mpmc``.
    train : bool
        Anneal a set that is neither in the bank nor in the cache; else refuse, naming the n that there are.
        The network's sets are never made on demand.
    callback : callable, optional
        Progress of an annealing, as for :func:`evenroad.points.optimise.anneal`.
    bank : Bank, optional
        By default the one that ships with evenroad.
    """

    family: str
    train: bool = False
    callback: Callback | None = field(default=None, compare=False)
    bank: Bank | None = None

    def __post_init__(self) -> None:
        if self.family not in TRAINED_FAMILIES:
            raise UnknownName.among("trained family", self.family, TRAINED_FAMILIES)

    @property
    def name(self) -> str:
        """The family's name."""
        return self.family

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return one set of n points in d dimensions; see :meth:`find`."""
        return self.find(n, d, rng=rng)[0]

    def find(self, n: int, d: int, *, rng: RngLike = 0) -> tuple[PointSet, str]:
        """Return one set of n points in d dimensions, and where it came from.

        Returns
        -------
        points : PointSet
        source : str
            ``exact`` (shipped, or constructed), ``cached`` (made before, on this machine) or ``fresh``.

        Raises
        ------
        NotAvailable
            If there is no such set and it may not be made.
        """
        n, d = require_count("n", n), require_count("d", d)
        if self.family == "even" and even_choice(d) == KOROBOV:
            return self._korobov(n, d, rng), "exact"
        bank = self.bank or open_bank()
        if bank.has(self.family, n, d):
            return self._from_bank(bank, n, d, rng), "exact"
        if self.family == "mpmc":
            bank.cell(self.family, n, d)  # says what there is
        objective = even_choice(d) if self.family == "even" else self.family
        replica = int(generator(rng).integers(ON_DEMAND_SETS))
        key = (self.family, objective, ON_DEMAND_STEPS, n, d, replica)
        points, source = cached(*key), "cached"
        if points is None:
            if not self.train:
                raise NotAvailable(self._what_there_is(bank, n, d, rng))
            require_cache()
            points, source = self._anneal(n, d, objective, replica), "fresh"
            keep(*key, points)
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
            version=cell.version,
        )
        return PointSet(cell.load()[replica], origin)

    def _korobov(self, n: int, d: int, rng: RngLike) -> PointSet:
        # Here, because the samplers by name include this one.
        from evenroad.points.samplers.korobov import Korobov

        return Korobov().draw(n, d, rng=rng).with_origin(family=self.family)

    def _anneal(self, n: int, d: int, objective: str, replica: int) -> PointSet:
        from evenroad.points.optimise import anneal

        seed = np.random.SeedSequence(SEED, spawn_key=(replica,))
        made = anneal(n, d, objective, steps=ON_DEMAND_STEPS, rng=seed, callback=self.callback)
        stored = np.minimum(made.points.astype(np.float32), np.float32(BELOW_ONE))
        return PointSet(
            stored, Origin(family=self.family, method="annealed", objective=objective, replica=replica)
        )

    def _what_there_is(self, bank: Bank, n: int, d: int, rng: RngLike) -> str:
        try:
            bank.cell(self.family, n, d)
        except (NotAvailable, UnknownName) as error:
            known = str(error)
        command = (
            f"evenroad points -n {n} -d {d} --family {self.family} --seed {seed_of(rng) or 0} -o set.npy"
        )
        return f"{known}; this one is made by: {command}"
