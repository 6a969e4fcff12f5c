"""Two samplers on the same runs: McNemar's exact test, differences of rates, and Student's interval over units."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import bdtr, ndtri, stdtr, stdtrit

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.research.statistics.rates import LEVEL, Interval, as_counts, require_share


def mcnemar_exact(only_first: npt.ArrayLike, only_second: npt.ArrayLike) -> Floats:
    """Return the two-sided p-value of McNemar's exact test, in (0, 1]; 1 where no run tells the two apart.

    Runs that both or neither solved say nothing of a difference; of those that only the first or only the second
    solved, counts >= 0, each is as likely to be the first's if there is none: twice the smaller tail of a binomial
    with share 1/2.

    Q. McNemar (1947), Note on the sampling error of the difference between correlated proportions, Psychometrika 12,
    153-157; the exact form as in A. Agresti (2002), Categorical Data Analysis, section 10.1.
    """
    first, second = as_counts("only_first", only_first), as_counts("only_second", only_second)
    smaller, both = np.minimum(first, second), first + second
    return np.minimum(1.0, 2.0 * bdtr(smaller.astype(np.float64), both, 0.5))


def bonett_price(only_first: int, only_second: int, pairs: int, *, level: float = LEVEL) -> Interval:
    """Return the interval of the difference of two paired success rates, first minus second.

    Of `pairs` >= 1 runs only the first solved `only_first`, only the second `only_second`.  One is added to both counts
    and two to the number of pairs before Wald's formula, so that the interval has a width where nothing was seen.

    D. G. Bonett and R. M. Price (2012), Adjusted Wald confidence interval for a difference of binomial proportions
    based on paired data, J. Educ. Behav. Stat. 37, 479-488 (their adjusted Wald interval).

    Raises InvalidValue if a count is negative or there are more of them than pairs.
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


def student_interval(
    sums: npt.ArrayLike, runs: npt.ArrayLike, unit: str, *, lowest: float = -1.0, level: float = LEVEL
) -> Interval:
    """Return the interval of ``sum(sums) / sum(runs)``, a success rate or a paired difference, over units.

    The ratio's linearised error with Student's quantile for as many units (W. G. Cochran 1977, Sampling Techniques,
    section 6.4).  It needs no more than two units, but has no width where all units say the same, and is everything
    that is possible where there is one unit only.

    Parameters
    ----------
    sums, runs : array_like of int, shape (units,)
        Of a rate: successes and runs per unit, runs >= 1; of a difference: as
        :func:`~evenroad.research.statistics.clustered_difference`.  Others are an InvalidValue.
    unit : str
        What a unit is, in the plural, for `Interval.kind`.
    lowest : float
        Smallest value that is possible: 0 for a rate, -1 for a difference; the largest is 1.
    """
    ratio, error, units = _ratio_and_error(sums, runs)
    kind = f"student over {unit}"
    if units < 2:
        return Interval(lowest, 1.0, kind)
    half = float(stdtrit(units - 1, 0.5 + 0.5 * require_share("level", level))) * error
    return Interval(max(lowest, ratio - half), min(1.0, ratio + half), kind)


def student_test(sums: npt.ArrayLike, pairs: npt.ArrayLike) -> float:
    """Return the two-sided p-value that ``sum(sums) / sum(pairs)`` is 0; 1 where there is one unit only.

    Parameters and errors as :func:`student_interval`.
    """
    ratio, error, units = _ratio_and_error(sums, pairs)
    if units < 2 or ratio == 0.0:
        return 1.0
    return 0.0 if error == 0.0 else float(2.0 * stdtr(units - 1, -abs(ratio) / error))


def _ratio_and_error(sums: npt.ArrayLike, runs: npt.ArrayLike) -> tuple[float, float, int]:
    """Return the ratio, its standard error (NaN for one unit) and the number of units."""
    above, below = np.asarray(sums, dtype=np.float64), as_counts("runs", runs)
    if above.ndim != 1 or above.shape != below.shape or len(above) == 0 or np.any(below < 1):
        raise InvalidValue(
            f"sums and runs must be lists of one length >= 1, with runs >= 1, got {sums!r}, {runs!r}"
        )
    units, total = len(above), float(below.sum())
    ratio = float(above.sum()) / total
    if units < 2:
        return ratio, float("nan"), units
    squares = float(((above - ratio * below) ** 2).sum())
    return ratio, float(np.sqrt(squares * units / (units - 1))) / total, units
