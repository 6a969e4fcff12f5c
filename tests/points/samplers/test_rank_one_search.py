"""Generating vectors where the best Korobov lattice is poor, judged by the energy of their points."""

from math import gcd

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.points import draw
from evenroad.points.measures import riesz_rooted
from evenroad.points.measures.rank_one import generating_vector, minima_ratio
from evenroad.points.samplers import korobov
from evenroad.points.samplers.korobov import korobov_generator, rank_one_vector

POOR = ((96, 5), (240, 5), (120, 7), (960, 7), (504, 3), (72, 9))
FINE = ((64, 2), (90, 2), (128, 3), (512, 5), (1024, 7), (1024, 9))


def powers(n, d):
    return tuple(pow(korobov_generator(n, d), i, n) for i in range(d))


def energy(n, z):
    return riesz_rooted(np.arange(n)[:, np.newaxis] * np.array(z) % n / n)


@pytest.mark.parametrize(("n", "d"), POOR)
def test_where_powers_are_poor_another_vector_has_less_energy_and_less_unequal_minima(n, d):
    z = rank_one_vector(n, d)
    assert minima_ratio(n, powers(n, d)) > max(korobov.POOR, minima_ratio(n, z))
    assert energy(n, z) < 0.95 * energy(n, powers(n, d))
    assert z[0] == 1
    assert all(gcd(each, n) == 1 for each in z)


@pytest.mark.parametrize(("n", "d"), FINE)
def test_where_powers_are_fine_they_are_kept(n, d):
    assert rank_one_vector(n, d) == powers(n, d)
    if d < 6:
        assert draw("even", n, d, rng=1).points.tobytes() == draw("korobov", n, d, rng=1).points.tobytes()


@settings(max_examples=40)
@given(n=st.integers(1, 400), d=st.integers(1, 9))
def test_no_vector_has_more_energy_than_that_of_the_best_multiplier(n, d):
    z = rank_one_vector(n, d)
    assert len(z) == d
    if n > 1:
        assert energy(n, z) <= energy(n, powers(n, d)) * (1 + 1e-9)


def test_few_tries_find_a_better_one_too(monkeypatch):
    n, d = 960, 7
    monkeypatch.setattr(korobov, "WORK", 1)
    assert energy(n, korobov._descended(n, powers(n, d))) < energy(n, powers(n, d))


@pytest.mark.parametrize(("n", "d"), POOR)
def test_even_sets_have_that_vector_and_say_so(n, d):
    points = draw("even", n, d, rng=2)
    told = [int(each) for each in points.origin.method.split("z=")[1].split(",")[0].split()]
    assert tuple(told) == rank_one_vector(n, d)
    drawn = generating_vector(points)
    # Up to a factor, and in some order of the axes.
    assert sorted(drawn * pow(int(drawn[0]), -1, n) % n) in [
        sorted(np.array(told) * pow(each, -1, n) % n) for each in told
    ]
