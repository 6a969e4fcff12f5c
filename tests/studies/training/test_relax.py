"""Sets of small star discrepancy in space."""

import numpy as np

from evenroad.points import draw
from evenroad.points.measures import star_discrepancy
from evenroad_studies.training.relax import coordinate_bounds, relaxed, search_in_space


def test_sweeps_make_a_set_better_and_its_value_is_exact():
    points = draw("sobol", 40, 3, rng=2).points
    made = relaxed(points, sweeps=5)
    assert made.value == star_discrepancy(made.points) < 0.9 * star_discrepancy(points)
    assert not made.points.flags.writeable


def test_the_best_of_some_tries_is_the_same_for_the_same_seed():
    one, again = (search_in_space(10, tries=3, sweeps=3, rng=4) for _ in range(2))
    np.testing.assert_array_equal(one.points, again.points)
    assert one.value == star_discrepancy(one.points)


def test_bounds_are_those_of_all_boxes_at_the_origin():
    points, t = np.random.default_rng(3).random((9, 3)), 0.2
    order = np.argsort(points[:, 0])
    second, third = (np.argsort(np.argsort(points[:, axis]))[order] for axis in (1, 2))
    low, high = coordinate_bounds(second, third, np.sort(points[:, 1]), np.sort(points[:, 2]), t)
    for i in range(9):
        before, up_to = points[order[:i]], points[order[: i + 1]]
        boxes = [(y, z) for y in (*points[:, 1], 1.0) for z in (*points[:, 2], 1.0)]
        most = min((t + np.sum((before[:, 1:] < box).all(axis=1)) / 9) / np.prod(box) for box in boxes)
        least = max((np.sum((up_to[:, 1:] <= box).all(axis=1)) / 9 - t) / np.prod(box) for box in boxes)
        np.testing.assert_allclose((low[i], high[i]), (max(least, 0.0), most), rtol=1e-12)
