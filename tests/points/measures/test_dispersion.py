"""Dispersion between what a fine grid sees and what it can have missed, known values, and the paper's bound."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, NotAvailable, UnknownName
from evenroad.points.bank.anneal import anneal
from evenroad.points.measures import (
    MEASURES,
    dispersion_l2,
    dispersion_linf,
    dispersion_lower_bound,
    star_discrepancy,
)

GRID = {1: 501, 2: 101, 3: 31}


def slow_dispersion(points, order):
    """Largest distance over a grid that holds the corners, and the most that it can have missed."""
    d = points.shape[1]
    steps = np.linspace(0, 1, GRID[d])
    places = np.array(list(itertools.product(steps, repeat=d)))
    nearest = np.min([np.linalg.norm(places - point, ord=order, axis=1) for point in points], axis=0)
    half_cell = np.full(d, 0.5 / (GRID[d] - 1))
    return nearest.max(), np.linalg.norm(half_cell, ord=order)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 25), d=st.integers(1, 3), on_grid=st.booleans())
def test_exact_dispersion_is_what_a_grid_sees_up_to_its_cells(seed, n, d, on_grid):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 4, (n, d)) / 4 if on_grid else rng.random((n, d))
    for exact, order in ((dispersion_l2(points), 2), (dispersion_linf(points), np.inf)):
        seen, missed = slow_dispersion(points, order)
        assert seen - 1e-12 <= exact <= seen + missed + 1e-12


@pytest.mark.parametrize("d", [1, 2, 3])
def test_one_point_in_the_middle_is_half_a_cube_away(d):
    assert dispersion_linf([[0.5] * d]) == pytest.approx(0.5, abs=1e-15)
    assert dispersion_l2([[0.5] * d]) == pytest.approx(math.sqrt(d) / 2, abs=1e-15)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_one_point_in_a_corner_is_a_whole_cube_away(d):
    assert dispersion_linf([[0.0] * d]) == pytest.approx(1.0, abs=1e-15)
    assert dispersion_l2([[0.0] * d]) == pytest.approx(math.sqrt(d), abs=1e-15)


@pytest.mark.parametrize(("side", "d"), [(7, 1), (5, 2), (4, 3)])
def test_a_grid_of_cell_centres_has_half_a_cell(side, d):
    points = (np.array(list(itertools.product(range(side), repeat=d))) + 0.5) / side
    assert dispersion_linf(points) == pytest.approx(0.5 / side, abs=1e-14)
    assert dispersion_l2(points) == pytest.approx(math.sqrt(d) * 0.5 / side, abs=1e-14)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 60), d=st.integers(2, 3))
def test_permuted_and_reflected_points_have_the_same_dispersion(seed, n, d):
    rng = np.random.default_rng(seed)
    points = rng.random((n, d))
    moved = np.where(rng.random(d) < 0.5, 1 - points, points)[:, rng.permutation(d)]
    assert dispersion_linf(moved) == pytest.approx(dispersion_linf(points), abs=1e-14)
    assert dispersion_l2(moved) == pytest.approx(dispersion_l2(points), abs=1e-12)


@pytest.mark.parametrize(("n", "d"), [(40, 1), (60, 2), (40, 3)])
def test_the_search_stays_below_the_exact_value_and_comes_close(n, d):
    points = np.random.default_rng(5).random((n, d))
    for norm, exact in (("l2", dispersion_l2(points)), ("linf", dispersion_linf(points))):
        found = dispersion_lower_bound(points, norm)
        assert 0.97 * exact <= found <= exact + 1e-12


def test_the_search_goes_where_exact_does_not_and_repeats_itself():
    points = np.random.default_rng(6).random((50, 8))
    found = dispersion_lower_bound(points, "l2", rng=1, starts=500, rounds=5)
    assert found == dispersion_lower_bound(points, "l2", rng=1, starts=500, rounds=5)
    assert 0.5 < found < math.sqrt(8)


@pytest.mark.parametrize(("n", "d"), [(1, 1), (20, 1), (16, 2), (64, 2), (40, 3)])
def test_linf_dispersion_is_at_most_the_root_of_the_star_discrepancy_on_even_sets(n, d):
    # The inequality behind the paper's guarantee for roadmaps.
    random = np.random.default_rng(n).random((n, d))
    optimised = anneal(n, d, MEASURES["star"], steps=200).points
    for points in (random, optimised):
        assert dispersion_linf(points) <= star_discrepancy(points) ** (1 / d) + 1e-12


def test_that_inequality_fails_for_a_set_that_leaves_a_far_corner_empty():
    # It is a theorem for the discrepancy over all boxes (Niederreiter 1992), not for boxes at the origin.
    points = [[0.0, 0.375], [0.55, 0.975]]
    assert star_discrepancy(points) == pytest.approx(0.5)
    assert dispersion_linf(points) == pytest.approx(0.975)
    assert dispersion_linf(points) > star_discrepancy(points) ** (1 / 2)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 12), d=st.integers(1, 3), scale=st.floats(0.1, 1.0))
def test_with_a_factor_of_two_it_holds_for_every_set(seed, n, d, scale):
    # Any box is a signed sum of 2^d boxes at the origin, so its discrepancy is at most 2^d times the star's.
    points = scale * np.random.default_rng(seed).random((n, d))
    assert dispersion_linf(points) <= 2 * star_discrepancy(points) ** (1 / d) + 1e-12


def test_exact_dispersion_in_high_dimensions_points_to_the_search():
    for exact in (dispersion_l2, dispersion_linf):
        with pytest.raises(NotAvailable, match=r"d <= 3, got d=4; dispersion_lower_bound"):
            exact(np.full((2, 4), 0.5))


def test_exact_linf_work_beyond_the_budget_is_refused_before_it_starts():
    points = np.random.default_rng(0).random((100_000, 3))
    with pytest.raises(
        NotAvailable,
        match=r"n=100000 points in d=3 takes about 1e\+10 steps, the budget is 4e\+08.*lower_bound",
    ):
        dispersion_linf(points)
    with pytest.raises(NotAvailable, match="the budget is 1e"):
        dispersion_linf(points[:20], budget=10)
    with pytest.raises(InvalidValue, match="budget must be"):
        dispersion_linf(points[:20], budget=0)
    assert dispersion_linf(points[:20], budget=400) == dispersion_linf(points[:20])


def test_no_points_have_no_dispersion():
    for function in (dispersion_l2, dispersion_linf, dispersion_lower_bound):
        with pytest.raises(InvalidValue, match="at least one point"):
            function(np.zeros((0, 2)))


def test_an_unknown_norm_lists_the_known_ones():
    with pytest.raises(UnknownName, match="unknown norm 'l1'; known: l2, linf"):
        dispersion_lower_bound([[0.5]], "l1")
