"""Two independent samples: Fisher's exact test of equal success rates."""

from __future__ import annotations

import numpy as np

from evenroad.bench.statistics._counts import as_successes
from evenroad.errors import InvalidValue


def fisher_exact(first: tuple[int, int], second: tuple[int, int]) -> float:
    """Return the two-sided p-value that two groups of runs have the same success rate.

    Given the totals, all tables that are no likelier than the one seen are counted.

    Parameters
    ----------
    first, second : tuple of two int
        (solved, runs) of each group, runs >= 1.

    Raises
    ------
    InvalidValue
        If a pair is not one of counts with ``0 <= solved <= runs``.

    References
    ----------
    R. A. Fisher (1922), On the interpretation of chi-squared from contingency tables, J. R. Stat. Soc. 85, 87-94.
    """
    from scipy.stats import fisher_exact as exact

    if len(first) != 2 or len(second) != 2:
        raise InvalidValue(f"each group must be (solved, runs), got {first!r} and {second!r}")
    solved, runs = as_successes([first[0], second[0]], [first[1], second[1]])
    return float(min(1.0, exact(np.stack([solved, runs - solved])).pvalue))
