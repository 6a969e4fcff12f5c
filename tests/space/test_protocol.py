"""Distances of all pairs are those of pair after pair, in every space."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.space import SE2, SE3, SO3, BoxSpace, Circle, JointSpace, Product, Rectangle
from evenroad.space.protocol import all_distances
from tests.refused import refused

SPACES = {
    "box": BoxSpace([-1, 0, 2], [1, 5, 3], weights=[1.0, 2.0, 0.5]),
    "circle": Circle(),
    "joints": JointSpace([-math.pi, 0.0], [math.pi, 1.0], wrapping=[True, False]),
    "rotations": SO3(),
    "SE2": SE2([0, 0], [9, 9], weights=[2.0, 5.0]),
    "SE3": SE3([0, 0, 0], [9, 9, 9], weights=[1.0, 3.0]),
    "SE3 of squares": SE3([0, 0, 0], [9, 9, 9], combine="l2"),
    "product with a space that has none": Product([Rectangle((0, 0), (1, 0), (0, 2)), Circle()]),
    "none": Rectangle((0, 0), (1, 0), (0, 2)),
}


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_all_pairs_have_the_distances_of_pair_after_pair(space):
    q = space.from_cube(np.random.default_rng(0).random((50, space.cube_dim)))
    a, b = q[:20], q[15:]
    pairs = [[space.distance(x[np.newaxis], y[np.newaxis])[0] for y in b] for x in a]
    np.testing.assert_allclose(all_distances(space, a, b), pairs, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("space", SPACES.values(), ids=SPACES)
def test_no_rows_have_no_distances_and_a_wrong_batch_is_refused(space):
    q = space.from_cube(np.random.default_rng(0).random((3, space.cube_dim)))
    assert all_distances(space, q[:0], q).shape == (0, 3)
    assert all_distances(space, q, q[:0]).shape == (3, 0)
    wrong = q.copy()
    wrong[1, 0] = np.nan
    refused(InvalidValue, "", all_distances, space, q, wrong)
    refused(InvalidValue, "", all_distances, space, np.hstack([q, q]), q)


def test_a_row_that_is_no_rotation_is_refused():
    refused(InvalidValue, "row 1 has norm", all_distances, SO3(), np.eye(4), np.eye(4) * [[1], [2], [1], [1]])
