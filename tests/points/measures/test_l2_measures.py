"""The L2 discrepancies against slow readable oracles: double loops, integrals, projections, scipy."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import qmc

from evenroad.errors import InvalidValue
from evenroad.points import PointSet
from evenroad.points.measures import MEASURES
from tests.differences import slopes
from tests.refused import refused

WEIGHTED = [name for name, measure in MEASURES.items() if measure.weighted]
UNWEIGHTED = [name for name, measure in MEASURES.items() if not measure.weighted]

# Per measure and for a coordinate weight g: the constant, the linear factor, the pair factor; scalars only.
SLOW_FACTORS = {
    "star": (lambda g: 1 / 3, lambda g, x: (1 - x**2) / 2, lambda g, x, y: 1 - max(x, y)),
    "hickernell": (
        lambda g: 1 + g / 3, lambda g, x: 1 + g * (1 - x**2) / 2, lambda g, x, y: 1 + g * (1 - max(x, y)),
    ),
    "centred": (
        lambda g: 1 + g / 12,
        lambda g, x: 1 + g * (abs(x - 0.5) / 2 - (x - 0.5) ** 2 / 2),
        lambda g, x, y: 1 + g * (abs(x - 0.5) / 2 + abs(y - 0.5) / 2 - abs(x - y) / 2),
    ),
    "wrap_around": (
        lambda g: 1 + g / 3,
        lambda g, x: 1 + g / 3,
        lambda g, x, y: 1 + g * (1 / 2 - abs(x - y) * (1 - abs(x - y))),
    ),
    "mixture": (
        lambda g: 1 + g * 7 / 12,
        lambda g, x: 1 + g * (2 / 3 - abs(x - 0.5) / 4 - (x - 0.5) ** 2 / 4),
        lambda g, x, y: 1 + g * (7 / 8 - (abs(x - 0.5) + abs(y - 0.5) + 3 * abs(x - y)) / 4 + (x - y) ** 2 / 2),
    ),
    "symmetric": (
        lambda g: 1 + g / 3, lambda g, x: 1 + g * (2 * x - 2 * x**2), lambda g, x, y: 1 + g * (1 - 2 * abs(x - y)),
    ),
    "average_squared": (
        lambda g: 1 / 3, lambda g, x: (1 + 2 * x - 2 * x**2) / 4, lambda g, x, y: (1 - abs(x - y)) / 2,
    ),
}  # fmt: skip


def slow_squared(name, points, weights):
    constant, linear, pair = SLOW_FACTORS[name]
    n = len(points)
    single = sum(math.prod(map(linear, weights, x)) for x in points)
    double = sum(math.prod(map(pair, weights, x, y)) for x in points for y in points)
    return math.prod(map(constant, weights)) - 2 / n * single + double / n**2


def rooted_with_gradient(measure, points, weights=None):
    columns = np.ascontiguousarray(np.asarray(points, dtype=float).T)
    root, gradient = measure.of_columns(columns, None if weights is None else np.asarray(weights, dtype=float))
    return root, gradient.T


def random_points(n, d, seed=0):
    return np.random.default_rng(seed).random((n, d))


def test_every_measure_has_an_oracle():
    assert set(SLOW_FACTORS) == set(MEASURES)


@pytest.mark.parametrize("name", MEASURES)
@pytest.mark.parametrize(("n", "d"), [(1, 1), (1, 4), (2, 1), (7, 3), (23, 2), (9, 14)])
def test_the_squared_value_is_the_double_loop(name, n, d):
    points = random_points(n, d, seed=n + d)
    expected, squared = slow_squared(name, points, np.ones(d)), MEASURES[name].squared(points)
    assert squared == pytest.approx(expected, rel=1e-11, abs=1e-14)
    assert MEASURES[name].rooted(points) == math.sqrt(squared)


@pytest.mark.parametrize("name", WEIGHTED)
def test_weights_multiply_the_part_of_a_coordinate_that_is_not_constant(name):
    points, weights = random_points(11, 4), np.array([0.0, 0.3, 1.0, 2.5])
    expected = slow_squared(name, points, weights)
    assert MEASURES[name].squared(points, weights) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("name", MEASURES)
def test_more_points_than_a_tile_give_the_same_sum(name):
    points = random_points(700, 2)
    _, linear, pair = SLOW_FACTORS[name]
    constant = SLOW_FACTORS[name][0](1) ** 2
    single = sum(linear(1, x) * linear(1, y) for x, y in points)
    double = sum(pair(1, a[0], b[0]) * pair(1, a[1], b[1]) for a in points.tolist() for b in points.tolist())
    expected = constant - 2 / 700 * single + double / 700**2
    assert MEASURES[name].squared(points) == pytest.approx(expected, rel=1e-9)


# 1 + g (1 - 2 |x - y|) of the symmetric measure is negative for g = 4 and |x - y| > .625.
@pytest.mark.parametrize("weights", [[0.5, 1.0, 2.0], [4.0, 2.0, 6.0]], ids=["small", "large"])
@pytest.mark.parametrize("name", MEASURES)
def test_gradients_are_those_of_central_differences(name, weights):
    measure, points = MEASURES[name], random_points(6, 3, seed=3)
    weights = weights if measure.weighted else None
    root, root_gradient = rooted_with_gradient(measure, points, weights)
    assert root == measure.rooted(points, weights)
    slow = slopes(lambda x: measure.rooted(x, weights), points)
    np.testing.assert_allclose(root_gradient, slow, atol=1e-8 * np.abs(slow).max())


@pytest.mark.parametrize("name", MEASURES)
def test_gradients_hold_across_tiles(name):
    measure, points = MEASURES[name], random_points(530, 2, seed=4)
    _, gradient = rooted_with_gradient(measure, points)
    slow = slopes(measure.rooted, points, places=((0, 0), (511, 1), (512, 0), (529, 1)))
    known = np.isfinite(slow)
    np.testing.assert_allclose(gradient[known], slow[known], rtol=0, atol=1e-5 * np.abs(gradient).max())


@pytest.mark.parametrize("name", MEASURES)
def test_a_coordinate_that_all_points_share_has_a_finite_gradient(name):
    points = random_points(5, 2)
    points[:, 0] = 0.25
    assert np.isfinite(rooted_with_gradient(MEASURES[name], points)[1]).all()


@pytest.mark.parametrize(("ours", "theirs", "method"), [
    ("centred", "squared", "CD"), ("wrap_around", "squared", "WD"), ("mixture", "squared", "MD"),
    ("star", "rooted", "L2-star"),  # scipy gives this one, and only this one, as a root
])  # fmt: skip
def test_scipy_agrees(ours, theirs, method):
    for n, d in ((1, 2), (20, 3), (64, 6)):
        points = random_points(n, d, seed=n)
        value = getattr(MEASURES[ours], theirs)(points)
        assert value == pytest.approx(qmc.discrepancy(points, method=method), rel=1e-10)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_star_is_the_mean_square_of_the_local_discrepancy(d):
    points, boxes = random_points(6, d), random_points(200_000, d, seed=1)
    squares = ((points < boxes[:, None]).all(axis=2).mean(axis=1) - boxes.prod(axis=1)) ** 2
    error = squares.std() / math.sqrt(squares.size)
    assert MEASURES["star"].squared(points) == pytest.approx(squares.mean(), abs=4 * error)


def test_average_squared_is_star_averaged_over_reflections():
    points = random_points(9, 3)
    reflected = [np.where(signs, 1 - points, points) for signs in itertools.product([False, True], repeat=3)]
    mean = np.mean([MEASURES["star"].squared(p) for p in reflected])
    assert MEASURES["average_squared"].squared(points) == pytest.approx(mean, rel=1e-11)


@pytest.mark.parametrize("d", range(1, 7))
def test_hickernell_is_the_sum_of_star_over_all_projections(d):
    points, weights = random_points(8, d), np.linspace(0.5, 1.5, d)
    plain = weighted = 0.0
    for size in range(1, d + 1):
        for kept in itertools.combinations(range(d), size):
            squared = MEASURES["star"].squared(points[:, kept])
            plain += squared
            weighted += math.prod(weights[list(kept)]) * squared
    assert MEASURES["hickernell"].squared(points) == pytest.approx(plain, rel=1e-10)
    assert MEASURES["hickernell"].squared(points, weights) == pytest.approx(weighted, rel=1e-10)


def test_symmetric_is_average_squared_times_four_to_the_d():
    points = random_points(15, 5)
    ratio = MEASURES["symmetric"].squared(points) / MEASURES["average_squared"].squared(points)
    assert ratio == pytest.approx(4.0**5, rel=1e-10)


@settings(max_examples=30)
@given(seed=st.integers(0, 10**6), n=st.integers(1, 12), d=st.integers(1, 5), name=st.sampled_from(list(MEASURES)))
def test_what_a_measure_says_leaves_it_unchanged_does(seed, n, d, name):
    rng = np.random.default_rng(seed)
    points, measure = rng.random((n, d)), MEASURES[name]
    value = pytest.approx(measure.squared(points), rel=1e-9, abs=1e-13)
    assert measure.squared(points[rng.permutation(n)]) == value
    assert measure.squared(points[:, rng.permutation(d)]) == value
    if measure.periodic:
        assert measure.squared((points + rng.random(d)) % 1.0) == value
    if measure.reflectable:
        reflected = np.where(rng.random(d) < 0.5, np.nextafter(1.0, 0.0) - points, points).clip(0.0)
        assert measure.squared(reflected) == value


@pytest.mark.parametrize("name", MEASURES)
def test_what_a_measure_says_changes_it_does(name):
    points, measure = random_points(9, 2), MEASURES[name]
    shifted, reflected = (points + 0.3) % 1.0, 1.0 - points
    assert measure.periodic == (measure.squared(shifted) == pytest.approx(measure.squared(points)))
    assert measure.reflectable == (measure.squared(reflected) == pytest.approx(measure.squared(points)))


def test_a_regular_set_keeps_its_digits_with_many_points():
    n = 4000
    points = (np.arange(n)[:, None] + 0.5) / n
    # The local discrepancy of n midpoints is a sawtooth of height 1/2n: its mean square is 1/12n^2.
    assert MEASURES["star"].squared(points) == pytest.approx(1 / (12 * n**2), rel=1e-6)


def test_a_point_set_is_taken_as_it_is():
    points = random_points(5, 2)
    assert MEASURES["star"].rooted(PointSet(points)) == MEASURES["star"].rooted(points.tolist())


@pytest.mark.parametrize("bad", [
    [[0.5, math.nan]], [[0.5, 1.0]], [[-1e-9, 0.5]], [0.5, 0.5], [["a", "b"]], np.zeros((3, 0)),
])  # fmt: skip
def test_bad_points_and_none_are_refused(bad):
    for name, measure in MEASURES.items():
        refused(InvalidValue, "points must", measure.rooted, bad)
        refused(InvalidValue, rf"{name} needs at least one point.*\(0, 3\)", measure.squared, np.zeros((0, 3)))


@pytest.mark.parametrize("weights", [[1.0], [1.0, -0.1], [1.0, math.nan], [[1.0, 1.0]], ["a", "b"]])
def test_bad_weights_are_refused(weights):
    refused(InvalidValue, "weights must be 2 finite numbers", MEASURES["hickernell"].squared, [[0.5, 0.5]], weights)


@pytest.mark.parametrize("name", UNWEIGHTED)
def test_a_measure_without_a_constant_part_says_that_it_takes_no_weights(name):
    refused(InvalidValue, f"{name} takes no coordinate weights", MEASURES[name].squared, [[0.5, 0.5]], [1.0, 1.0])
