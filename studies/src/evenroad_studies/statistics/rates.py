"""Success rates: counts, intervals, two samplers on the same or on other runs, and many tests at once."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import bdtr, gammaln, ndtri, stdtr, stdtrit

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue

LEVEL = 0.95
"""Confidence of every interval."""
UPPER = 0.5 + 0.5 * LEVEL
"""Share below the upper end of one."""
Z = float(ndtri(UPPER))


class Interval(NamedTuple):
    """A confidence interval of a share in [0, 1], or of a difference in [-1, 1], and how it was made.

    `kind` is ``wilson``, of paired differences ``bonett-price``, where runs are independent.  Where they come in units
    (sets, blocks or instances): ``wilson over sets``, of differences ``paired bootstrap over instances``, with few or
    equal ones ``bonett-price over instances``; ``student over sets``; of sets against independent runs ``newcombe over
    sets``.
    """

    low: float
    high: float
    kind: str

    def or_wider(self, other: Interval) -> Interval:
        """Return the wider of the two, this one where they are alike."""
        return other if other.high - other.low > self.high - self.low else self


def as_counts(name: str, values: Any) -> Ints:
    """Return `values` as int64, or raise InvalidValue unless all are whole numbers >= 0."""
    array = np.asarray(values)
    if array.dtype.kind not in "iub" and not (array.dtype.kind == "f" and np.all(array == np.trunc(array))):
        raise InvalidValue(f"{name} must be whole numbers, got {values!r}")
    if np.any(array < 0):
        raise InvalidValue(f"{name} must be >= 0, got {values!r}")
    return array.astype(np.int64)


def as_successes(solved: Any, runs: Any) -> tuple[Ints, Ints]:
    """Return both as int64, or raise InvalidValue unless 0 <= solved <= runs and runs >= 1 everywhere."""
    successes, trials = as_counts("solved", solved), as_counts("runs", runs)
    if np.any(trials < 1):
        raise InvalidValue(f"runs must be >= 1, got {runs!r}")
    if np.any(successes > trials):
        raise InvalidValue(f"solved must be at most runs, got {solved!r} of {runs!r}")
    return successes, trials


def wilson(solved: npt.ArrayLike, runs: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return the ends of Wilson's score interval of success rates, from counts whose shapes broadcast.

    E. B. Wilson (1927), Probable inference, the law of succession, and statistical inference, J. Am. Stat. Assoc. 22,
    209-212, equation 4.
    """
    successes, trials = as_successes(solved, runs)
    rate = successes / trials
    centre = (rate + Z * Z / (2 * trials)) / (1 + Z * Z / trials)
    half = Z / (1 + Z * Z / trials) * np.sqrt(rate * (1 - rate) / trials + (Z / (2 * trials)) ** 2)
    # The formula gives exactly 0 and 1 at the ends but for rounding.
    low = np.where(successes == 0, 0.0, np.maximum(centre - half, 0.0))
    high = np.where(successes == trials, 1.0, np.minimum(centre + half, 1.0))
    return low, high


SAME = 1e-7
"""Tables whose chances differ by this share or less are equally likely: the rest is rounding."""


def fisher_exact(first: tuple[int, int], second: tuple[int, int]) -> float:
    """Return the two-sided p-value that two groups of runs, (solved, runs) each, have the same success rate.

    Given the totals, all tables that are no likelier than the one seen are counted (R. A. Fisher 1922, On the
    interpretation of chi-squared from contingency tables, J. R. Stat. Soc. 85, 87-94).
    """
    solved, runs = as_successes([first[0], second[0]], [first[1], second[1]])
    total = int(solved.sum())
    of_first = np.arange(max(0, total - int(runs[1])), min(int(runs[0]), total) + 1)
    log_ways = _log_choose(runs[0], of_first) + _log_choose(runs[1], total - of_first)
    log_chance = log_ways - _log_choose(runs.sum(), np.array(total))
    seen = log_chance[int(solved[0]) - int(of_first[0])]
    return float(min(1.0, np.exp(log_chance[log_chance <= seen + SAME]).sum()))


def _log_choose(n: int, k: Ints) -> Floats:
    ways: Floats = gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1)
    return ways


def mcnemar_exact(only_first: npt.ArrayLike, only_second: npt.ArrayLike) -> Floats:
    """Return the two-sided p-value of McNemar's exact test, from the runs that only the first or the second solved.

    Twice the smaller tail of a binomial with share 1/2; 1 where no run tells the two apart.  Q. McNemar (1947), Note on
    the sampling error of the difference between correlated proportions, Psychometrika 12, 153-157; the exact form as
    in A. Agresti (2002), Categorical Data Analysis, section 10.1.
    """
    first, second = as_counts("only_first", only_first), as_counts("only_second", only_second)
    smaller, both = np.minimum(first, second), first + second
    return np.minimum(1.0, 2.0 * bdtr(smaller.astype(np.float64), both, 0.5))


def bonett_price(only_first: int, only_second: int, pairs: int) -> Interval:
    """Return the interval of a difference of two paired success rates; counts as :func:`mcnemar_exact`.

    One is added to both counts and two to the number of pairs before Wald's formula, so that the interval has a width
    where nothing was seen.  D. G. Bonett and R. M. Price (2012), Adjusted Wald confidence interval for a difference of
    binomial proportions based on paired data, J. Educ. Behav. Stat. 37, 479-488.
    """
    if pairs < 1 or min(only_first, only_second) < 0 or only_first + only_second > pairs:
        raise InvalidValue(f"of {pairs!r} pairs, {only_first!r} and {only_second!r} cannot be told apart")
    share_first, share_second = (only_first + 1) / (pairs + 2), (only_second + 1) / (pairs + 2)
    difference = share_first - share_second
    half = Z * float(np.sqrt((share_first + share_second - difference**2) / (pairs + 2)))
    return Interval(max(-1.0, difference - half), min(1.0, difference + half), "bonett-price")


def student_interval(sums: npt.ArrayLike, runs: npt.ArrayLike, unit: str, lowest: float = -1.0) -> Interval:
    """Return the interval of ``sum(sums) / sum(runs)``, a rate or a paired difference, over units, (units,) each.

    The ratio's linearised error with Student's quantile for as many units (W. G. Cochran 1977, Sampling Techniques,
    section 6.4).  It needs no more than two units, but has no width where all units say the same; with one it is all
    that is possible, from `lowest` to 1.
    """
    ratio, error, units = _ratio_and_error(sums, runs)
    kind = f"student over {unit}"
    if units < 2:
        return Interval(lowest, 1.0, kind)
    half = float(stdtrit(units - 1, UPPER)) * error
    return Interval(max(lowest, ratio - half), min(1.0, ratio + half), kind)


def student_test(sums: npt.ArrayLike, pairs: npt.ArrayLike) -> float:
    """Return the two-sided p-value that ``sum(sums) / sum(pairs)`` is 0; 1 where there is one unit only."""
    ratio, error, units = _ratio_and_error(sums, pairs)
    if units < 2 or ratio == 0.0:
        return 1.0
    return 0.0 if error == 0.0 else float(2.0 * stdtr(units - 1, -abs(ratio) / error))


def _ratio_and_error(sums: npt.ArrayLike, runs: npt.ArrayLike) -> tuple[float, float, int]:
    """Return the ratio, its standard error (NaN for one unit) and the number of units."""
    above, below = np.asarray(sums, dtype=np.float64), as_counts("runs", runs)
    if above.ndim != 1 or above.shape != below.shape or len(above) == 0 or np.any(below < 1):
        raise InvalidValue(f"sums and runs must be of one length, with runs >= 1, got {sums!r}, {runs!r}")
    units, total = len(above), float(below.sum())
    ratio = float(above.sum()) / total
    if units < 2:
        return ratio, float("nan"), units
    squares = float(((above - ratio * below) ** 2).sum())
    return ratio, float(np.sqrt(squares * units / (units - 1))) / total, units


def holm(p_values: npt.ArrayLike) -> Floats:
    """Return p-values, (m,) in [0, 1], corrected so that all of a family may be read at one level.

    The i-th smallest of m (from 0) is multiplied by m - i; none falls below a smaller one's, none exceeds 1 (S. Holm
    1979, A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6, 65-70).
    """
    values = np.asarray(p_values, dtype=np.float64)
    if values.ndim != 1 or not np.all((values >= 0) & (values <= 1)):
        raise InvalidValue(f"p-values must be a list of numbers in [0, 1], got {p_values!r}")
    order = np.argsort(values, kind="stable")
    steps = values[order] * np.arange(len(values), 0, -1)
    corrected = np.empty_like(values)
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return corrected
