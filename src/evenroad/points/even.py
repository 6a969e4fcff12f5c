"""The `even` family: our default sets, a small fixed table with its evidence.

Evidence, measured with 1000 random worlds a cell (new world, start and goal in every run; success in %, k = 4 / 10; two
stationary generators pooled, standard error 1.1) and, for d <= 3, 200 to 400 runs at the radius where uniform points
solve half:

====  ====================================  =========================  ================
d     family                                success                    uniform
====  ====================================  =========================  ================
2     average-squared + 10 x Riesz          73 (balls, radius rule)    50
3     average-squared + 10 x Riesz          75 (balls, radius rule)    50
5     periodic Riesz                        55.9 / 74.1                46.8 / 70.5
6     korobov                               49.9 / 69.3                41.3 / 66.2
7     korobov                               51.5 / 72.0                46.7 / 71.1
10    korobov                               46.3 / 65.1                44.0 / 62.6
====  ====================================  =========================  ================

Discrepancy alone does not plan better than scrambled Sobol points; together with separation it does in d = 2 .. 5.
From d = 6 on, the best rank-1 lattice plans like annealed sets and costs milliseconds.  The table is to be decided
again by the fair benchmark suite, on tuning seeds.
"""

from __future__ import annotations

KOROBOV = "korobov"
"""Entry of a dimension whose sets are constructed, not annealed."""

FIRST_KOROBOV_DIMENSION = 6

EVEN: dict[int, str] = {
    1: "log(average_squared) + 10*log(riesz)",
    2: "log(average_squared) + 10*log(riesz)",
    3: "log(average_squared) + 10*log(riesz)",
    4: "riesz",
    5: "riesz",
}
"""Dimension -> objective that is annealed; higher dimensions are Korobov lattices."""


def even_choice(d: int) -> str:
    """Return the objective of the `even` family in d dimensions, or ``"korobov"``."""
    return KOROBOV if d >= FIRST_KOROBOV_DIMENSION else EVEN[d]
