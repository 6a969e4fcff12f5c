"""Bootstrap of a ratio of two sums over units: success rates, and paired differences of them."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad._rng import generator
from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import require_share
from evenroad.research.statistics.interval import LEVEL

DRAWS = 2000
"""Resamples of every bootstrap unless asked otherwise."""
CACHED_UNITS = 1000
"""Up to so many units the resamples are kept, as they serve many cells; more would take too much memory."""
BLOCK = 50
"""Resamples at a time of more units than that."""
EXACT = 2**24
"""Whole numbers up to this are exact in single precision."""


def resampled_ratios(
    numerators: npt.ArrayLike, denominators: npt.ArrayLike, *, draws: int = DRAWS, seed: int = 0
) -> npt.NDArray[np.float64]:
    """Return the bootstrap distribution of ``sum(numerators) / sum(denominators)`` over units.

    Units are what is independent: runs, sets or instances.  With solved and runs per unit the ratio is a success
    rate; with the differences of two samplers' solved runs and the pairs it is the paired difference of their
    rates (both samplers keep the same units in a resample: that is the pairing).

    Parameters
    ----------
    numerators, denominators : array_like, shape (units,) or (units, m)
        Per unit; denominators >= 0, with a positive sum.  The m columns are resampled together: a unit that a resample
        has twice counts twice in each.
    draws : int
        Number of resamples.
    seed : int
        The same seed and number of units give the same resamples, so that samplers are compared on equal ones.

    Returns
    -------
    ndarray, shape (draws,) or (draws, m)
        The ratio of all units where a resample's denominators are 0.

    Raises
    ------
    InvalidValue
        If there is no unit, the shapes differ, or the denominators of a column have no positive sum.

    References
    ----------
    B. Efron and R. J. Tibshirani (1993), An Introduction to the Bootstrap, sections 6.4 and 8.3.
    """
    above = np.asarray(numerators, dtype=np.float64)
    below = np.asarray(denominators, dtype=np.float64)
    if above.ndim not in (1, 2) or above.shape != below.shape or len(above) == 0:
        raise InvalidValue(
            f"a bootstrap needs two lists of one length >= 1, got {above.shape}, {below.shape}"
        )
    finite = np.all(np.isfinite(above)) and np.all(np.isfinite(below))
    if not finite or np.any(below < 0) or np.any(below.sum(axis=0) <= 0):
        raise InvalidValue("a bootstrap needs finite numbers, and denominators >= 0 with a positive sum")
    draws, seed = require_count("draws", draws), require_count("seed", seed, 0)
    if len(above) <= CACHED_UNITS:
        return _ratios(_cached_weights(len(above), draws, seed), above, below)
    rng = generator(seed)
    blocks = range(0, draws, BLOCK)
    return np.concatenate(
        [_ratios(_weights(len(above), min(BLOCK, draws - begin), rng), above, below) for begin in blocks]
    )


def percentile_interval(values: npt.ArrayLike, *, level: float = LEVEL) -> tuple[float, float]:
    """Return the ends of the central share `level` of bootstrap values, themselves among the values.

    Nothing is interpolated, so infinities (a target that a resample never reached) are legal values.
    """
    tail = 0.5 * (1.0 - require_share("level", level))
    ordered = np.sort(np.asarray(values, dtype=np.float64))
    last = len(ordered) - 1
    return float(ordered[math.floor(tail * last)]), float(ordered[math.ceil((1.0 - tail) * last)])


def _ratios(
    weights: npt.NDArray[np.float32], above: npt.NDArray[np.float64], below: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    sums = _sums(weights, above)
    of_all = below.sum(axis=0)
    if np.all(below == below[0]):
        # Every resample has as many units as there are, so its denominator is that of all.
        return sums / of_all
    totals = _sums(weights, below)
    return np.where(totals > 0, sums / np.where(totals > 0, totals, 1.0), above.sum(axis=0) / of_all)


def _sums(weights: npt.NDArray[np.float32], values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return weighted sums over units, in single precision where that is exact: it takes a third of the time."""
    exact = np.all(values == np.trunc(values)) and np.abs(values).max() * len(values) < EXACT
    single = weights @ values.astype(np.float32) if exact else weights.astype(np.float64) @ values
    sums: npt.NDArray[np.float64] = single.astype(np.float64)
    return sums


@lru_cache(maxsize=8)
def _cached_weights(units: int, draws: int, seed: int) -> npt.NDArray[np.float32]:
    """Return the weights of all resamples: one matrix serves a whole table, whose cells have the same units."""
    weights = _weights(units, draws, generator(seed))
    weights.setflags(write=False)
    return weights


def _weights(units: int, draws: int, rng: np.random.Generator) -> npt.NDArray[np.float32]:
    """Return how often each unit occurs in each resample, (draws, units)."""
    chosen = rng.integers(0, units, size=(draws, units))
    chosen += units * np.arange(draws)[:, np.newaxis]
    return np.bincount(chosen.ravel(), minlength=draws * units).reshape(draws, units).astype(np.float32)
