import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from evenroad.errors import InvalidValue
from evenroad_studies.statistics import units
from evenroad_studies.statistics.rates import Interval, mcnemar_exact, student_interval, student_test
from evenroad_studies.statistics.resampling import (
    SamplesNeeded,
    _isotonic,
    percentile_interval,
    resampled_ratios,
    samples_needed,
)
from evenroad_studies.statistics.units import clustered_difference, sign_flip_test
from tests.refused import refused


def test_a_bootstrap_resamples_whole_units():
    """With two units the ratio can only be one of three values, in shares 1/4, 1/2, 1/4."""
    values = resampled_ratios([3, 0], [3, 1], draws=4000)
    seen, times = np.unique(values, return_counts=True)
    assert seen == pytest.approx([0.0, 0.75, 1.0])
    assert times / 4000 == pytest.approx([0.25, 0.5, 0.25], abs=0.03)


def test_as_many_units_give_the_same_bits():
    first = resampled_ratios([1, 0, 1], [1, 1, 1])
    assert np.array_equal(first, resampled_ratios([1, 0, 1], [1, 1, 1]))


def test_percentiles_may_be_infinite():
    assert percentile_interval([-math.inf, 1.0, 2.0, math.inf]) == (-math.inf, math.inf)
    assert percentile_interval([3.0]) == (3.0, 3.0)


def _flip_by_counting(sums):
    flips = [
        abs(sum(s * x for s, x in zip(signs, sums, strict=True)))
        for signs in itertools.product((-1, 1), repeat=len(sums))
    ]
    return np.mean(np.array(flips) >= abs(sum(sums)))


@given(st.lists(st.integers(-5, 5), max_size=9), st.sampled_from((0, units.SHORT)))
def test_sign_flips_are_counted_exactly(sums, short):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(units, "SHORT", short)
        assert sign_flip_test(sums) == pytest.approx(_flip_by_counting(sums))


@given(st.integers(0, 300), st.integers(0, 300), st.integers(0, 50))
def test_sign_flips_of_single_pairs_are_mcnemars_test(first, second, ties):
    sums = [1] * first + [-1] * second + [0] * ties
    assert sign_flip_test(sums) == pytest.approx(float(mcnemar_exact(first, second)), rel=1e-9)


def test_sign_flips_take_whole_numbers_only():
    refused(InvalidValue, "whole", sign_flip_test, [0.5])


def test_a_paired_difference_keeps_the_pairs_of_a_unit_together():
    interval = clustered_difference([4, -4] * 10, [4] * 20, "instances")
    assert interval.kind == "paired bootstrap over instances"
    assert interval.low < 0 < interval.high
    assert interval.high == pytest.approx(1.96 / math.sqrt(20), rel=0.15)


def test_a_paired_difference_of_few_or_equal_sets_keeps_a_width():
    for sums in ([0] * 12, [5] * 12, [5, -1, 3]):
        interval = clustered_difference(sums, [5] * len(sums), "sets")
        assert interval.kind == "bonett-price over sets"
        assert interval.low <= sum(sums) / (5 * len(sums)) <= interval.high
        assert interval.high - interval.low > 0.1


def test_with_many_units_students_interval_says_what_a_bootstrap_says():
    rng = np.random.default_rng(2)
    pairs = rng.integers(1, 6, size=1500)
    sums = rng.binomial(pairs, 0.4) - rng.binomial(pairs, 0.2)
    sums = np.clip(sums, -pairs, pairs)
    interval = clustered_difference(sums, pairs, "instances")
    bootstrap = percentile_interval(resampled_ratios(sums, pairs))
    assert interval.kind == "student over instances"
    assert (interval.low, interval.high) == pytest.approx(bootstrap, abs=0.003)


def test_many_units_are_resampled_in_blocks_with_the_same_spread():
    solved = np.repeat([1, 0], [600, 900])
    values = resampled_ratios(solved, np.ones(1500), draws=1020)
    assert len(values) == 1020
    assert values.std() == pytest.approx(math.sqrt(0.4 * 0.6 / 1500), rel=0.1)


COUNTS = (32, 64, 128, 256)


def _needed(rates, draws=300, runs=400):
    rng = np.random.default_rng(0)
    resampled = rng.binomial(runs, rates, size=(draws, len(rates))) / runs
    return samples_needed(COUNTS[: len(rates)], rates, resampled, [runs] * len(rates))


def test_ninety_per_cent_lies_on_the_line_between_two_counts():
    """Half way from .85 at 64 to .95 at 128, over log N: 64 sqrt(2)."""
    needed = _needed([0.3, 0.85, 0.95, 1.0])
    assert needed.estimate == pytest.approx(64 * math.sqrt(2))
    assert 64 < needed.low < needed.estimate < needed.high < 128


@pytest.mark.parametrize(
    ("rates", "text"), [((0.1, 0.2, 0.2, 0.3), "> 256"), ((0.99, 1.0, 1.0, 1.0), "≤ 32"), ((0.1,), "> 32")]
)
def test_beyond_what_was_tried_is_an_answer(rates, text):
    assert str(_needed(rates)) == text


def test_an_interval_may_reach_beyond_what_was_tried():
    needed = _needed([0.2, 0.4, 0.8, 0.9], runs=100)
    assert needed.high == math.inf
    assert str(needed).endswith("> 256]")


def test_a_rate_that_falls_is_evened_out_first():
    """.92 then .88 with equal runs is .90 twice."""
    needed = samples_needed((32, 64, 128), [0.1, 0.92, 0.88], [[0.1, 0.92, 0.88]], [50, 50, 50])
    assert needed.estimate == pytest.approx(64.0)


@given(st.lists(st.tuples(st.floats(0, 1), st.integers(1, 9)), min_size=1, max_size=7))
def test_isotonic_rates_are_those_of_pooling_adjacent_violators(pairs):
    rates, weights = (np.array(each, dtype=float) for each in zip(*pairs, strict=True))
    blocks = []
    for rate, weight in zip(rates, weights, strict=True):
        blocks.append([rate * weight, weight, 1])
        while len(blocks) > 1 and blocks[-2][0] * blocks[-1][1] > blocks[-1][0] * blocks[-2][1]:
            last = blocks.pop()
            blocks[-1] = [a + b for a, b in zip(blocks[-1], last, strict=True)]
    pooled = np.concatenate([[total / weight] * length for total, weight, length in blocks])
    assert _isotonic(rates[None], weights)[0] == pytest.approx(pooled, abs=1e-9)


def test_samples_needed_print_with_their_interval_if_there_is_one():
    assert str(SamplesNeeded(411.6, 380.2, math.inf, 32, 1024)) == "412 [380, > 1024]"
    needed = samples_needed((32, 64), [0.1, 0.95], None, [9, 9])
    assert (needed.has_interval, str(needed)) == (False, f"{needed.short} [–]")
    assert 32 < needed.estimate < 64


def test_columns_are_resampled_together():
    table = np.array([[1, 0], [0, 1], [1, 0], [0, 1]])
    values = resampled_ratios(table, np.ones_like(table))
    assert values.sum(axis=1) == pytest.approx(1.0)
    assert np.array_equal(values[:, 0], resampled_ratios(table[:, 0], [1, 1, 1, 1]))


def test_a_resample_without_any_run_of_a_column_has_the_ratio_of_all():
    values = resampled_ratios([[1], [0]], [[2], [0]], draws=50)
    assert np.all(values == 0.5)


@given(st.lists(st.integers(0, 12), min_size=2, max_size=8))
def test_students_interval_of_units_of_one_size_is_that_of_a_mean(sums):
    runs = [12] * len(sums)
    interval = student_interval(sums, runs, "sets", lowest=0.0)
    shares = np.array(sums) / 12
    half = stats.t.ppf(0.975, len(sums) - 1) * stats.sem(shares)
    assert interval.low == pytest.approx(max(0.0, shares.mean() - half), abs=1e-9)
    assert interval.high == pytest.approx(min(1.0, shares.mean() + half), abs=1e-9)
    if shares.std() > 0 and shares.mean() > 0:
        assert student_test(sums, runs) == pytest.approx(stats.ttest_1samp(shares, 0.0).pvalue, abs=1e-12)


@pytest.mark.parametrize(("sums", "p"), [([0, 0, 0], 1.0), ([1, -1, 0], 1.0), ([2, 2, 2], 0.0), ([3], 1.0)])
def test_units_without_a_difference_and_a_single_one_are_no_evidence(sums, p):
    assert student_test(sums, [5] * len(sums)) == p
    assert student_interval([3], [5], "sets") == Interval(-1.0, 1.0, "student over sets")


IMPOSSIBLE = [([], []), ([1], [1, 2]), ([1, 1], [0, 1])]


@pytest.mark.parametrize(("call", "numbers"), [
    *((resampled_ratios, each) for each in [*IMPOSSIBLE[:2], ([1], [0]), ([math.nan], [1])]),
    *((clustered_difference, (*each, "sets")) for each in [*IMPOSSIBLE[:2], ([3], [2]), ([0], [0])]),
    *((student_interval, (*each, "sets")) for each in IMPOSSIBLE),
    (samples_needed, ((64, 32), [0.1, 0.2], [[0.1, 0.2]], [10, 10])),
    (samples_needed, ((32,), [0.1, 0.2], [[0.1]], [10, 10])),
    (samples_needed, ((32,), [0.1], [0.1], [10])), (samples_needed, ((), [], [[]], [])),
])  # fmt: skip
def test_impossible_numbers_and_shapes_are_refused(call, numbers):
    refused(InvalidValue, "", call, *numbers)


def test_the_wider_of_two_intervals_is_taken():
    narrow, wide = Interval(0.4, 0.5, "a"), Interval(0.1, 0.3, "b")
    assert narrow.or_wider(wide) is wide is wide.or_wider(narrow)
    assert narrow.or_wider(Interval(0.4, 0.5, "c")) is narrow
