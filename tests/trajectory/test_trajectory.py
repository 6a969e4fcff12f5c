from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad import FunctionWorld
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.space import BoxSpace
from evenroad.trajectory import InMotion, Limits, load_trajectory, make_trajectory
from tests.refused import refused


def zigzag(seed, p=6, dim=3):
    return np.random.default_rng(seed).uniform(-2.0, 2.0, (p, dim))


def bang_bang(distance, velocity, acceleration):
    """The least time from rest to rest, by hand."""
    if distance <= velocity**2 / acceleration:
        return 2.0 * np.sqrt(distance / acceleration)
    return distance / velocity + velocity / acceleration


def distance_to(path, place):
    best = np.inf
    for a, b in pairwise(path):
        share = np.clip(np.dot(place - a, b - a) / np.dot(b - a, b - a), 0.0, 1.0)
        best = min(best, np.linalg.norm(place - a - share * (b - a)))
    return best


paths = st.builds(zigzag, st.integers(0, 10**6), st.integers(2, 9), st.integers(1, 7))


@settings(max_examples=40, deadline=None)
@given(path=paths, seed=st.integers(0, 10**6), jerky=st.booleans(), deviation=st.sampled_from([0.0, 0.01, 0.3]))
def test_it_keeps_every_limit_and_stays_near_its_path(path, seed, jerky, deviation):
    rng, dim = np.random.default_rng(seed), path.shape[1]
    velocity, acceleration = rng.uniform(0.5, 4.0, dim), rng.uniform(0.5, 20.0, dim)
    jerk = None if jerky else tuple(acceleration * rng.uniform(5.0, 50.0))
    limits = Limits(tuple(velocity), tuple(acceleration), jerk)
    made = make_trajectory(path, limits, deviation=deviation)
    q, step = made.positions, made.times[1]
    # By differences of places alone: what the trajectory says of its speeds is checked against them.
    speeds = np.diff(q, axis=0) / step
    pushes = np.diff(q, n=2, axis=0) / step**2
    assert np.all(np.abs(speeds) <= velocity * (1 + 1e-6) + 1e-9)
    assert np.all(np.abs(pushes) <= acceleration * (1 + 1e-4) + 1e-6)
    assert np.all(np.abs(made.velocities) <= velocity * (1 + 1e-9))
    assert np.all(np.abs(made.accelerations) <= acceleration * (1 + 1e-9))
    between = 0.5 * (made.velocities[1:] + made.velocities[:-1])
    assert np.all(np.abs(between - speeds) <= acceleration * step)
    if jerk is not None:
        assert np.all(np.abs(np.diff(made.accelerations, axis=0)) <= np.array(jerk) * step * (1 + 1e-6) + 1e-9)
    np.testing.assert_allclose(q[[0, -1]], path[[0, -1]], atol=1e-9)
    np.testing.assert_allclose(made.velocities[[0, -1]], 0.0, atol=1e-9)
    assert max(distance_to(path, place) for place in q) <= deviation + 1e-5
    assert made.deviation <= deviation + 1e-5
    assert max(made.highest.values()) <= 1.0 + 1e-9


def test_a_straight_line_takes_no_longer_than_its_longest_joint():
    limits = Limits((1.0, 3.0), (2.0, 5.0))
    made = make_trajectory([[0.0, 0.0], [4.0, -1.0]], limits)
    assert made.duration == pytest.approx(bang_bang(4.0, 1.0, 2.0), rel=0.005)
    assert made.stops == 0
    assert made.deviation < 1e-9


def test_between_its_states_it_moves_as_its_path_does():
    path = zigzag(3, dim=2)
    trajectory = make_trajectory(path, Limits((1.0, 1.0), (2.0, 2.0)), deviation=0.01)
    assert np.allclose(trajectory.at(trajectory.times), trajectory.positions, rtol=0.0, atol=1e-12)
    between = np.random.default_rng(0).uniform(0.0, trajectory.duration, (5, 40))
    positions = trajectory.at(between)
    assert positions.shape == (5, 40, 2)
    assert max(distance_to(path, q) for q in positions.reshape(-1, 2)) <= trajectory.deviation + 1e-4
    finer = make_trajectory(path, Limits((1.0, 1.0), (2.0, 2.0)), deviation=0.01, step=0.001)
    assert np.abs(trajectory.at(np.minimum(finer.times, trajectory.duration)) - finer.positions).max() < 0.01
    for wrong in (-1e-9, trajectory.duration + 1e-6, np.nan, "soon", [0.0, [1.0]]):
        refused(InvalidValue, "t must be from 0 to", trajectory.at, wrong)


def test_without_deviation_it_stops_at_every_corner():
    limits = Limits((1.0, 1.0), (2.0, 2.0))
    made = make_trajectory([[0, 0], [1, 0], [1, 1], [0, 1]], limits, deviation=0.0)
    assert made.duration == pytest.approx(3 * bang_bang(1.0, 1.0, 2.0), rel=0.01)
    assert made.stops == 2
    for corner in ([1, 0], [1, 1]):
        i = np.argmin(np.linalg.norm(made.positions - corner, axis=1))
        assert np.linalg.norm(made.velocities[i]) < 0.05


def test_cutting_corners_is_faster():
    limits = Limits((2.0,) * 3, (4.0,) * 3)
    times = [make_trajectory(zigzag(3), limits, deviation=at).duration for at in (0.0, 0.01, 0.1)]
    assert times[0] > times[1] > times[2]


def test_half_the_speed_takes_twice_as_long_and_always_a_whole_number_of_steps():
    limits = Limits((1.0,) * 3, (2.0,) * 3, (30.0,) * 3)
    full, half = (make_trajectory(zigzag(2), limits.at_speed(share)) for share in (1.0, 0.5))
    assert half.duration == pytest.approx(2 * full.duration, abs=0.03)
    made = make_trajectory(zigzag(1), Limits((1.0,) * 3, (2.0,) * 3), step=0.002)
    np.testing.assert_allclose(np.diff(made.times), 0.002, atol=1e-12)


def around_a_corner(reach):
    """A world whose only obstacle sits in the inner side of the corner at (1, 0)."""

    def free(q):
        return ~((q[:, 0] < 1.0 - reach) & (q[:, 1] > reach))

    return FunctionWorld(BoxSpace([-1.0, -1.0], [3.0, 3.0]), free, resolution=0.001)


@pytest.mark.parametrize("reach", [0.05, 0.01, 1e-5])
def test_a_corner_that_touches_is_cut_less(reach):
    world, path = around_a_corner(reach), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    limits = Limits((1.0, 1.0), (2.0, 2.0))
    careless = make_trajectory(path, limits, deviation=0.2)
    assert not world.valid(careless.positions).all()
    made = make_trajectory(path, limits, world=world, deviation=0.2)
    assert world.valid(made.positions).all()
    assert made.duration > careless.duration
    assert made.stops == (1 if reach == 1e-5 else 0)
    assert made.proof == "resolution"


def test_a_path_that_is_not_free_is_refused():
    world = FunctionWorld(BoxSpace([-1.0], [3.0]), lambda q: np.abs(q[:, 0] - 1.0) > 0.1, resolution=0.01)
    refused(NotAvailable, "not proved free", make_trajectory, [[0.0], [2.0]], Limits((1.0,), (1.0,)), world=world)


def test_waypoints_that_repeat_are_one():
    limits = Limits((1.0, 1.0), (2.0, 2.0))
    once = make_trajectory([[0, 0], [1, 0], [1, 1]], limits)
    twice = make_trajectory([[0, 0], [0, 0], [1, 0], [1, 0], [1, 1]], limits)
    np.testing.assert_array_equal(once.positions, twice.positions)
    # As sums leave them: without length a piece would take for ever.
    nearly = make_trajectory([[0, 0], [1e-13, 0], [1, 0], [1, 1], [1, 1 + 1e-12]], limits)
    np.testing.assert_allclose(nearly.positions, once.positions, atol=1e-9)
    assert nearly.positions[-1, 1] == pytest.approx(1 + 1e-12, abs=1e-15)


@pytest.mark.parametrize("path", [[[0.3, 0.4]], [[0.3, 0.4]] * 2, [[0.3, 0.4], [0.3 + 1e-12, 0.4]]])
@pytest.mark.parametrize("jerk", [None, (5.0, 5.0)])
def test_a_robot_that_stays_where_it_is_has_one_state(path, jerk, tmp_path):
    world = FunctionWorld(BoxSpace((0, 0), (1, 1)), lambda q: q[:, 0] < 0.9, 0.01)
    made = make_trajectory(path, Limits((1.0, 1.0), (1.0, 1.0), jerk), world=world)
    assert made.duration == 0.0
    assert made.at([0.0, 0.0]).tolist() == [[0.3, 0.4]] * 2
    assert made.positions.tolist() == [[0.3, 0.4]]
    made.save(tmp_path / "still.json")
    made.save(tmp_path / "still.csv")
    assert load_trajectory(tmp_path / "still.json").positions.tolist() == [[0.3, 0.4]]
    refused(NotAvailable, "stands", make_trajectory, [[0.95, 0.4]], made.limits, world=world)


@pytest.mark.parametrize(("path", "options", "said"), [
    (np.empty((0, 2)), {}, "somewhere"), (InMotion([[0, 0], [0, 0]], start=(0.1, 0.0)), {}, "somewhere"),
    ([[0, 0, 0]], {}, r"shape \(n, 2\)"), ([[0, 0], [np.nan, 1]], {}, "finite"),
    ([[0, 0], [1, 1]], {"deviation": -1.0}, "deviation"), ([[0, 0], [1, 1]], {"step": 0.0}, "step"),
    ([[0, 0], [1, 1]], {"names": ["a"]}, "names"), ([[0, 0], [1, 1]], {"step": 1e-9}, "longer steps"),
])  # fmt: skip
def test_bad_input_is_named(path, options, said):
    refused(InvalidValue, said, make_trajectory, path, Limits((1.0, 1.0), (1.0, 1.0)), **options)
