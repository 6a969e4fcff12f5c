"""Bootstrap over independent units, and how many samples a sampler needs for a success rate."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._rng import generator
from evenroad.errors import InvalidValue
from evenroad_studies.statistics.rates import LEVEL

DRAWS = 2000
"""Resamples of every bootstrap."""
CACHED_UNITS = 1000
"""Up to so many units the resamples are kept, as they serve many cells; more would take too much memory."""
BLOCK = 50
"""Resamples at a time of more units than that."""
EXACT = 2**24
"""Whole numbers up to this are exact in single precision."""
TARGET = 0.9
"""Success rate that the samples needed are asked for."""


def resampled_ratios(numerators: npt.ArrayLike, denominators: npt.ArrayLike, *, draws: int = DRAWS) -> Floats:
    """Return the bootstrap distribution of ``sum(numerators) / sum(denominators)`` over units, (draws,) or (draws, m).

    Both are (units,) or (units, m), denominators >= 0 with a positive sum; a resample whose denominators are 0 has the
    ratio of all units.  With solved and runs per unit the ratio is a success rate; with the differences of two
    samplers' solved runs and the pairs it is the paired difference of their rates.  The m columns are resampled
    together, and the same number of units always has the same resamples, so that samplers are compared on equal ones.
    B. Efron and R. J. Tibshirani (1993), An Introduction to the Bootstrap, sections 6.4 and 8.3.
    """
    above = np.asarray(numerators, dtype=np.float64)
    below = np.asarray(denominators, dtype=np.float64)
    if above.ndim not in (1, 2) or above.shape != below.shape or len(above) == 0:
        raise InvalidValue(f"a bootstrap needs lists of one length >= 1, got {above.shape}, {below.shape}")
    finite = np.all(np.isfinite(above)) and np.all(np.isfinite(below))
    if not finite or np.any(below < 0) or np.any(below.sum(axis=0) <= 0):
        raise InvalidValue("a bootstrap needs finite numbers, and denominators >= 0 with a positive sum")
    if len(above) <= CACHED_UNITS:
        return _ratios(_cached_weights(len(above), draws), above, below)
    rng = generator(0)
    blocks = range(0, draws, BLOCK)
    return np.concatenate(
        [_ratios(_weights(len(above), min(BLOCK, draws - begin), rng), above, below) for begin in blocks]
    )


def percentile_interval(values: npt.ArrayLike) -> tuple[float, float]:
    """Return the ends of the central 95 % of bootstrap values, themselves among the values, which may be infinite."""
    tail = 0.5 * (1.0 - LEVEL)
    ordered = np.sort(np.asarray(values, dtype=np.float64))
    last = len(ordered) - 1
    return float(ordered[math.floor(tail * last)]), float(ordered[math.ceil((1.0 - tail) * last)])


def _ratios(weights: npt.NDArray[np.float32], above: Floats, below: Floats) -> Floats:
    sums = _sums(weights, above)
    of_all = below.sum(axis=0)
    if np.all(below == below[0]):
        # Every resample has as many units as there are, so its denominator is that of all.
        return sums / of_all
    totals = _sums(weights, below)
    return np.where(totals > 0, sums / np.where(totals > 0, totals, 1.0), above.sum(axis=0) / of_all)


def _sums(weights: npt.NDArray[np.float32], values: Floats) -> Floats:
    """Return weighted sums over units, in single precision where that is exact: it takes a third of the time."""
    exact = np.all(values == np.trunc(values)) and np.abs(values).max() * len(values) < EXACT
    single = weights @ values.astype(np.float32) if exact else weights.astype(np.float64) @ values
    sums: Floats = single.astype(np.float64)
    return sums


@lru_cache(maxsize=8)
def _cached_weights(units: int, draws: int) -> npt.NDArray[np.float32]:
    """Return the weights of all resamples: one matrix serves a whole table, whose cells have the same units."""
    weights = _weights(units, draws, generator(0))
    weights.setflags(write=False)
    return weights


def _weights(units: int, draws: int, rng: np.random.Generator) -> npt.NDArray[np.float32]:
    """Return how often each unit occurs in each resample, (draws, units)."""
    chosen = rng.integers(0, units, size=(draws, units))
    chosen += units * np.arange(draws)[:, np.newaxis]
    return np.bincount(chosen.ravel(), minlength=draws * units).reshape(draws, units).astype(np.float32)


UNKNOWN_INTERVAL = "[–]"
"""What stands for an interval that is not known."""


@dataclass(frozen=True)
class SamplesNeeded:
    """Samples at which a success rate reaches 90 %, of those between `smallest` and `largest` that were tried.

    Of the number and its interval ``inf`` is beyond `largest`, ``-inf`` is at or below `smallest`; NaN are the ends of
    an interval that is not known.
    """

    estimate: float
    low: float
    high: float
    smallest: int
    largest: int

    def __str__(self) -> str:
        """``412 [380, 455]``, ``> 1024``, ``≤ 32 [≤ 32, 40]``, or ``412 [–]`` where the interval is not known."""
        if not self.has_interval:
            return f"{self.short} {UNKNOWN_INTERVAL}"
        ends = self._text(self.low), self._text(self.high)
        return self.short if ends == (self.short, self.short) else f"{self.short} [{ends[0]}, {ends[1]}]"

    @property
    def has_interval(self) -> bool:
        """Whether it is known how sure the number is."""
        return not math.isnan(self.low)

    @property
    def short(self) -> str:
        """The number without its interval: ``412``, ``> 1024``, ``≤ 32``."""
        return self._text(self.estimate)

    def _text(self, value: float) -> str:
        if math.isinf(value):
            return f"> {self.largest}" if value > 0 else f"≤ {self.smallest}"
        return f"{value:.0f}"


def samples_needed(
    counts: Sequence[int], rates: npt.ArrayLike, resampled: npt.ArrayLike | None, runs: npt.ArrayLike
) -> SamplesNeeded:
    """Return where success rates, (m,), at ascending numbers of samples reach 90 %.

    The rates are first made monotone (isotonic regression weighted by `runs`, (m,): the least change that never falls;
    R. E. Barlow et al. 1972, Statistical Inference under Order Restrictions, the max-min formula), then joined by
    straight lines over log N.  The interval is of the same number in `resampled` rates, (draws, m); None: none.
    """
    tried = np.asarray(counts, dtype=np.float64)
    rate_rows = np.asarray(rates, dtype=np.float64)[np.newaxis]
    weights = np.asarray(runs, dtype=np.float64)
    if len(tried) == 0 or np.any(np.diff(tried) <= 0) or tried[0] < 1:
        raise InvalidValue(f"numbers of samples must ascend from 1 or more, got {counts!r}")
    if rate_rows.shape[1:] != tried.shape or weights.shape != tried.shape:
        raise InvalidValue(f"{len(tried)} numbers of samples need as many rates and runs")
    estimate = float(_crossing(tried, _isotonic(rate_rows, weights))[0])
    low = high = math.nan
    if resampled is not None:
        resample_rows = np.asarray(resampled, dtype=np.float64)
        if resample_rows.ndim != 2 or resample_rows.shape[1] != len(tried) or len(resample_rows) == 0:
            raise InvalidValue(f"resamples must have shape (draws, {len(tried)}), got {resample_rows.shape}")
        low, high = percentile_interval(_crossing(tried, _isotonic(resample_rows, weights)))
        # A percentile bootstrap of a kinked function may leave its own estimate out; the interval never does.
        low, high = min(low, estimate), max(high, estimate)
    return SamplesNeeded(estimate, low, high, int(tried[0]), int(tried[-1]))


def _isotonic(rates: Floats, weights: Floats) -> Floats:
    """Return rows made non-decreasing: entry j is the max over i <= j of the min over k >= j of the mean of i..k."""
    m = rates.shape[1]
    total = np.concatenate([[0.0], np.cumsum(weights)])
    sums = np.concatenate([np.zeros((len(rates), 1)), np.cumsum(rates * weights, axis=1)], axis=1)
    result = np.full(rates.shape, -np.inf)
    for i in range(m):
        means = (sums[:, i + 1 :] - sums[:, i : i + 1]) / (total[i + 1 :] - total[i])
        smallest_from = np.minimum.accumulate(means[:, ::-1], axis=1)[:, ::-1]
        result[:, i:] = np.maximum(result[:, i:], smallest_from)
    return result


def _crossing(counts: Floats, rates: Floats) -> Floats:
    """Return for every row of non-decreasing rates where it first reaches 90 %, linear in log N between counts."""
    reached = rates >= TARGET - 1e-12
    first = np.where(reached.any(axis=1), np.argmax(reached, axis=1), len(counts))
    rows = np.arange(len(rates))
    upper = np.clip(first, 1, len(counts) - 1) if len(counts) > 1 else np.zeros_like(first)
    lower = np.maximum(upper - 1, 0)
    rise = rates[rows, upper] - rates[rows, lower]
    part = np.clip((TARGET - rates[rows, lower]) / np.where(rise > 0, rise, 1.0), 0.0, 1.0)
    logs = np.log(counts)
    between = np.exp(logs[lower] + part * (logs[upper] - logs[lower]))
    return np.where(first == 0, -np.inf, np.where(first == len(counts), np.inf, between))
