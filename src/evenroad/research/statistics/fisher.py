"""Two independent samples: Fisher's exact test of equal success rates."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln

from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import as_successes

SAME = 1e-7
"""Tables whose chances differ by this share or less are equally likely: the rest is rounding."""


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
    if len(first) != 2 or len(second) != 2:
        raise InvalidValue(f"each group must be (solved, runs), got {first!r} and {second!r}")
    solved, runs = as_successes([first[0], second[0]], [first[1], second[1]])
    total = int(solved.sum())
    of_first = np.arange(max(0, total - int(runs[1])), min(int(runs[0]), total) + 1)
    log_ways = _log_choose(runs[0], of_first) + _log_choose(runs[1], total - of_first)
    log_chance = log_ways - _log_choose(runs.sum(), np.array(total))
    seen = log_chance[int(solved[0]) - int(of_first[0])]
    return float(min(1.0, np.exp(log_chance[log_chance <= seen + SAME]).sum()))


def _log_choose(n: int, k: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
    ways: npt.NDArray[np.float64] = gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1)
    return ways
