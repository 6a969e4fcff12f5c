"""Sets of a pool: what their runs are worth, and how they are held against independent runs."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad_studies.statistics.rates import Interval, fisher_exact, wilson
from evenroad_studies.statistics.units import clustered_rate, effective_runs, sets_difference, sets_test


@pytest.mark.parametrize("sets", [4, 16, 40])
def test_sets_with_one_outcome_each_are_worth_as_many_runs(sets):
    solved = 25 * (np.arange(sets) % 4 == 0)
    assert effective_runs(solved, np.full(sets, 25)) == sets
    assert effective_runs(np.zeros(sets, dtype=int), np.full(sets, 25)) == sets


def test_runs_of_sets_that_are_all_alike_are_worth_nearly_all():
    rng = np.random.default_rng(2)
    worth = [effective_runs(rng.binomial(20, 0.4, 30), np.full(30, 20)) for _ in range(200)]
    assert 450 < np.median(worth) < 600
    assert max(worth) <= 600


def test_worked_examples_of_effective_runs():
    """Rates .2, .4, .6: v = .08 / 2 / 3, .24 / v = 18, (1.960 / 4.303)^2 of them 3.7; six rates: v = .04 / 5 / 6."""
    assert effective_runs([2, 4, 6], [10, 10, 10]) == 3
    assert effective_runs([15, 20, 25, 15, 20, 25], [50] * 6) == int(180 * (1.959964 / 2.570582) ** 2)


def test_sets_that_agree_exactly_are_worth_what_sets_are_that_nearly_agree():
    exactly, nearly = effective_runs([50] * 4, [100] * 4), effective_runs([50, 51, 50, 49], [100] * 4)
    assert exactly == nearly == int(400 * (1.959964 / 3.182446) ** 2)
    assert effective_runs([7], [10]) == 1


@pytest.mark.parametrize("chance", [0.05, 0.23, 0.6])
def test_the_test_of_whole_sets_rejects_no_more_than_five_in_a_hundred(chance):
    rng = np.random.default_rng(4)
    rejected = 0
    for _ in range(400):
        solved = 25 * (rng.random(16) < chance)
        rejected += sets_test(solved, np.full(16, 25), int(rng.binomial(400, chance)), 400) < 0.05
    assert rejected <= 0.06 * 400


@pytest.mark.parametrize("alike", [0.1, 0.67, 5.0])
@pytest.mark.parametrize("sets", [6, 16, 64])
def test_the_test_of_sets_seldom_rejects_at_the_levels_of_holms_correction(sets, alike):
    rng = np.random.default_rng(7)
    runs = np.full(sets, 400 // sets)
    rejected = 0
    for _ in range(400):
        solved = rng.binomial(runs, rng.beta(0.9 * alike, 0.1 * alike, sets))
        rejected += sets_test(solved, runs, int(rng.binomial(400, 0.9)), 400) < 0.0007
    assert rejected <= 4


def test_whole_sets_are_tested_as_single_runs():
    assert sets_test([25, 0, 0, 25, 0, 0], [25] * 6, 120, 150) == fisher_exact((2, 6), (120, 150))


def test_the_difference_of_sets_and_runs_is_newcombes_interval():
    over_sets = Interval(0.0, 0.19, "wilson over sets")
    interval = sets_difference(over_sets, 0.0, 92, 400)
    low, high = wilson(92, 400)
    assert interval.low == pytest.approx(-0.23 - (high - 0.23))
    assert interval.high == pytest.approx(-0.23 + np.hypot(0.19, 0.23 - low))
    assert interval.kind == "newcombe over sets"


@pytest.mark.parametrize(("solved", "sets"), [([5] * 16, 16), ([0] * 12, 12), ([5, 0, 3], 3)])
def test_sets_that_are_worth_no_more_are_counted_as_runs(solved, sets):
    interval = clustered_rate(solved, [5] * len(solved), "sets")
    rate = sum(solved) / (5 * sets)
    low, high = wilson(math.floor(rate * sets), sets)[0], wilson(math.ceil(rate * sets), sets)[1]
    assert (interval.low, interval.high, interval.kind) == (low, high, "wilson over sets")
    assert interval.low <= rate <= interval.high


@pytest.mark.parametrize("chance", [0.05, 0.2, 0.5])
@pytest.mark.parametrize(("sets", "alike"), [(8, 20.0), (16, 0.02), (32, 5.0)])
def test_an_interval_over_few_sets_covers_the_familys_rate(chance, sets, alike):
    rng = np.random.default_rng(6)
    runs = np.full(sets, 400 // sets)
    covered = 0
    for _ in range(300):
        of_set = rng.beta(chance * alike, (1 - chance) * alike, sets)
        interval = clustered_rate(rng.binomial(runs, of_set), runs, "sets")
        covered += interval.low <= chance <= interval.high
    assert 0.91 <= covered / 300 <= 0.99


@pytest.mark.parametrize(("solved", "runs"), [([3], [2]), ([], []), ([[1]], [[2]])])
def test_impossible_counts_of_sets_are_refused(solved, runs):
    with pytest.raises(InvalidValue):
        clustered_rate(solved, runs, "sets")
