"""Families whose sets were trained beforehand and ship in the bank."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._checks import require_count
from evenroad._rng import RngLike, generator, seed_of
from evenroad.points.bank import Bank, open_bank
from evenroad.points.pointset import Origin, PointSet


@dataclass(frozen=True)
class Banked:
    """Draws a set from the pool of one family.

    Parameters
    ----------
    family : str
        Name of the family in the bank.
    bank : Bank or None
        Where to look; None is the bank that ships with evenroad.
    """

    family: str
    bank: Bank | None = None

    @property
    def name(self) -> str:
        """The family's name."""
        return self.family

    def draw(self, n: int, d: int, *, rng: RngLike = 0) -> PointSet:
        """Return one of the pool's sets of n points in d dimensions; which one depends on `rng` alone.

        Raises
        ------
        NotAvailable
            If the bank has no set of this n and d; the text names the n it has.
        """
        n, d = require_count("n", n), require_count("d", d)
        cell = (self.bank or open_bank()).cell(self.family, n, d)
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
