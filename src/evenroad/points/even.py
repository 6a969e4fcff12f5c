"""The `even` family: our default sets, a small fixed table with its evidence.

Evidence: success in random worlds, starts and goals, half of them among balls and half among boxes that bound three
coordinates, with N = 128, 256 and 512 pooled; 1200 worlds in each dimension, 2400 in d = 3 and 4.  In %, at k = 4 / 10
symmetrised; "mean" is that over k = 4, 6, 10 and 20, by which was decided, and the last column how far `even` is ahead
of Korobov lattices, with the standard error of the paired difference:

==  ===========  ===========  ===========  ===========  ====  ==========
d   uniform      Sobol        annealed     korobov      mean  - korobov
==  ===========  ===========  ===========  ===========  ====  ==========
2   31.9 / 55.7  50.4 / 61.8  55.3 / 62.8  56.4 / 62.5  60.9  constructed
3   28.1 / 51.2  38.1 / 56.5  45.0 / 59.4  45.3 / 58.5  55.2  +0.5 (0.4)
4   26.4 / 50.1  31.8 / 54.4  38.9 / 57.7  37.4 / 56.4  52.1  +1.2 (0.5)
5   24.3 / 49.0  27.2 / 52.3  32.6 / 54.5  32.0 / 54.8  48.2  constructed
7   13.9 / 35.4  14.9 / 36.6  15.3 / 37.0  15.5 / 36.5  30.7  constructed
10  12.4 / 37.7  13.5 / 38.6  14.2 / 38.8  13.8 / 40.1  33.0  constructed
==  ===========  ===========  ===========  ===========  ====  ==========

"Annealed" is average-squared discrepancy + 10 x Riesz in d = 2, 3, 5 and 7, and Riesz in d = 4 and 10.  All families
that keep their points apart plan alike: annealed ones, A_d* lattices and Korobov lattices are within 1.3 points of each
other, far above uniform points in d = 2 to 5, and 2 to 4 points above scrambled Sobol points there, on average over k.
From d = 7 on all are 1 to 2 points above uniform ones, and none is clearly above Sobol's.  So a dimension is annealed
only where that is ahead of the Korobov lattice by more than a standard error: the lattice takes milliseconds, exists
for any N, and needs no storage.
In d = 1 it is an even grid, which cannot be beaten; dimensions that were not measured are taken to be like the
higher ones that were.

A known weakness, outside of what was decided by: in the plane with N = 64 the best Korobov lattice has its points
11 % closer than a hexagonal one, and annealed pools were 2.6 (0.7) points ahead in 1800 other tuning worlds; with
N = 32, and with N = 1024 in d = 2 and 5, the two were alike.  All candidates, every N and k::

    python -m benchmarks.decide_even        # gives docs/data/decide_even.csv; states the rule
"""

from __future__ import annotations

KOROBOV = "korobov"
"""Choice of a dimension whose sets are constructed, not annealed."""

EVEN: dict[int, str] = {
    3: "log(average_squared) + 10*log(riesz)",
    4: "riesz",
}
"""Dimension -> objective that is annealed; all others are Korobov lattices."""


def even_choice(d: int) -> str:
    """Return the objective of the `even` family in d dimensions, or ``"korobov"``."""
    return EVEN.get(d, KOROBOV)
