"""What the bank holds: the fixed table from which every shipped set was, and can again be, made."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad.points.even import EVEN

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


COUNTS = (16, 32, 64, 128, 256, 512, 1024, 2048)
HICKERNELL_DIMENSIONS = tuple(range(1, 15))


def recipes() -> list[Recipe]:
    """Return every cell of the bank, in the order in which they are built: most wanted first."""
    first = [
        (2, "hickernell"),
        (2, "even"),
        (10, "hickernell"),
        (3, "hickernell"),
        (5, "hickernell"),
        (3, "even"),
    ]
    cells = [(d, "hickernell") for d in HICKERNELL_DIMENSIONS] + [(d, "even") for d in EVEN]
    order = first + sorted((cell for cell in cells if cell not in first), key=lambda cell: abs(cell[0] - 6))
    return [_recipe(family, d, n) for d, family in order for n in COUNTS]


def _recipe(family: str, d: int, n: int) -> Recipe:
    objective = "hickernell" if family == "hickernell" else EVEN[d]
    return Recipe(family, d, n, sets=_sets(family, d, n), objective=objective, steps=_steps(family, d, n))


def _sets(family: str, d: int, n: int) -> int:
    """Success depends on which set is drawn, most in low dimensions: larger pools there."""
    if n == 2048:
        return 4 if d <= 3 else 2
    if family == "even" and d == 1:
        return 4  # all but the same: an even grid
    if family == "even" and n > 256:
        return 32 if (d, n) == (2, 512) else 16 if d <= 3 else 8
    return {1: 32, 2: 64, 3: 32}.get(d, 8)


def _steps(family: str, d: int, n: int) -> int:
    """More steps where they gain something: 20 000 instead of 5000 gain 3 % at n <= 128 and 1 % above."""
    if family == "even":
        return 5_000
    return 20_000 if n <= 256 else 10_000 if n <= 512 or d == 2 else 5_000
