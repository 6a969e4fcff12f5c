"""What the bank holds: the fixed table from which every shipped set was, and can again be, made."""

from __future__ import annotations

from dataclasses import dataclass


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
        Steps of the optimiser.
    method : str
        ``annealed`` (noisy Adam on the coordinates) or ``network`` (MPMC; needs the extra ``[train]``).
    """

    family: str
    d: int
    n: int
    sets: int
    objective: str
    steps: int
    method: str = "annealed"


COUNTS = (16, 32, 64, 128, 256, 512, 1024, 2048)
HICKERNELL_DIMENSIONS = tuple(range(1, 15))
MPMC_CELLS = tuple((2, n) for n in COUNTS[1:-1]) + tuple(
    (d, n) for n in (128, 256, 512, 1024) for d in (3, 5, 10)
)


def recipes() -> list[Recipe]:
    """Return every cell of the bank, in the order in which they are built: most wanted first."""
    first = (2, 10, 3, 5)
    order = [*first, *(d for d in HICKERNELL_DIMENSIONS if d not in first)]
    return [_hickernell(d, n) for d in order for n in COUNTS] + [_mpmc(d, n) for d, n in MPMC_CELLS]


def _hickernell(d: int, n: int) -> Recipe:
    return Recipe("hickernell", d, n, sets=_sets(d, n), objective="hickernell", steps=_steps(d, n))


def _sets(d: int, n: int) -> int:
    """Success depends on which set is drawn, most in low dimensions: larger pools there, smaller for slow cells."""
    if n == 2048:
        return 4 if d <= 3 else 2
    return {1: 32, 2: 64, 3: 32}.get(d, 8)


def _steps(d: int, n: int) -> int:
    """5000 steps are the standard; four times as many, for the paper's d = 2 and 10, gain about 2 %."""
    if d == 10 and n <= 1024:
        return 20_000 if n <= 512 else 10_000
    if d == 2 and n <= 512:
        return 20_000 if n <= 128 else 10_000
    if n <= 256:
        return 10_000
    return 5_000 if n <= 1024 else 3_000


def _mpmc(d: int, n: int) -> Recipe:
    # On a CPU a set of 1024 points takes a minute: smaller pools there.
    return Recipe("mpmc", d, n, 16 if n <= 256 else 4, "hickernell", steps=2_000, method="network")
