import numpy as np

from evenroad.errors import InvalidValue
from evenroad.space import SE2, BoxSpace
from evenroad.space.path import configuration_at, motion_lengths, path_length, resample, subdivide
from tests.refused import refused

SQUARE = BoxSpace((0.0, 0.0), (4.0, 4.0))
PATH = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 0.0], [3.0, 1.0]])


def test_lengths_are_those_of_the_motions():
    np.testing.assert_array_equal(motion_lengths(PATH, SQUARE), [3.0, 0.0, 1.0])
    assert path_length(PATH, SQUARE) == 4.0
    assert path_length(PATH[:1], SQUARE) == 0.0


def test_resampled_states_are_at_most_a_step_apart_and_hold_the_waypoints_as_they_are():
    states, motion = resample(PATH, SQUARE, 0.7)
    assert motion.tolist() == [0, 0, 0, 0, 0, 0, 1, 2, 2]
    assert motion_lengths(states, SQUARE).max() <= 0.7
    np.testing.assert_allclose(states[:6, 0], np.arange(6) * 0.6)
    for waypoint in PATH:
        assert (states == waypoint).all(axis=1).any()
    single, own = resample(PATH[:1], SQUARE, 0.7)
    assert single.tolist() == [[0.0, 0.0]]
    assert own.tolist() == [0]


def test_waypoints_beyond_a_turn_stay_as_they_are():
    space = SE2((0.0, 0.0), (1.0, 1.0))
    path = np.array([[0.0, 0.0, 3.5], [1.0, 0.0, -3.0]])
    states, own = subdivide(path, space, np.array([4]))
    np.testing.assert_array_equal(states[own], path)
    assert (space.distance(states[:-1], states[1:]) < 0.3).all()


def test_a_place_on_a_path_is_where_a_share_of_its_length_leads():
    places = configuration_at(PATH, SQUARE, [0.0, 0.375, 0.75, 0.875, 1.0])
    np.testing.assert_allclose(places, [[0, 0], [1.5, 0], [3, 0], [3, 0.5], [3, 1]])
    np.testing.assert_array_equal(configuration_at(PATH[:1], SQUARE, 0.3), PATH[:1])
    np.testing.assert_array_equal(configuration_at(PATH[1:3], SQUARE, [0.0, 1.0]), PATH[1:3])


def test_what_is_no_step_and_no_share_is_refused():
    for step in (0.0, -1.0, np.nan, np.inf):
        refused(InvalidValue, "step", resample, PATH, SQUARE, step)
    for share in (-0.1, 1.1, np.nan):
        refused(InvalidValue, r"t must lie in \[0, 1\]", configuration_at, PATH, SQUARE, share)
