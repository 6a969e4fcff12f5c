"""States of flight: six numbers that are refused unless they are finite."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue


def test_a_state_is_six_numbers_to_numpy_and_at_rest_by_default():
    assert np.array(er.State((1, 2, 3), (4, 5, 6))).tolist() == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert np.array([er.State((1, 2, 3))]).tolist() == [[1.0, 2.0, 3.0, 0.0, 0.0, 0.0]]


@pytest.mark.parametrize("xyz", [(1, 2), (1, 2, np.nan), "abc", 7, (1, 2, 1e12)])
def test_a_position_that_is_none_is_refused_in_one_line(xyz):
    for wrong in (lambda: er.State(xyz), lambda: er.State((0, 0, 0), xyz)):
        with pytest.raises(InvalidValue, match=r"^the (position|velocity) of a state") as refused:
            wrong()
        assert "\n" not in str(refused.value)
