"""Certified bounds of the dispersion, against exact values, searches, and lattices whose covering radius is known."""

import itertools

import numpy as np
import pytest
from scipy.spatial import cKDTree

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import dispersion_bounds
from evenroad.points.samplers.lattice import covering_radius
from tests.points.measures.dispersion_oracle import dispersion_l2


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("family", ["uniform", "even", "sobol"])
def test_bounds_enclose_the_exact_dispersion_and_meet(d, family):
    for n in (1, 2, 37, 200):
        points = draw(family, n, d, rng=n)
        lower, upper = dispersion_bounds(points)
        exact = dispersion_l2(points)
        assert lower <= exact * (1 + 1e-9)
        assert upper >= exact * (1 - 1e-12)
        assert upper <= 1.00001 * exact


@pytest.mark.parametrize("d", [4, 5, 6])
def test_no_place_is_farther_than_the_upper_bound_says(d):
    points = draw("halton", 100, d, rng=3)
    lower, upper = dispersion_bounds(points)
    rng, tree = np.random.default_rng(1), cKDTree(points.points)
    places = np.round(rng.random((4000, d)))
    # Corners and their surroundings, and from there uphill.
    for step in np.geomspace(0.5, 1e-3, 40):
        moved = np.clip(places + step * rng.standard_normal(places.shape), 0, 1)
        higher = tree.query(moved)[0] > tree.query(places)[0]
        places[higher] = moved[higher]
    assert lower <= upper <= 1.001 * lower
    assert 0.9 * upper <= tree.query(places)[0].max() <= upper


def test_a_grid_leaves_half_the_diagonal_of_a_cell():
    d, m = 4, 4
    grid = (np.indices([m] * d).reshape(d, -1).T + 0.5) / m
    lower, upper = dispersion_bounds(grid)
    assert lower == pytest.approx(0.5 * np.sqrt(d) / m, rel=1e-5)
    assert upper == pytest.approx(0.5 * np.sqrt(d) / m, rel=1e-5)
    assert upper >= 0.5 * np.sqrt(d) / m


def test_a_box_is_measured_as_it_is_stretched():
    points, sides = draw("sobol", 64, 2, rng=2).points, np.array([3.0, 0.5])
    upper = dispersion_bounds(points, sides=sides).upper
    ticks = np.linspace(0.0, 1.0, 400)
    places = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    away = np.sqrt((((places[:, None] - points[None]) * sides) ** 2).sum(-1)).min(1).max()
    assert away <= upper <= away + np.linalg.norm(sides) / 399


def test_a_wrapping_box_has_no_faces():
    points, wraps = draw("sobol", 32, 3, rng=5).points, np.array([True, False, True])
    copies = [points + shift for shift in itertools.product((-1, 0, 1), (0,), (-1, 0, 1))]
    ticks = np.linspace(0.0, 1.0, 41)
    places = np.stack(np.meshgrid(ticks, ticks, ticks), axis=-1).reshape(-1, 3)
    away = np.min([np.linalg.norm(places[:, None] - each[None], axis=-1).min(1) for each in copies], axis=0).max()
    upper = dispersion_bounds(points, wrapping=wraps).upper
    assert away <= upper <= away + np.sqrt(3) / 80
    assert upper < dispersion_bounds(points).upper


def test_little_work_gives_bounds_that_hold_all_the_same():
    points = draw("even", 200, 5)
    sharp, rough = dispersion_bounds(points), dispersion_bounds(points, work=1e4)
    assert rough.lower <= sharp.upper <= sharp.lower * 1.001 <= rough.upper * 1.001


@pytest.mark.parametrize(("d", "density"), [(2, 1.209), (3, 1.464), (5, 2.124), (6, 2.551), (7, 3.060), (10, 5.252)])
def test_the_closed_form_of_a_d_star_gives_its_known_covering_density(d, density):
    from math import gamma, pi

    assert pi ** (d / 2) / gamma(d / 2 + 1) * covering_radius(d) ** d == pytest.approx(density, abs=1e-3)


@pytest.mark.parametrize("d", [2, 3])
def test_a_cover_keeps_the_lattices_covering_radius_up_to_the_faces(d):
    points = draw("cover", 500, d, rng=4)
    upper = dispersion_bounds(points).upper
    # Cut out at the faces, the same lattice has holes half as wide again.
    assert 1.4 * upper < dispersion_bounds(draw("lattice", 500, d, rng=4)).upper
    assert upper < 1.4 * covering_radius(d) * 500 ** (-1 / d)


@pytest.mark.parametrize(("points", "options", "said"), [
    (np.empty((0, 2)), {}, "at least one point"), ([[0.5, 0.5]], {"sides": [1.0]}, "sides must be 2"),
    ([[0.5, 0.5]], {"sides": [1.0, 0.0]}, "sides must be 2"),
    ([[0.5, 0.5]], {"wrapping": [True]}, "wrapping must be 2"),
    ([[0.5, 0.5]], {"work": 0}, "work must be"), ([[0.5, 1.5]], {}, "lie in"),
])  # fmt: skip
def test_bad_input_is_named(points, options, said):
    with pytest.raises(InvalidValue, match=said):
        dispersion_bounds(points, **options)
