"""Success rates of independent runs: counts, intervals, the comparison of two groups, and many tests at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln, ndtri

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue

LEVEL = 0.95
"""Confidence of every interval unless asked otherwise."""


@dataclass(frozen=True)
class Interval:
    """A confidence interval and how it was made.

    Attributes
    ----------
    low, high : float
        Ends, as shares in [0, 1] (of a difference: in [-1, 1]).
    kind : str
        ``wilson``, of paired differences ``bonett-price``, where runs are independent.  Where they come in units
        (sets, blocks or instances): ``wilson over sets``, of differences ``paired bootstrap over instances``, with few
        or equal ones ``bonett-price over instances``; ``student over sets``; of sets against independent runs
        ``newcombe over sets``.
    """

    low: float
    high: float
    kind: str

    def or_wider(self, other: Interval) -> Interval:
        """Return the wider of the two, this one where they are alike."""
        return other if other.high - other.low > self.high - self.low else self


def wilson(solved: npt.ArrayLike, runs: npt.ArrayLike, *, level: float = LEVEL) -> tuple[Floats, Floats]:
    """Return the ends in [0, 1] of Wilson's score interval of success rates from independent runs.

    E. B. Wilson (1927), Probable inference, the law of succession, and statistical inference, J. Am. Stat. Assoc. 22,
    209-212, equation 4.

    Parameters
    ----------
    solved, runs : array_like of int
        Successes and runs >= 1, of shapes that broadcast; InvalidValue for a count that is negative or not whole, and
        where ``solved > runs``.
    level : float
        Confidence, in (0, 1).
    """
    successes, trials = as_successes(solved, runs)
    z = float(ndtri(0.5 + 0.5 * require_share("level", level)))
    rate = successes / trials
    centre = (rate + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z / (1 + z * z / trials) * np.sqrt(rate * (1 - rate) / trials + (z / (2 * trials)) ** 2)
    # The formula gives exactly 0 and 1 at the ends but for rounding.
    low = np.where(successes == 0, 0.0, np.maximum(centre - half, 0.0))
    high = np.where(successes == trials, 1.0, np.minimum(centre + half, 1.0))
    return low, high


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


def require_share(name: str, value: float) -> float:
    """Return a share strictly between 0 and 1, or raise InvalidValue."""
    if not 0.0 < value < 1.0:
        raise InvalidValue(f"{name} must be between 0 and 1, both excluded, got {value!r}")
    return float(value)


SAME = 1e-7
"""Tables whose chances differ by this share or less are equally likely: the rest is rounding."""


def fisher_exact(first: tuple[int, int], second: tuple[int, int]) -> float:
    """Return the two-sided p-value that two groups of runs, (solved, runs) each, have the same success rate.

    Given the totals, all tables that are no likelier than the one seen are counted (R. A. Fisher 1922, On the
    interpretation of chi-squared from contingency tables, J. R. Stat. Soc. 85, 87-94).  Raises InvalidValue if a pair
    is not one of counts with ``0 <= solved <= runs``, runs >= 1.
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


def _log_choose(n: int, k: Ints) -> Floats:
    ways: Floats = gammaln(n + 1) - gammaln(k + 1) - gammaln(n - k + 1)
    return ways


def holm(p_values: npt.ArrayLike) -> Floats:
    """Return p-values, (m,) in [0, 1], corrected so that all of a family may be read at one level.

    The i-th smallest of m (from 0) is multiplied by m - i; none falls below a smaller one's, none exceeds 1 (S. Holm
    1979, A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6, 65-70). m may be 0.  Raises
    InvalidValue if a value is not in [0, 1] (NaN included).
    """
    values = np.asarray(p_values, dtype=np.float64)
    if values.ndim != 1 or not np.all((values >= 0) & (values <= 1)):
        raise InvalidValue(f"p-values must be a list of numbers in [0, 1], got {p_values!r}")
    order = np.argsort(values, kind="stable")
    steps = values[order] * np.arange(len(values), 0, -1)
    corrected = np.empty_like(values)
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(steps))
    return corrected
