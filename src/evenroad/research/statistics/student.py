"""Student's interval and test of a ratio of sums over units."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.special import stdtr, stdtrit

from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import as_counts, require_share
from evenroad.research.statistics.interval import LEVEL, Interval


def student_interval(
    sums: npt.ArrayLike, runs: npt.ArrayLike, unit: str, *, lowest: float = -1.0, level: float = LEVEL
) -> Interval:
    """Return the interval of ``sum(sums) / sum(runs)``, a success rate or a paired difference, over units.

    The ratio's linearised error with Student's quantile for as many units.  It needs no more than two units, but has
    no width where all units say the same, and is everything that is possible where there is one unit only.

    Parameters
    ----------
    sums, runs : array_like of int, shape (units,)
        Of a rate: successes and runs per unit, runs >= 1; of a difference: as
        :func:`~evenroad.research.statistics.clustered_difference`.
    unit : str
        What a unit is, in the plural, for `Interval.kind`.
    lowest : float
        Smallest value that is possible: 0 for a rate, -1 for a difference; the largest is 1.
    level : float
        Confidence, in (0, 1).

    Raises
    ------
    InvalidValue
        If there is no unit, the shapes differ, or a unit has no run.

    References
    ----------
    W. G. Cochran (1977), Sampling Techniques, section 6.4.
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
