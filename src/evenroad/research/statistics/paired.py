"""Two samplers on the same runs: McNemar's exact test, and the difference of their success rates."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import bdtr, ndtri

from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import as_counts, require_share
from evenroad.research.statistics.interval import LEVEL, Interval


def mcnemar_exact(only_first: npt.ArrayLike, only_second: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return the two-sided p-value of McNemar's exact test.

    Runs that both or neither solved say nothing of a difference; of the others, each is as likely to be the
    first's as the second's if there is none: twice the smaller tail of a binomial with share 1/2, at most 1.

    Parameters
    ----------
    only_first, only_second : array_like of int
        Runs that only the first, only the second solved, >= 0.

    Returns
    -------
    ndarray of float64
        p-values in (0, 1]; 1 where no run tells the two apart.

    References
    ----------
    Q. McNemar (1947), Note on the sampling error of the difference between correlated proportions, Psychometrika
    12, 153-157; the exact form as in A. Agresti (2002), Categorical Data Analysis, section 10.1.
    """
    first, second = as_counts("only_first", only_first), as_counts("only_second", only_second)
    smaller, both = np.minimum(first, second), first + second
    return np.minimum(1.0, 2.0 * bdtr(smaller.astype(np.float64), both, 0.5))


def bonett_price(only_first: int, only_second: int, pairs: int, *, level: float = LEVEL) -> Interval:
    """Return the interval of the difference of two paired success rates, first minus second.

    One is added to both counts and two to the number of pairs before Wald's formula, so that the interval has
    a width where nothing was seen.

    Parameters
    ----------
    only_first, only_second : int
        Pairs that only the first, only the second solved.
    pairs : int
        All pairs, >= 1.
    level : float
        Confidence, in (0, 1).

    Raises
    ------
    InvalidValue
        If a count is negative or there are more of them than pairs.

    References
    ----------
    D. G. Bonett and R. M. Price (2012), Adjusted Wald confidence interval for a difference of binomial proportions
    based on paired data, J. Educ. Behav. Stat. 37, 479-488 (their adjusted Wald interval).
    """
    first = int(as_counts("only_first", only_first))
    second = int(as_counts("only_second", only_second))
    total = int(as_counts("pairs", pairs))
    if total < 1 or first + second > total:
        raise InvalidValue(f"of {pairs!r} pairs, {only_first!r} and {only_second!r} cannot be told apart")
    share_first, share_second = (first + 1) / (total + 2), (second + 1) / (total + 2)
    difference = share_first - share_second
    z = float(ndtri(0.5 + 0.5 * require_share("level", level)))
    half = z * float(np.sqrt((share_first + share_second - difference**2) / (total + 2)))
    return Interval(max(-1.0, difference - half), min(1.0, difference + half), "bonett-price")
