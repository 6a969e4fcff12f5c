import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from evenroad.errors import InvalidValue
from evenroad_studies.statistics.rates import bonett_price, fisher_exact, holm, mcnemar_exact, wilson
from evenroad_studies.statistics.units import spread_over_sets
from tests.refused import refused

counts = st.integers(1, 400).flatmap(lambda runs: st.tuples(st.integers(0, runs), st.just(runs)))


@given(counts)
def test_wilson_agrees_with_scipy(counted):
    solved, runs = counted
    theirs = stats.binomtest(solved, runs).proportion_ci(method="wilson")
    assert np.array(wilson(solved, runs)) == pytest.approx(np.array(theirs), abs=1e-12)


def test_wilson_takes_whole_tables_at_once():
    low, high = wilson([[0, 5], [10, 3]], 10)
    assert low.shape == high.shape == (2, 2)
    assert (low[0, 0], high[1, 0]) == (0.0, 1.0)
    assert low[1, 1] == wilson(3, 10)[0]


@pytest.mark.parametrize(("solved", "runs"), [(-1, 5), (6, 5), (0, 0), (0.5, 3), (math.nan, 3)])
def test_impossible_counts_are_refused(solved, runs):
    refused(InvalidValue, "", wilson, solved, runs)


@given(st.integers(0, 60), st.integers(0, 60))
def test_mcnemar_agrees_with_scipy(first, second):
    theirs = stats.binomtest(first, first + second).pvalue if first + second else 1.0
    assert mcnemar_exact(first, second) == pytest.approx(theirs, rel=1e-9)
    table = np.array([first, 0, second, 200])
    assert mcnemar_exact(table, table[::-1])[0] == mcnemar_exact(first, 200)


def test_the_paired_interval_is_the_published_formula_and_takes_no_more_pairs_than_there_are():
    """Worked by hand: 9 and 1 of 50 pairs give (10 - 2) / 52 +- 1.96 sqrt((12 / 52 - (8 / 52)^2) / 52)."""
    interval = bonett_price(9, 1, 50)
    half = 1.959963985 * math.sqrt((12 / 52 - (8 / 52) ** 2) / 52)
    assert (interval.low, interval.high) == pytest.approx((8 / 52 - half, 8 / 52 + half))
    refused(InvalidValue, "pairs", bonett_price, 6, 5, 10)


def test_the_paired_interval_covers_the_truth_about_95_times_in_100():
    rng = np.random.default_rng(1)
    only_first, only_second, pairs = 0.15, 0.05, 60
    tables = rng.multinomial(pairs, [only_first, only_second, 1 - only_first - only_second], size=2000)
    intervals = [bonett_price(int(b), int(c), pairs) for b, c, _ in tables]
    covered = np.mean([each.low <= only_first - only_second <= each.high for each in intervals])
    assert 0.93 <= covered <= 0.975


@given(counts, counts)
def test_fisher_agrees_with_scipy(first, second):
    table = [[first[0], second[0]], [first[1] - first[0], second[1] - second[0]]]
    assert fisher_exact(first, second) == pytest.approx(stats.fisher_exact(table).pvalue, rel=1e-6, abs=1e-12)


def test_fisher_reproduces_published_comparisons_and_takes_large_benchmarks():
    assert fisher_exact((9330, 10_000), (933, 1000)) == pytest.approx(1.0)
    assert 0 < fisher_exact((5280, 10_000), (400, 1000)) < 1e-12
    """Table 1 of Chahine et al.: MPMC 40 of 50 against Halton's 28, and 50 of 50 against uniform's 44."""
    assert fisher_exact((40, 50), (28, 50)) == pytest.approx(0.018, abs=5e-4)
    assert fisher_exact((50, 50), (44, 50)) == pytest.approx(0.027, abs=5e-4)


def _holm_step_by_step(values):
    order = sorted(range(len(values)), key=lambda i: values[i])
    corrected, largest = [0.0] * len(values), 0.0
    for place, i in enumerate(order):
        largest = max(largest, min(1.0, (len(values) - place) * values[i]))
        corrected[i] = largest
    return corrected


@given(st.lists(st.floats(0, 1), max_size=30))
def test_holm_is_the_step_down_procedure(values):
    assert holm(values) == pytest.approx(_holm_step_by_step(values))


@pytest.mark.parametrize("values", [[math.nan], [1.5], [-0.1], [[0.5]]])
def test_holm_refuses_what_is_no_p_value(values):
    refused(InvalidValue, "p-values", holm, values)


def test_spread_over_sets_of_a_worked_example():
    spread = spread_over_sets([10, 0, 5], [10, 10, 10])
    assert (spread.mean, spread.lowest, spread.highest) == (0.5, 0.0, 1.0)
    assert spread.sd == pytest.approx(0.5)
    assert spread.sd_by_chance == pytest.approx(math.sqrt(0.25 / 10))


def test_sets_that_are_alike_spread_as_chance_says():
    rng = np.random.default_rng(3)
    runs = np.full(4000, 12)
    spread = spread_over_sets(rng.binomial(runs, 0.4), runs)
    assert spread.sd == pytest.approx(spread.sd_by_chance, rel=0.05)


def test_one_set_has_no_spread():
    assert spread_over_sets([3], [4]).sd == 0.0
    refused(InvalidValue, "", spread_over_sets, [], [])
