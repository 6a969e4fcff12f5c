"""Generating vectors of small energy and discrepancy, both measured on the points."""

from itertools import combinations
from math import gcd

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import MEASURES, riesz_rooted
from evenroad.points.measures.rank_one import generating_vector, successive_minima
from evenroad.points.samplers import rank_one
from evenroad.points.samplers.korobov import korobov_generator
from evenroad.points.samplers.rank_one import evenness, has_distinct_axes, rank_one_vector
from tests.refused import refused

POOR_BY_ENERGY = ((512, 4), (128, 5), (512, 7), (240, 5), (120, 7))


def powers(n, d):
    return tuple(pow(korobov_generator(n, d), i, n) for i in range(d))


def score(n, z):
    points = np.arange(n)[:, np.newaxis] * np.array(z) % n / n
    return np.log(riesz_rooted(points)) + evenness(len(z)) * np.log(MEASURES["wrap_around"].rooted(points))


def least_in_planes(n, z):
    """Return the shortest distance in any projection on two axes, in units of n^(-1/2); 0 where points coincide."""
    return min(successive_minima(n, pair)[0] for pair in combinations(z, 2)) * n**0.5


@settings(max_examples=30)
@given(n=st.integers(4, 300), d=st.integers(3, 8))
def test_no_powers_of_a_multiplier_score_less_and_no_two_axes_are_on_one_line(n, d):
    z = rank_one_vector(n, d)
    assert z[0] == 1
    assert len(z) == d
    units = sum(gcd(i, n) == 1 for i in range(1, n)) // 2
    assert has_distinct_axes(n, d) == (units >= d)
    if units >= d:
        assert len({min(each, n - each) for each in z}) == d
        first = powers(n, d)
        assert len({min(each, n - each) for each in first}) < d or score(n, z) <= score(n, first) + 1e-6


@pytest.mark.parametrize(("n", "d"), POOR_BY_ENERGY)
def test_where_the_least_energy_leaves_projections_poor_they_are_better(n, d):
    z = rank_one_vector(n, d)
    assert least_in_planes(n, z) > 1.2 * least_in_planes(n, powers(n, d))
    assert score(n, z) < score(n, powers(n, d)) - 0.1


def test_a_step_of_the_search_scores_what_the_measures_do():
    n, steps = 30, np.arange(1, 16)
    for z in ((1, 7, 11), (1, 13, 17)):
        squared, kernel = rank_one._terms(np.array(z), steps, n)
        sums = rank_one._summed(squared.sum(axis=0), kernel.prod(axis=0), steps, n, 3)
        np.testing.assert_allclose(sums, rank_one._sums(np.array(z), n), rtol=1e-12)
        # The energy is in units of the spacing here.
        units = np.log(n) * (-1 / 3)
        assert rank_one._score(*sums, n, 3) == pytest.approx(score(n, z) + units + _per_point(n, z), abs=1e-9)


def _per_point(n, z):
    """Return what the rooted energy of the measure counts beside the sum over one point's differences."""
    points = np.arange(n)[:, np.newaxis] * np.array(z) % n / n
    gaps = np.abs(points[1:] - points[0])
    gaps = np.minimum(gaps, 1.0 - gaps)
    own = np.log(((gaps**2).sum(axis=1) ** -3.0).sum()) / 6
    return own - np.log(riesz_rooted(points))


def test_in_the_plane_the_vector_is_korobovs():
    for n in (64, 90, 128):
        assert rank_one_vector(n, 2) == powers(n, 2)
        assert draw("even", n, 2, rng=1).points.tobytes() == draw("korobov", n, 2, rng=1).points.tobytes()


def test_few_tries_and_powers_alone_find_a_vector_too(monkeypatch):
    n, d = 960, 7
    best = powers(n, d)
    monkeypatch.setattr(rank_one, "TRIED", 1)
    assert score(n, rank_one._descended(n, best)) < score(n, best)
    monkeypatch.setattr(rank_one, "LARGEST", 1)
    assert score(n, rank_one_vector.__wrapped__(n, d)) <= score(n, best) + 1e-9
    refused(InvalidValue, "at most 67108864", rank_one_vector, 2**26 + 1, 5)


@pytest.mark.parametrize(("n", "d"), [(96, 5), (240, 6), (1009, 10)])
def test_even_sets_have_that_vector_and_say_so(n, d):
    points = draw("even", n, d, rng=2)
    told = [int(each) for each in points.origin.method.split("z=")[1].split(",")[0].split()]
    assert tuple(told) == rank_one_vector(n, d)
    drawn = generating_vector(points)
    # Up to a factor, and in some order of the axes.
    assert any(sorted(np.array(told) * int(each) % n) == sorted(drawn) for each in drawn)


def test_lattices_of_many_dimensions_are_made_without_a_warning_of_numpys():
    # Warnings are errors here: of poor lattices the energy is beyond the largest number.
    assert draw("even", 211, 100).shape == (211, 100)
    refused(InvalidValue, "d must be at most 1024", draw, "even", 2099, 1025)
