"""Runs that are not independent: those of one trained set, or of one random world.

A pool of 64 sets that is drawn from 400 times does not give 400 independent runs: on a fixed problem the same set
gives much the same answer every time.  Only the sets are independent of each other, as in a suite of random worlds
only the worlds are.  Such sets and worlds are called units here; counts per unit are arrays (units,), and `unit` says
what one is, in the plural, for `Interval.kind`: ``sets``, ``blocks`` or ``instances``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.special import gammaln, stdtrit

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue
from evenroad_studies.statistics.rates import (
    UPPER,
    Interval,
    Z,
    as_counts,
    as_successes,
    bonett_price,
    fisher_exact,
    student_interval,
    wilson,
)
from evenroad_studies.statistics.resampling import percentile_interval, resampled_ratios

FEW_UNITS = 10
"""With fewer units than this a bootstrap is too narrow."""
MANY_UNITS = 1000
"""With more units than this a bootstrap of a difference says what Student's interval says."""
SHORT = 4000
"""Below this, adding zeros up takes less time than leaving them out one by one."""


def clustered_rate(solved: npt.ArrayLike, runs: npt.ArrayLike, unit: str) -> Interval:
    """Return Wilson's interval for as many runs as those of the units are worth (:func:`effective_runs`).

    A bootstrap over so few units as a pool has sets would be too narrow, most where few of them solve.
    """
    successes, trials = _per_unit(solved, runs)
    worth = effective_runs(successes, trials)
    rate = float(successes.sum() / trials.sum())
    # Between two counts the wider ends of both are taken.
    low, _ = wilson(math.floor(rate * worth), worth)
    _, high = wilson(math.ceil(rate * worth), worth)
    return Interval(float(low), float(high), f"wilson over {unit}")


def _per_unit(solved: npt.ArrayLike, runs: npt.ArrayLike) -> tuple[Ints, Ints]:
    """Return successes and runs per unit, or raise InvalidValue if they are impossible or there is no unit."""
    successes, trials = as_successes(solved, runs)
    if successes.ndim != 1 or len(successes) == 0:
        raise InvalidValue(f"counts per unit must be a list, got shape {successes.shape}")
    return successes, trials


def clustered_difference(sums: npt.ArrayLike, pairs: npt.ArrayLike, unit: str) -> Interval:
    """Return the interval of a paired difference of success rates, by a bootstrap over units.

    With more than 1000 units, where a bootstrap takes long and says the same, :func:`student_interval`; with fewer
    than 10, or where all units say the same, the interval of Bonett and Price for as many pairs as there are units.
    `sums` are the runs of a unit that only the first solved, minus those that only the second solved.
    """
    differences, totals = np.asarray(sums), as_counts("pairs", pairs)
    if differences.ndim != 1 or differences.shape != totals.shape or len(totals) == 0:
        raise InvalidValue(f"sums and pairs must be of one length, got {differences.shape}, {totals.shape}")
    if np.any(totals < 1) or np.any(np.abs(differences) > totals):
        raise InvalidValue("a unit has at least one pair, and as many pairs as its sum")
    ratios = differences / totals
    if len(ratios) < FEW_UNITS or np.all(ratios == ratios[0]):
        return _as_if_one_pair_a_unit(differences / totals.sum(), unit)
    if len(ratios) > MANY_UNITS:
        return student_interval(differences, totals, unit)
    values = resampled_ratios(differences, totals)
    return Interval(*percentile_interval(values), f"paired bootstrap over {unit}")


def _as_if_one_pair_a_unit(shares: Floats, unit: str) -> Interval:
    """Return Bonett and Price's interval for as many pairs as units; `shares` add up to the difference."""
    units = len(shares)
    wins, losses = (units * float(np.maximum(sign * shares, 0.0).sum()) for sign in (1, -1))
    # Rounded to whole units; the difference that was seen is always inside.
    rounded = bonett_price(round(wins), min(round(losses), units - round(wins)), units)
    seen = (wins - losses) / units
    return Interval(min(rounded.low, seen), max(rounded.high, seen), f"bonett-price over {unit}")


def sign_flip_test(sums: npt.ArrayLike) -> float:
    """Return the two-sided p-value that units' differences are as likely to have either sign (Fisher 1935, section 21).

    The exact distribution of ``|sum of ±s_u|`` over all choices of signs, of the `sums` of
    :func:`clustered_difference`.  With one pair a unit (all s_u are -1, 0 or 1) this is McNemar's exact test; with
    more it keeps the pairs of a unit together.  Exact where the two samplers are exchangeable inside a unit, which
    holds for draws in one random world; for runs of a pool's sets it is the usual large-sample test of a mean.
    """
    values = np.asarray(sums)
    if values.ndim != 1 or np.any(values != np.trunc(values)):
        raise InvalidValue(f"sums per unit must be a list of whole numbers, got {sums!r}")
    observed = abs(int(values.sum()))
    sizes, units_of_size = np.unique(np.abs(values[values != 0]).astype(np.int64), return_counts=True)
    # chance[i] is the probability that the signed sum is i - (len(chance) - 1) / 2; the largest groups come first, as
    # each one's shares are added up one by one.
    chance = np.ones(1)
    for place in np.argsort(-units_of_size, kind="stable"):
        count, stride = int(units_of_size[place]), 2 * int(sizes[place])
        heads = np.arange(count + 1)
        log_ways = gammaln(count + 1) - gammaln(heads + 1) - gammaln(count - heads + 1)
        shares = np.exp(log_ways - count * np.log(2.0))
        if len(chance) * stride < SHORT:
            spread = np.zeros(stride * count + 1)
            spread[::stride] = shares
            chance = np.convolve(chance, spread)
        else:
            together = np.zeros(len(chance) + stride * count)
            for head, share in enumerate(shares):
                together[head * stride : head * stride + len(chance)] += share * chance
            chance = together
    reach = (len(chance) - 1) // 2
    total = np.abs(np.arange(-reach, reach + 1)) >= observed
    return float(min(1.0, chance[total].sum()))


def effective_runs(solved: npt.ArrayLike, runs: npt.ArrayLike) -> int:
    """Return how many independent runs the runs of some units are worth.

    A rate p of variance v, estimated from the units, is as sure as p (1 - p) / v runs make it, at most all runs; fewer
    by the ratio of the normal and Student's quantile, squared.  At least as many as units, which is what units with one
    outcome each are worth; and as many as units where p is 0 or 1, as nothing is known of v: there the number jumps.

    E. L. Korn and B. I. Graubard (1998), Confidence intervals for proportions with small expected number of positive
    counts estimated from survey data, Survey Methodology 24, 193-201.
    """
    successes, trials = _per_unit(solved, runs)
    units, total = len(successes), int(trials.sum())
    rate = float(successes.sum()) / total
    if units == 1 or rate in (0.0, 1.0):
        return units
    variance = float(((successes - rate * trials) ** 2).sum()) * units / (units - 1) / total**2
    shrink = float(Z / stdtrit(units - 1, UPPER)) ** 2
    worth = min(rate * (1.0 - rate) / variance, total) if variance > 0.0 else total
    return max(math.floor(worth * shrink), units)


def sets_difference(over_sets: Interval, rate: float, solved: int, runs: int) -> Interval:
    """Return the interval of a pool's success `rate`, with the interval `over_sets`, minus that of independent runs.

    R. G. Newcombe (1998), Interval estimation for the difference between independent proportions, Statistics in
    Medicine 17, 873-890, method 10.
    """
    low, high = (float(end) for end in wilson(solved, runs))
    other = solved / runs
    below = math.hypot(rate - over_sets.low, high - other)
    above = math.hypot(over_sets.high - rate, other - low)
    difference = rate - other
    return Interval(max(-1.0, difference - below), min(1.0, difference + above), "newcombe over sets")


def sets_test(solved: npt.ArrayLike, runs: npt.ArrayLike, other_solved: int, other_runs: int) -> float:
    """Return the p-value that a pool solves as often as independent runs of another sampler do.

    Fisher's exact test, with one outcome a set: the pool's rate times its sets, rounded.  Less would be claimed where
    runs of a set are nearly independent, but how nearly is not known well enough from a few sets.  No sign flips: one
    outcome a set against the other's rate is skewed, and flips reject too often.
    """
    successes, trials = _per_unit(solved, runs)
    rate = float(successes.sum() / trials.sum())
    return fisher_exact((round(rate * len(trials)), len(trials)), (other_solved, other_runs))


class Spread(NamedTuple):
    """Success rates of single sets of a pool, each set with the same weight.

    `sd` is their standard deviation (n - 1 below; 0 for one set), and `sd_by_chance` what it would be if all sets were
    alike, by the binomial noise of so few runs a set.
    """

    mean: float
    lowest: float
    highest: float
    sd: float
    sd_by_chance: float


def spread_over_sets(solved: npt.ArrayLike, runs: npt.ArrayLike) -> Spread:
    """Return the spread over the sets of a pool."""
    successes, trials = _per_unit(solved, runs)
    rates = successes / trials
    overall = successes.sum() / trials.sum()
    return Spread(
        mean=float(rates.mean()),
        lowest=float(rates.min()),
        highest=float(rates.max()),
        sd=float(rates.std(ddof=1)) if len(rates) > 1 else 0.0,
        sd_by_chance=float(np.sqrt(overall * (1.0 - overall) * np.mean(1.0 / trials))),
    )
