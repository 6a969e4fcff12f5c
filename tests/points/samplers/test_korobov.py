"""Korobov lattices against a search that trusts nothing but the Riesz energy of the points."""

from math import gcd

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import MEASURES, riesz_rooted, separation
from evenroad.points.samplers import korobov
from evenroad.points.samplers.korobov import Korobov, korobov_generator
from tests.points.samplers.sampler_contract import SamplerContract


def lattice_points(a, n, d):
    return np.array([[i * a**k % n / n for k in range(d)] for i in range(n)])


def slow_generator(n, d):
    """Return the smallest a whose energy is the least of all with no two axes on one line, up to rounding."""
    every = [a for a in range(1, n) if gcd(a, n) == 1]
    allowed = [a for a in every if len({min(a**k % n, -(a**k) % n) for k in range(d)}) == d] or every
    energies = [riesz_rooted(lattice_points(a, n, d)) ** (2 * d) for a in allowed]
    return next(a for a, energy in zip(allowed, energies, strict=True) if energy <= min(energies) * (1 + 1e-9))


class TestKorobov(SamplerContract):
    sampler = Korobov()
    shapes = ((1, 1), (1, 4), (2, 3), (7, 1), (64, 2), (97, 14), (100, 3))

    # Less than a block of points, many, and numbers of 26 bits.
    @pytest.mark.parametrize(("n", "vector"), [(97, (1, 5)), (2**14 + 1, (1, 7, 16384)), (2**26 - 5, (2**26 - 6,))])
    def test_blocks_of_floats_give_the_bits_of_whole_numbers(self, n, vector):
        shift = np.random.default_rng(n).random(len(vector))
        made = korobov.shifted_lattice(n, vector, shift)
        rows = np.unique(np.append(np.random.default_rng(1).integers(0, n, 20_000), [0, n - 1]))
        whole = rows[:, np.newaxis] * np.array(vector) % n / n
        np.testing.assert_array_equal(made[rows], (whole + shift) % 1.0)

    @pytest.mark.parametrize(("n", "d"), [(12, 2), (31, 3), (100, 7)])
    def test_the_coordinates_of_each_axis_are_n_equally_spaced_values(self, n, d):
        points = self.sampler.draw(n, d, rng=4).points
        gaps = np.diff(np.sort(points, axis=0), axis=0)
        np.testing.assert_allclose(gaps, 1 / n, rtol=1e-12)

    @pytest.mark.parametrize(("n", "d"), [(13, 2), (64, 3), (50, 6)])
    def test_a_drawn_set_is_the_lattice_of_its_generator_under_one_shift(self, n, d):
        points = self.sampler.draw(n, d, rng=8).points
        shift = points - lattice_points(korobov_generator(n, d), n, d)
        np.testing.assert_allclose((shift - shift[0] + 0.5) % 1.0, 0.5, atol=1e-12)

    def test_the_set_names_its_multiplier_and_what_was_minimised(self):
        origin = self.sampler.draw(89, 2).origin
        assert origin.method == f"rank-1 lattice a={korobov_generator(89, 2)}, shifted"
        assert origin.objective == "riesz"

    def test_a_shift_next_to_one_does_not_push_points_out_of_the_cube(self, monkeypatch):
        class AlmostOne:
            def random(self, d):
                return np.full(d, np.nextafter(1.0, 0.0))

        monkeypatch.setattr(korobov, "generator", lambda rng: AlmostOne())
        for n in (1, 2, 3, 49, 64):
            assert self.sampler.draw(n, 2).n == n


@pytest.mark.parametrize("d", [2, 5])
def test_even_sets_are_both_of_low_discrepancy_and_well_separated(d):
    even = draw("even", 60, d)
    random = [draw("uniform", 60, d, rng=seed) for seed in range(20)]
    assert separation(even, periodic=True) > 1.8 * max(separation(each, periodic=True) for each in random)
    discrepancy = MEASURES["average_squared"].rooted
    assert discrepancy(even) < 0.8 * min(map(discrepancy, random))


SMALL = [(n, d) for n in (2, 3, 4, 5, 6, 8, 12, 25, 30, 37, 64) for d in (1, 2, 3, 5, 9)]


@pytest.mark.parametrize(("n", "d"), [*SMALL, (300, 2), (401, 3), (263, 14)])
def test_the_generator_is_that_of_a_slow_search(n, d):
    expected = 1 if d == 1 else slow_generator(n, d)
    assert korobov_generator(n, d) == expected


@pytest.mark.parametrize("block", [1, 200, 10**6])
@pytest.mark.parametrize(("n", "d"), [(144, 2), (199, 3), (360, 7), (97, 20)])
def test_how_often_the_race_is_looked_at_does_not_change_who_wins(n, d, block, monkeypatch):
    expected = korobov_generator(n, d)
    monkeypatch.setattr(korobov, "BLOCK", block)
    assert korobov._searched.__wrapped__(n, d) == expected


@settings(max_examples=20)
@given(n=st.integers(1, 3000), d=st.integers(1, 40))
def test_the_generator_is_a_number_below_half_of_n_without_common_divisor(n, d):
    a = korobov_generator(n, d)
    assert 1 <= a <= max(1, n // 2)
    assert gcd(a, n) == 1


@pytest.mark.parametrize(("n", "d"), [(1009, 40), (211, 300), (3, 1000)])
def test_no_dimension_overflows(n, d):
    a = korobov_generator(n, d)
    points = lattice_points(a, n, d)
    others = [lattice_points(other, n, d) for other in range(2, min(n, 12)) if gcd(other, n) == 1]
    assert all(riesz_rooted(points) <= riesz_rooted(each) * (1 + 1e-12) for each in others)


def test_a_search_cut_short_still_finds_a_lattice_far_better_than_most(monkeypatch):
    n, d = 1021, 4
    monkeypatch.setattr(korobov, "WORK", 1)
    found = korobov._searched.__wrapped__(n, d)
    energies = [riesz_rooted(lattice_points(a, n, d)) for a in range(1, n // 2, 5)]
    assert riesz_rooted(lattice_points(found, n, d)) < np.quantile(energies, 0.2)


def test_more_points_than_floats_can_tell_apart_are_refused():
    with pytest.raises(InvalidValue, match="at most 67108864 for the korobov sampler"):
        korobov_generator(2**26 + 1, 2)
