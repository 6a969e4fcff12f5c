"""Points placed by their order: beside brute force, and beside the published sets."""

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.points.measures import star_discrepancy
from evenroad_studies.training import order_many
from evenroad_studies.training.order import place_order, search_orders
from tests.refused import refused


def order_of(points):
    by_x = points[np.argsort(points[:, 0], kind="stable")]
    return np.argsort(np.argsort(by_x[:, 1], kind="stable"))


def test_the_places_keep_the_order_and_say_their_discrepancy():
    order = np.random.default_rng(0).permutation(30)
    made = place_order(order)
    assert np.array_equal(order_of(made.points), order)
    assert made.value == star_discrepancy(made.points)
    assert not made.points.flags.writeable


@pytest.mark.parametrize("order", [[0], [1, 0], [0, 1, 2], [1, 2, 0], [2, 0, 3, 1]])
def test_no_other_places_in_this_order_are_better(order):
    n = len(order)

    def discrepancy(flat):
        x, y = np.sort(flat[:n]), np.sort(flat[n:])
        return star_discrepancy(np.column_stack([x, y[order]]))

    found = differential_evolution(discrepancy, [(0.0, 0.999)] * (2 * n), rng=1, maxiter=60, tol=1e-10)
    assert place_order(order).value == pytest.approx(found.fun, abs=2e-3)
    assert place_order(order).value <= found.fun + 1e-6


@pytest.mark.parametrize("seed", range(3))
def test_placing_a_set_anew_makes_it_no_worse(seed):
    points = draw("sobol", 64, 2, rng=seed).points
    assert place_order(order_of(points)).value < 0.95 * star_discrepancy(points)


@pytest.mark.parametrize(("n", "published"), [(60, 0.0234), (140, 0.0115)])
def test_a_short_search_beats_the_published_sets(n, published):
    made = search_orders(n, steps=1500)
    assert made.value < published
    assert made.value == star_discrepancy(made.points)


def test_the_same_seed_gives_the_same_bits_and_the_best_only_falls():
    seen = []
    first = search_orders(12, steps=200, rng=3, callback=lambda step, steps, best: seen.append(best))
    assert len(seen) == 200
    assert np.diff(seen).max() <= 0
    assert seen[-1] == pytest.approx(first.value, rel=2e-4)
    assert np.array_equal(search_orders(12, steps=200, rng=3).points, first.points)


def test_one_point_has_its_known_place():
    # max(x y, 1 - x y, x, y) over boxes is least where x = y solves 1 - x^2 = x.
    made = search_orders(1, steps=4)
    assert made.value == pytest.approx((np.sqrt(5) - 1) / 2, abs=1e-6)


@pytest.mark.parametrize("order", [[], [0, 0], [1, 2], [[0]]])
def test_what_is_no_order_is_refused(order):
    refused(InvalidValue, "each of 0 .. n - 1 once", place_order, order)


def test_many_sets_are_kept_in_a_folder(tmp_path):
    sets = order_many(8, 2, steps=50, workers=1, folder=tmp_path)
    assert order_many(8, 2, steps=50, workers=1, folder=tmp_path) == sets
    assert [each.origin.method for each in sets] == ["order", "order"]
    refused(InvalidValue, "steps", order_many, 8, 2, steps=51, workers=1, folder=tmp_path)
