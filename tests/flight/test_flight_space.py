"""The space of flight: motions lead where they should, within limits, and none is quicker."""

import pickle

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.flight import FlightSpace
from evenroad.testing import SpaceContract
from tests.flight.oracle import flown, is_feasible

SPEED, ACCELERATION = (6.0, 4.0, 2.0), (8.0, 5.0, 3.0)
SPACE = FlightSpace((-3, -3, -3), (3, 3, 3), SPEED, ACCELERATION)


class TestFlight(SpaceContract):
    space = FlightSpace((-9, -9, -9), (9, 9, 9), 2.0, 4.0)
    measure_is_the_metrics = False

    def configurations(self, n, seed=7):
        """States in the middle: motions between others may leave the box."""
        return self.space.from_cube(0.2 + 0.6 * np.random.default_rng(seed).random((n, 6)))

    def test_distance_is_symmetric(self):
        a, b, _ = self.pairs()
        assert self.space.is_directed
        assert (np.abs(self.space.distance(a, b) - self.space.distance(b, a)) > 1e-6).any()

    def test_interpolation_back_is_the_same_path(self):
        """It is another one, that begins and ends where the other one does."""
        a, b, _ = self.pairs()
        np.testing.assert_allclose(self.space.interpolate(b, a, 1.0), a)


def states(n, seed=1):
    """Pairs of states: any, some at rest, and some of which one is a little further on the other's course."""
    a, b = SPACE.from_cube(np.random.default_rng(seed).random((2 * n, 6))).reshape(2, n, 6)
    a[::4, 3:] = 0.0
    b[::8, 3:] = 0.0
    b[1::5, :3] = a[1::5, :3] + 0.1 * a[1::5, 3:]
    return a, b


def test_pieces_lead_from_state_to_state_within_the_limits():
    a, b = states(60)
    for first, second, time in zip(a, b, SPACE.distance(a, b), strict=True):
        pieces = SPACE.native.pieces_along(np.stack([first, second]))
        along, times = flown(first, pieces, 25)
        np.testing.assert_allclose(along[-1], second, atol=1e-10)
        assert times[-1] == pytest.approx(time, abs=1e-12)
        assert (np.abs(along[:, 3:]) <= np.add(SPEED, 1e-9)).all()
        assert (np.abs(pieces[:, 7:]) <= ACCELERATION).all()
        shares = times / max(time, 1e-9)
        row = np.full((len(times), 6), first), np.full((len(times), 6), second)
        np.testing.assert_allclose(SPACE.interpolate(*row, np.minimum(shares, 1.0)), along, atol=1e-9)


def test_no_motion_is_quicker_than_the_least_common_time():
    """Of the axes of some motions one has a gap: it can be quick or slow, but nothing between."""
    a, b = states(50, seed=2)
    alone = 0
    for first, second, time in zip(a, b, SPACE.distance(a, b), strict=True):
        assert is_feasible(first, second, SPEED, ACCELERATION, time, 1e-3)
        for shorter in np.linspace(0.0, time, 40, endpoint=False)[:-1]:
            assert not is_feasible(first, second, SPEED, ACCELERATION, shorter, -1e-3)
        each = [SPACE.native.least_times(only(first, axis), only(second, axis))[0] for axis in range(3)]
        alone += time > max(each) + 1e-6
    assert alone > 3


def only(state, axis):
    """A state of which one axis moves, as a batch."""
    kept = np.zeros((1, 6))
    kept[0, [axis, 3 + axis]] = state[[axis, 3 + axis]]
    return kept


def test_a_motion_that_is_cut_is_the_same_motion():
    a, b = states(400, seed=3)
    for share in (0.1, 0.37, 0.5, 0.9):
        middle = SPACE.interpolate(a, b, share)
        both = SPACE.distance(a, middle) + SPACE.distance(middle, b)
        np.testing.assert_allclose(both, SPACE.distance(a, b), atol=1e-9)


def test_a_copy_is_equal():
    assert pickle.loads(pickle.dumps(SPACE)) == SPACE


@pytest.mark.parametrize("speed", [0.0, -1.0, np.nan, (1, 2), (1, 2, -3), "fast", 1e-9, True])
def test_a_limit_that_is_none_is_refused(speed):
    with pytest.raises(InvalidValue, match="speed must be"):
        FlightSpace((0, 0, 0), (1, 1, 1), speed, 1.0)
    with pytest.raises(InvalidValue, match="acceleration must be"):
        FlightSpace((0, 0, 0), (1, 1, 1), 1.0, speed)
    with pytest.raises(InvalidValue, match="low must be"):
        FlightSpace((0, 0, 2), (1, 1, 1), 1.0, 1.0)
