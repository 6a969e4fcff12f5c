"""The exact star discrepancy against all boxes of the full grid, and known values."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.points.measures import MEASURES, star_discrepancy
from tests.refused import refused


def slow_star_discrepancy(points):
    n, d = points.shape
    best = 0.0
    for sides in itertools.product(*[[*points[:, k], 1.0] for k in range(d)]):
        volume = np.prod(sides)
        best = max(best, volume - (points < sides).all(axis=1).sum() / n)
        best = max(best, (points <= sides).all(axis=1).sum() / n - volume)
    return best


@pytest.mark.parametrize(("n", "d"), [(1, 1), (9, 1), (1, 3), (12, 2), (7, 3), (5, 4), (3, 6)])
def test_it_is_the_largest_deviation_over_the_full_grid(n, d):
    points = np.random.default_rng(n * d).random((n, d))
    assert star_discrepancy(points) == pytest.approx(slow_star_discrepancy(points), abs=1e-14)


@settings(max_examples=40)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 8), d=st.integers(1, 3))
def test_ties_and_zeros_are_counted_right(seed, n, d):
    points = np.random.default_rng(seed).integers(0, 4, (n, d)) / 4
    assert star_discrepancy(points) == pytest.approx(slow_star_discrepancy(points), abs=1e-14)


def test_midpoints_of_the_line_have_one_over_2n_and_it_bounds_the_l2_star_discrepancy():
    assert star_discrepancy((np.arange(50)[:, None] + 0.5) / 50) == pytest.approx(0.01, abs=1e-14)
    for seed, (n, d) in enumerate([(100, 2), (60, 3), (30, 5)]):
        points = np.random.default_rng(seed).random((n, d))
        assert MEASURES["star"].rooted(points) <= star_discrepancy(points) <= 1.0


def test_no_points_and_work_beyond_the_budget_are_refused_before_it_starts():
    points = np.random.default_rng(0).random((200, 10))
    with pytest.raises(NotAvailable, match=r"n=200 points in d=10 takes about 10\^16 steps, the budget is 1e\+10"):
        star_discrepancy(points)
    refused(NotAvailable, "the budget is 1e", star_discrepancy, points[:20, :2], budget=10)
    refused(InvalidValue, "at least one point", star_discrepancy, np.zeros((0, 2)))
