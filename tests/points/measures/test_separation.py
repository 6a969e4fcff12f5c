"""Separation against a double loop."""

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.points.measures import separation


def slow_separation(points, periodic):
    gaps = np.abs(points[:, None] - points[None])
    if periodic:
        gaps = np.minimum(gaps, 1 - gaps)
    distances = np.linalg.norm(gaps, axis=2)
    return min(distances[i, j] for i in range(len(points)) for j in range(i))


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize(("n", "d"), [(2, 1), (30, 1), (50, 3), (20, 14)])
def test_separation_is_the_smallest_distance_of_two_points(n, d, periodic):
    points = np.random.default_rng(n).random((n, d))
    assert separation(points, periodic) == pytest.approx(slow_separation(points, periodic), rel=1e-12)


def test_a_periodic_pair_meets_across_the_face():
    assert separation([[0.01, 0.5], [0.98, 0.5]], periodic=True) == pytest.approx(0.03)


def test_coincident_points_have_separation_zero():
    assert separation(np.full((2, 3), 0.5)) == 0.0
    assert separation([[0.0, 0.0], [0.5, 0.5], [0.0, 0.0]], periodic=True) == 0.0


def test_a_single_point_has_no_separation():
    with pytest.raises(InvalidValue, match="at least 2 points, got 1"):
        separation([[0.5]])
