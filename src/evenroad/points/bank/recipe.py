"""What the bank holds: the fixed table from which every shipped set was, and can again be, made."""

from __future__ import annotations

from dataclasses import dataclass

SEED = 20261121
"""Set i of every cell is annealed with ``SeedSequence(SEED, spawn_key=(i,))``."""


@dataclass(frozen=True)
class Recipe:
    """One cell of the bank: how its sets are made.

    Attributes
    ----------
    family : str
        Name of the family.
    d, n : int
        Dimension and number of points.
    sets : int
        Size of the pool.
    objective : str
        What is made small; see :func:`evenroad.points.optimise.parse_objective`.
    steps : int
        Annealing steps.
    """

    family: str
    d: int
    n: int
    sets: int
    objective: str
    steps: int


def recipes() -> list[Recipe]:
    """Return every cell of the bank, cheapest first within a family and dimension."""
    return [_hickernell(d, n) for d in (2,) for n in (32, 64, 128, 256, 512, 1024)]


def _hickernell(d: int, n: int) -> Recipe:
    # Four times the standard steps gain about 3 % at n <= 128 and 1 % above, where they cost most.
    steps = 20_000 if n <= 256 else 10_000
    return Recipe("hickernell", d, n, sets=64, objective="hickernell", steps=steps)
