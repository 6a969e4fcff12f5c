"""Sets of a pool against runs that are independent: how many runs they are worth, interval and test."""

from __future__ import annotations

import math

import numpy.typing as npt
from scipy.special import ndtri, stdtrit

from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import as_successes, require_share
from evenroad.research.statistics.fisher import fisher_exact
from evenroad.research.statistics.interval import LEVEL, Interval, wilson


def effective_runs(solved: npt.ArrayLike, runs: npt.ArrayLike, *, level: float = LEVEL) -> int:
    """Return how many independent runs the runs of some units are worth.

    A rate p of variance v, estimated from the units, is as sure as p (1 - p) / v runs make it, at most all runs; fewer
    by the ratio of the normal and Student's quantile, squared.  At least as many as units, which is what units with one
    outcome each are worth; and as many as units where p is 0 or 1, as nothing is known of v: there the number jumps.

    Parameters
    ----------
    solved, runs : array_like of int, shape (units,)
        Successes and runs per unit; every unit has a run.
    level : float
        Confidence of what is made of it, in (0, 1).

    Raises
    ------
    InvalidValue
        If there is no unit, or the counts are impossible.

    References
    ----------
    E. L. Korn and B. I. Graubard (1998), Confidence intervals for proportions with small expected number of positive
    counts estimated from survey data, Survey Methodology 24, 193-201.
    """
    successes, trials = as_successes(solved, runs)
    if successes.ndim != 1 or len(successes) == 0:
        raise InvalidValue(f"counts per unit must be a list, got shape {successes.shape}")
    units, total = len(successes), int(trials.sum())
    rate = float(successes.sum()) / total
    if units == 1 or rate in (0.0, 1.0):
        return units
    variance = float(((successes - rate * trials) ** 2).sum()) * units / (units - 1) / total**2
    end = 0.5 + 0.5 * require_share("level", level)
    shrink = float(ndtri(end) / stdtrit(units - 1, end)) ** 2
    worth = min(rate * (1.0 - rate) / variance, total) if variance > 0.0 else total
    return max(math.floor(worth * shrink), units)


def sets_difference(over_sets: Interval, rate: float, solved: int, runs: int) -> Interval:
    """Return the interval of a pool's success rate minus that of independent runs.

    Parameters
    ----------
    over_sets : Interval
        Of the pool's rate.
    rate : float
        The pool's success rate.
    solved, runs : int
        Successes among independent runs.

    References
    ----------
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

    Parameters
    ----------
    solved, runs : array_like of int, shape (sets,)
        As :func:`effective_runs`.
    other_solved, other_runs : int
        Of the independent runs.
    """
    successes, trials = as_successes(solved, runs)
    rate = float(successes.sum() / trials.sum())
    return fisher_exact((round(rate * len(trials)), len(trials)), (other_solved, other_runs))
