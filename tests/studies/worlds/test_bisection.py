import numpy as np
import pytest

from evenroad.world.bisection import between_endpoints
from evenroad_studies.worlds.bisection import next_between


@pytest.mark.parametrize("segments", [0, 1, 2, 3, 4, 5, 7, 8, 9, 31, 100, 1023])
def test_one_motion_is_looked_at_in_the_order_of_many(segments):
    states = []
    level, multiple, state = next_between(1, -1, segments)
    while state > 0:
        states.append(state)
        level, multiple, state = next_between(level, multiple, segments)
    levels = list(between_endpoints(np.array([segments]), np.array([True])))
    assert states == [state for _, numbers in levels for state in numbers.tolist()]
    assert sorted(states) == list(range(1, segments))
