"""More waypoints on the same way take no longer, from two of them to a hundred thousand."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.robot import load_robot
from evenroad.trajectory import Limits, TipLimits, load_dynamics, make_trajectory
from tests.trajectory.heavy_arm import urdf

DIM = 4
PLAIN = Limits((1.0, 2.0, 0.7, 3.0), (2.0, 3.0, 1.0, 4.0))


@pytest.fixture(scope="module")
def limits(tmp_path_factory):
    """Limits of all kinds, each with the step of its trajectories."""
    file = tmp_path_factory.mktemp("arm") / "arm.urdf"
    file.write_text(urdf())
    robot = load_robot(file)
    tip = TipLimits(robot, robot.links[-1], 0.4, 1.5)
    return {
        "joints": (PLAIN, 1e-3),
        "slow": (replace(PLAIN, velocity=(1e-3,) * DIM, acceleration=(1e3,) * DIM), 1.0),
        "slower": (replace(PLAIN, velocity=(1e-5,) * DIM, acceleration=(1e5,) * DIM), 100.0),
        "braking": (replace(PLAIN, deceleration=(0.5, 0.5, 2.0, 2.0)), 1e-3),
        "jerk": (replace(PLAIN, jerk=(60.0,) * DIM), 5e-3),
        "tip": (replace(PLAIN, tip=tip), 2e-3),
        "torque": (replace(PLAIN, torque=load_dynamics(robot, file)), 2e-3),
        "tip and jerk": (replace(PLAIN, tip=tip, jerk=(60.0,) * DIM), 5e-3),
    }


def polyline(seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.0, 1.0, (int(rng.integers(2, 7)), DIM))


def with_more(path, count, rng):
    """The same path with so many waypoints, anywhere on it: some are within rounding of each other."""
    lengths = np.linalg.norm(np.diff(path, axis=0), axis=1)
    where = rng.choice(len(lengths), count - len(path), p=lengths / lengths.sum())
    shares = rng.random(len(where)) ** rng.choice([1.0, 8.0], len(where))
    rows = [path[:1]]
    for i, step in enumerate(np.diff(path, axis=0)):
        rows += [path[i] + np.sort(shares[where == i])[:, None] * step, path[i + 1 : i + 2]]
    return np.concatenate(rows)


@pytest.mark.parametrize("kind", ["joints", "slow", "slower", "braking", "jerk", "tip", "torque", "tip and jerk"])
@pytest.mark.parametrize("seed", [0, 1])
def test_waypoints_on_a_path_do_not_change_how_long_it_takes(kind, seed, limits):
    within, step = limits[kind]
    path, rng = polyline(seed), np.random.default_rng(seed)
    once = make_trajectory(path, within, step=step)
    for count in (len(path) + 1, 100_000 if seed == 0 else 1000):
        more = make_trajectory(with_more(path, count, rng), within, step=step)
        assert more.duration == pytest.approx(once.duration, rel=1e-6)
        # To a whole step this holds of what is nearly as long, too: the places where it is at every time say more.
        np.testing.assert_allclose(more.positions, once.positions, atol=1e-9)


def smooth(count):
    """A recorded motion of six joints with so many waypoints."""
    s = np.linspace(0.0, 5.0, count)
    return np.stack([0.5 * np.sin((1.0 + 0.2 * k) * s + k) for k in range(6)], axis=1)


def test_a_recorded_curve_takes_as_long_with_more_waypoints():
    within = Limits((3.15,) * 3 + (3.2,) * 3, (6.3,) * 3 + (6.4,) * 3)
    durations = [make_trajectory(smooth(count), within, step=4e-3).duration for count in (1000, 2000, 20_000)]
    assert max(durations) <= 1.002 * min(durations)


def test_two_lines_at_a_thousandth_of_a_radian_a_second_take_their_length():
    within = Limits((1e-3, 1e-3), (1000.0, 1000.0))
    assert make_trajectory([[0, 0], [6, 0]], within, step=1.0).duration == pytest.approx(6000.0, abs=1.0)
    # The corner is an arc: a little shorter than both lines, and both joints move at once.
    assert 3900.0 < make_trajectory([[0, 0], [2, 0], [2, 2]], within, step=1.0).duration < 4000.0


@pytest.mark.parametrize("gap", [1e-3, 1e-5, 1e-7, 2e-9, 1e-11, 0.0])
@pytest.mark.parametrize("scale", [1.0, 1e-2, 1e3])
def test_waypoints_beside_each_other_are_a_path_like_any_other(gap, scale):
    near = np.array([[0, 0], [1, 0], [1, gap], [1 + gap, gap], [1, 1]]) * scale
    within = Limits((scale, 2.0 * scale), (2.0 * scale, 3.0 * scale))
    stopped = make_trajectory(np.array([[0, 0], [1, 0], [1, 1]]) * scale, within, deviation=0.0).duration
    assert 2.0 < make_trajectory(near, within).duration <= stopped + 0.1
