"""The space of a car: curves lead where they should, and none is shorter."""

import math
import pickle

import numpy as np
import pytest

from evenroad.driving import CarSpace
from evenroad.errors import InvalidValue
from evenroad.spaces import Rectangle
from evenroad.testing import SpaceContract
from tests.driving.oracle import driven

POSITIONS = Rectangle((-10, -10), (30, 0), (0, 30))


def poses(n, seed=3):
    return CarSpace(POSITIONS).from_cube(np.random.default_rng(seed).random((n, 3)))


class OfCars(SpaceContract):
    measure_is_the_metrics = False

    def configurations(self, n, seed=7):
        """Poses in the middle: curves between others may leave the rectangle."""
        return self.space.from_cube(0.4 + 0.2 * np.random.default_rng(seed).random((n, 3)))


class TestReedsShepp(OfCars):
    space = CarSpace(POSITIONS, 1.5)


class TestOnTheSpot(OfCars):
    space = CarSpace(POSITIONS, 0.0, spot=0.5)


class TestDubins(OfCars):
    space = CarSpace(POSITIONS, 1.0, reverse=False)

    def test_distance_is_symmetric(self):
        a, b, _ = self.pairs()
        assert self.space.is_directed
        assert (np.abs(self.space.distance(a, b) - self.space.distance(b, a)) > 1e-6).any()

    def test_interpolation_back_is_the_same_path(self):
        """It is another one, that begins and ends where the other one does."""
        a, b, tolerance = self.pairs()
        np.testing.assert_allclose(self.space.distance(self.space.interpolate(b, a, 1.0), a), 0.0, atol=tolerance)


@pytest.mark.parametrize(("radius", "reverse"), [(1.0, True), (3.0, True), (1.0, False), (0.0, True), (0.0, False)])
def test_pieces_lead_from_one_pose_to_the_other_and_have_the_points_of_the_curve(radius, reverse):
    space = CarSpace(POSITIONS, radius, reverse, 0.7)
    for a, b in zip(poses(120), poses(120, 4), strict=True):
        pieces = space.pieces(a, b)
        at, _ = driven(a, pieces)
        end = at(1.0)
        np.testing.assert_allclose(end[:2], b[:2], atol=1e-9)
        assert math.cos(end[2] - b[2]) == pytest.approx(1.0, abs=1e-12)
        assert reverse or (pieces[:, 1] >= 0.0).all()
        assert set(np.abs(pieces[:, 0])) <= {0.0, 1.0 / radius if radius else np.inf}
        if radius > 0.0:
            assert np.abs(pieces[:, 1]).sum() == pytest.approx(space.distance([a], [b])[0], rel=1e-12)
            for t in (0.2, 0.7):
                (between,) = space.interpolate([a], [b], t)
                np.testing.assert_allclose(between[:2], at(t)[:2], atol=1e-9)
                assert math.cos(between[2] - at(t)[2]) == pytest.approx(1.0, abs=1e-12)


def test_lengths_are_those_that_ompl_computes():
    """Of its ReedsSheppStateSpace and DubinsStateSpace with a radius of 1 (OMPL 2.0)."""
    a = np.zeros((5, 3))
    b = np.array([(1, 1, 1), (-2, 0.5, 3), (0, 0.3, 0), (4, -3, -2), (0.1, 0, 1.5)])
    both = [1.5963545438203979, 3.201023067220817, 1.506856264836033, 5.47289983143856, 1.5]
    forwards = [7.648403552534644, 6.007891289136619, 6.583185307179586, 5.47289983143856, 6.467691626116736]
    np.testing.assert_allclose(CarSpace(POSITIONS, 1.0).distance(a, b), both, atol=1e-9)
    np.testing.assert_allclose(CarSpace(POSITIONS, 1.0, reverse=False).distance(a, b), forwards, atol=1e-9)


@pytest.mark.parametrize("reverse", [True, False])
def test_one_piece_is_its_own_shortest_curve_whatever_rounding_does(reverse):
    space, rng = CarSpace(POSITIONS, 0.5, reverse), np.random.default_rng(2)
    starts, lengths = poses(400), rng.uniform(1e-3, 0.7, 400) * rng.choice([1, -1] if reverse else [1], 400)
    after = [
        driven(start, [(curvature, length)])[0](1.0)
        for start, length, curvature in zip(starts, lengths, rng.choice([0.0, 2.0, -2.0], 400), strict=True)
    ]
    np.testing.assert_allclose(space.distance(starts, after), np.abs(lengths), rtol=1e-7)


def test_a_car_that_may_reverse_has_no_longer_curves_and_none_is_shorter_than_a_straight_line_or_its_turn():
    a, b = poses(300), poses(300, 5)
    both, forwards = CarSpace(POSITIONS, 2.0).distance(a, b), CarSpace(POSITIONS, 2.0, reverse=False).distance(a, b)
    turn = np.abs((b[:, 2] - a[:, 2] + np.pi) % (2 * np.pi) - np.pi)
    assert (both <= forwards + 1e-9).all()
    assert (both >= np.hypot(*(b - a)[:, :2].T) - 1e-9).all()
    assert (both >= 2.0 * turn - 1e-9).all()


def test_a_turn_on_the_spot_is_an_angle():
    pieces = CarSpace(POSITIONS, 0.0, spot=0.5).pieces((1, 1, 0), (1, 3, 0))
    np.testing.assert_allclose(pieces, [(np.inf, np.pi / 2), (0, 2), (-np.inf, np.pi / 2)], atol=1e-12)


def test_a_copy_has_the_same_lengths():
    space = CarSpace(POSITIONS, 1.5)
    copy = pickle.loads(pickle.dumps(space))
    assert copy == space
    np.testing.assert_array_equal(copy.distance(poses(9), poses(9, 4)), space.distance(poses(9), poses(9, 4)))


@pytest.mark.parametrize("wrong", [{"turning_radius": -1}, {"turning_radius": np.nan}, {"spot": 0.0}])
def test_numbers_that_are_none_are_refused(wrong):
    with pytest.raises(InvalidValue, match=next(iter(wrong))):
        CarSpace(POSITIONS, **wrong)
