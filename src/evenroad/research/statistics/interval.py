"""Interval of a success rate, and Wilson's formula for independent runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import ndtri

from evenroad.research.statistics._counts import as_successes, require_share

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


def wilson(
    solved: npt.ArrayLike, runs: npt.ArrayLike, *, level: float = LEVEL
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return Wilson's score interval of success rates from independent runs.

    Parameters
    ----------
    solved, runs : array_like of int
        Successes and runs, of shapes that broadcast; runs >= 1.
    level : float
        Confidence, in (0, 1).

    Returns
    -------
    low, high : ndarray of float64
        Ends, in [0, 1].

    Raises
    ------
    InvalidValue
        If a count is negative, not whole, or ``solved > runs``.

    References
    ----------
    E. B. Wilson (1927), Probable inference, the law of succession, and statistical inference, J. Am. Stat. Assoc.
    22, 209-212, equation 4.
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
