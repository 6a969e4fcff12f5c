"""Sets from larger ones, against the measures of what they are."""

from itertools import combinations

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import PointSet, draw, greedy_order, prefix_discrepancies, project
from evenroad.points.measures import MEASURES
from tests.refused import refused


def random_set(n, d, seed=0):
    return PointSet(np.random.default_rng(seed).random((n, d)))


@pytest.mark.parametrize("name", MEASURES)
def test_discrepancies_of_prefixes_are_those_of_the_points_so_far(name):
    points = random_set(40, 3)
    expected = [MEASURES[name].rooted(points[:n]) for n in range(1, 41)]
    np.testing.assert_allclose(prefix_discrepancies(points, measure=name), expected, rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize("name", MEASURES)
def test_in_greedy_order_no_other_next_point_were_better(name):
    points = random_set(20, 3, seed=1)
    ordered = greedy_order(points, measure=name)
    assert sorted(map(tuple, ordered.points)) == sorted(map(tuple, points.points))
    squared = MEASURES[name].squared
    for m in range(1, 20):
        every = [squared(np.vstack([ordered[: m - 1], other])) for other in ordered[m - 1 :]]
        assert every[0] <= min(every) * (1 + 1e-9) + 1e-12


def test_a_greedy_order_makes_a_sequence_of_a_set_and_says_so():
    points = draw("hickernell", 256, 2)
    ordered = greedy_order(points)
    assert ordered.origin.method == "annealed, in greedy order"
    # The set of the bank comes in no order: like random points.
    assert np.all(prefix_discrepancies(ordered)[15:200] < 0.6 * prefix_discrepancies(points)[15:200])
    assert prefix_discrepancies(ordered)[-1] == pytest.approx(MEASURES["hickernell"].rooted(points), rel=1e-9)


@pytest.mark.parametrize(("d", "kept"), [(6, 3), (14, 7)])
def test_a_projection_keeps_the_axes_on_which_the_points_are_the_most_even(d, kept):
    # 20 choices are all measured, of 3432 some.
    points, squared = random_set(30, d, seed=2), MEASURES["hickernell"].squared
    made = project(points, kept)
    axes = [int(axis) for axis in made.origin.method.rpartition("axes ")[2].split()]
    assert axes == sorted(axes)
    np.testing.assert_array_equal(made.points, points.points[:, axes])
    values = sorted(squared(points.points[:, each]) for each in combinations(range(d), kept))
    assert squared(made.points) <= values[len(values) // 100]
    if len(values) < 300:
        assert squared(made.points) == values[0]


def test_a_projection_on_all_axes_is_the_set_itself():
    points = draw("even", 50, 4)
    np.testing.assert_array_equal(project(points, 4).points, points.points)


def test_more_axes_than_there_are_and_unknown_measures_are_refused():
    points = random_set(5, 3)
    refused(InvalidValue, "d must be at most the set's 3 dimensions, got 4", project, points, 4)
    refused(InvalidValue, "d", project, points, 0)
    for function in (greedy_order, prefix_discrepancies):
        refused(UnknownName, "known: .*hickernell", function, points, measure="even")
