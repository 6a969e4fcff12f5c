"""Accelerations and decelerations of their own: by hand along a line, and by the states along corners."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.trajectory import InMotion, Limits, load_trajectory, make_trajectory
from evenroad.trajectory.urscript import movej_script
from tests.refused import refused

STEP = 1e-3


@pytest.mark.parametrize(
    ("way", "faster", "slower"), [(4.0, 2.0, 0.5), (4.0, 0.5, 2.0), (0.3, 3.0, 1.0), (0.3, 1.0, 3.0)]
)
def test_a_line_is_driven_as_by_hand(way, faster, slower):
    made = make_trajectory([[0.0], [-way]], Limits((1.0,), (faster,), deceleration=(slower,)), step=STEP)
    # A triangle where the line is too short for the largest speed, else a trapezoid.
    peak = min(1.0, np.sqrt(2.0 * way * faster * slower / (faster + slower)))
    cruise = way - 0.5 * peak**2 * (1.0 / faster + 1.0 / slower)
    by_hand = peak / faster + peak / slower + cruise / peak
    assert made.duration == pytest.approx(by_hand, rel=1e-3, abs=STEP)
    assert made.accelerations.min() == pytest.approx(-faster, rel=5e-3)
    assert made.accelerations.max() == pytest.approx(slower, rel=5e-3)


def used(made):
    """The largest accelerations of states that speed up, and of those that slow down, as shares of the limits."""
    slows, moves = made.accelerations * made.velocities < 0.0, made.velocities != 0.0
    pushes = np.abs(made.accelerations)
    most = ((made.limits.acceleration, moves & ~slows), (made.limits.stopping, slows))
    return tuple(float(np.max(pushes / np.array(row), where=where, initial=0.0)) for row, where in most)


@pytest.mark.parametrize("seed", range(8))
def test_no_joint_slows_down_or_speeds_up_by_more_than_it_may(seed):
    rng = np.random.default_rng(seed)
    path = rng.uniform(-2.0, 2.0, (6, 3))
    faster, slower = (tuple(rng.uniform(0.5, 5.0, 3)) for _ in range(2))
    within = Limits((1.5, 2.0, 1.0), faster, deceleration=slower, jerk=(60.0,) * 3 if seed % 4 == 3 else None)
    made = make_trajectory(path, within, step=STEP)
    assert max(used(made)) <= 1.0
    if within.jerk is None:
        assert max(used(made)) > 0.99
    # It lies between those of the larger and of the smaller acceleration.
    either = [make_trajectory(path, replace(within, acceleration=tuple(map(pick, faster, slower)), deceleration=None))
              for pick in (max, min)]  # fmt: skip
    assert either[0].duration - 0.01 <= made.duration <= either[1].duration + 0.01


def test_without_one_a_joint_slows_down_as_it_speeds_up():
    path, within = [[0, 0], [1, 0], [1, 1]], Limits((1.0, 2.0), (2.0, 3.0))
    once, same = (make_trajectory(path, each) for each in (within, replace(within, deceleration=(2.0, 3.0))))
    assert once.positions.tobytes() == same.positions.tobytes()


def test_a_robot_in_motion_has_the_way_on_that_it_needs_to_stop():
    within = Limits((1.0, 1.0), (5.0, 5.0), deceleration=(0.4, 0.4))
    made = make_trajectory(InMotion([[0, 0], [0, 1]], start=(1.0, 0.0)), within, step=STEP)
    assert made.waypoints[1][0] >= 1.0 / (2.0 * 0.4)
    assert max(used(made)) <= 1.0 + 1e-9


def test_it_is_a_share_of_full_speed_kept_in_files_and_the_smaller_one_for_controllers(tmp_path):
    within = Limits((1.0,) * 6, (2.0,) * 6, deceleration=(0.5,) * 6)
    assert within.at_speed(0.5).deceleration == (0.125,) * 6
    made = make_trajectory([[0.0] * 6, [1.0] * 6], within)
    made.save(tmp_path / "go.json")
    assert load_trajectory(tmp_path / "go.json").limits == within
    assert "a=0.5" in movej_script(made)
    refused(InvalidValue, "deceleration", Limits, (1.0,), (1.0,), deceleration=(0.0,))
