"""Trained families: sets of the bank, by n, d and a seed."""

from __future__ import annotations

from dataclasses import dataclass, field

from evenroad._checks import require_count, require_known
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import NotAvailable
from evenroad.points.bank.bank import Bank
from evenroad.points.pointset import Origin, PointSet
from evenroad.points.randomise import Symmetry

TRAINED_FAMILIES: dict[str, str] = {
    "hickernell": "sets annealed for the Hickernell L2 discrepancy",
    "mpmc": "sets of the paper's message-passing network, for the same measure as hickernell",
}
"""Name -> one line about the family."""


@dataclass(frozen=True)
class Trained:
    """Draws a set of a trained family, of those that ship.

    Parameters
    ----------
    family : {"hickernell", "mpmc"}
    bank : Bank
        By default the one that ships with evenroad.
    """

    family: str
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
        """Return one set of n points in d dimensions; NotAvailable if there is none of this n and d."""
        n, d = require_count("n", n), require_count("d", d)
        try:
            cell = self.bank.cell(self.family, n, d)
        except NotAvailable as error:
            if self.family != "hickernell" or "pip install" in str(error):
                raise
            made = f"evenroad train -n {n} -d {d} --objective hickernell --sets 1 -o sets/"
            raise NotAvailable(f"{error}; evenroad-studies makes one: {made}") from None
        replica = int(generator(rng).integers(cell.sets))
        made_by = {name: getattr(cell, name) for name in ("method", "objective", "steps", "version")}
        origin = Origin(family=self.family, seed=seed_of(rng), replica=replica, **made_by)
        return PointSet(cell.load()[replica], origin)
