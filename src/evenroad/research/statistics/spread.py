"""How much the sets of one family differ from each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.research.statistics._counts import as_successes


@dataclass(frozen=True)
class Spread:
    """Success rates of single sets of a pool.

    Attributes
    ----------
    sets : int
        Sets that were drawn at least once.
    mean, lowest, highest : float
        Of the sets' own success rates; the mean gives every set the same weight.
    sd : float
        Standard deviation over sets (n - 1 below; 0 for one set).
    sd_by_chance : float
        What it would be if all sets were alike, by the binomial noise of so few runs a set: an `sd` well above
        says that some sets are better than others on this problem.
    """

    sets: int
    mean: float
    sd: float
    lowest: float
    highest: float
    sd_by_chance: float


def spread_over_sets(solved: npt.ArrayLike, runs: npt.ArrayLike) -> Spread:
    """Return the spread of success rates over the sets of a pool.

    Parameters
    ----------
    solved, runs : array_like of int, shape (sets,)
        Successes and runs per set, runs >= 1.

    Raises
    ------
    InvalidValue
        If there is no set, or the counts are impossible.
    """
    successes, trials = as_successes(solved, runs)
    if successes.ndim != 1 or len(successes) == 0:
        raise InvalidValue(f"counts per set must be a list, got shape {successes.shape}")
    rates = successes / trials
    overall = successes.sum() / trials.sum()
    return Spread(
        sets=len(rates),
        mean=float(rates.mean()),
        sd=float(rates.std(ddof=1)) if len(rates) > 1 else 0.0,
        lowest=float(rates.min()),
        highest=float(rates.max()),
        sd_by_chance=float(np.sqrt(overall * (1.0 - overall) * np.mean(1.0 / trials))),
    )
