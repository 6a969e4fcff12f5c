"""Discrepancies of all prefixes beside a loop over them; the worst of them, and its slope."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points.measures import MEASURES
from evenroad_studies.prefixes import PREFIXED, SHARPNESS, SHORTEST, rooted_prefixes, worst_prefix
from tests.differences import slopes


def slow_worst(name, points, level, fixed=0):
    lengths = range(max(min(SHORTEST, len(points)), fixed + 1), len(points) + 1)
    above = [np.log(MEASURES[name].rooted(points[:n])) - level[n - 1] for n in lengths]
    powers = np.exp(SHARPNESS * np.array(above))
    return np.log(np.average(powers, weights=[1 / n for n in lengths])) / SHARPNESS


def some(n, d):
    rng = np.random.default_rng(n)
    return rng.random((n, d)), 0.3 * rng.standard_normal(n) - np.log(np.arange(1, n + 1))


@pytest.mark.parametrize("name", PREFIXED)
@pytest.mark.parametrize(("n", "d"), [(1, 2), (5, 1), (40, 2), (33, 5)])
def test_they_are_those_of_each_prefix_alone(name, n, d):
    points, _ = some(n, d)
    expected = [MEASURES[name].rooted(points[:m]) for m in range(1, n + 1)]
    np.testing.assert_allclose(rooted_prefixes(points, name), expected, rtol=1e-9)


@pytest.mark.parametrize("name", PREFIXED)
@pytest.mark.parametrize(("n", "d", "fixed"), [(1, 2, 0), (8, 3, 0), (40, 2, 0), (33, 5, 20)])
def test_the_worst_is_a_sharp_mean_over_the_prefixes_that_count(name, n, d, fixed):
    points, level = some(n, d)
    value, _ = worst_prefix(name, np.ascontiguousarray(points.T), level, fixed)
    assert value == pytest.approx(slow_worst(name, points, level, fixed), rel=1e-9)


@pytest.mark.parametrize(("name", "fixed"), [("hickernell", 0), ("star", 0), ("hickernell", 15)])
def test_the_slope_is_that_of_finite_differences_and_none_where_points_are_held(name, fixed):
    points, level = some(21, 3)
    _, gradient = worst_prefix(name, np.ascontiguousarray(points.T), level, fixed)
    assert (gradient[:, :fixed] == 0).all()
    slow = slopes(lambda moved: slow_worst(name, moved, level, fixed), points, step=1e-7)
    np.testing.assert_allclose(gradient.T[fixed:], slow[fixed:], rtol=1e-3, atol=1e-6)


def test_other_measures_are_refused():
    with pytest.raises(InvalidValue, match="hickernell or star"):
        rooted_prefixes(np.full((3, 2), 0.5), "centred")
