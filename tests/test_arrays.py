"""Different rows of an array are those that NumPy finds, in its order."""

import numpy as np
import pytest

from evenroad._arrays import unique_rows


@pytest.mark.parametrize("shape", [(0, 3), (1, 3), (2, 1), (3000, 2), (5000, 3), (700, 6)])
def test_different_rows_and_their_numbers_are_those_of_numpy(shape):
    rng = np.random.default_rng(shape[0])
    for rows in (rng.integers(-4, 5, shape), np.round(rng.normal(size=shape), 1) + 0.0, rng.random(shape)):
        different, number = np.unique(rows, axis=0, return_inverse=True)
        found, numbers = unique_rows(rows)
        np.testing.assert_array_equal(found, different)
        np.testing.assert_array_equal(numbers, number.reshape(-1))
