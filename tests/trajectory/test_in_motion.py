"""Trajectories that begin or end in motion."""

from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory import InMotion, Limits, TipLimits, limits_of, make_trajectory

PATH = np.array([[0.0, 0.0, 0.0], [1.0, -0.4, 0.3], [0.6, 0.8, -0.2], [1.5, 1.0, 0.4]])
LIMITS = Limits((2.0, 2.0, 2.0), (8.0, 6.0, 10.0))
START, GOAL = np.array([0.5, 0.9, -0.4]), np.array([-0.3, 0.0, 1.2])


def require_smooth(trajectory, limits):
    """Positions, velocities and accelerations are derivatives of each other, within the limits."""
    step = np.diff(trajectory.times)
    assert np.ptp(step) < 1e-12
    jumps = np.abs(np.diff(trajectory.velocities, axis=0))
    assert (jumps <= np.array(limits.acceleration) * step[:, np.newaxis] * (1.0 + 1e-9)).all()
    means = np.diff(trajectory.positions, axis=0) / step[:, np.newaxis]
    between = 0.5 * (trajectory.velocities[1:] + trajectory.velocities[:-1])
    assert (np.abs(means - between) <= np.array(limits.acceleration) * step[:, np.newaxis]).all()
    assert (np.abs(trajectory.velocities) <= np.array(limits.velocity) * (1.0 + 1e-9)).all()


@pytest.mark.parametrize(("start", "goal"), [(START, GOAL), (START, None), (None, GOAL)])
def test_it_has_the_velocities_that_are_asked_for(start, goal):
    trajectory = make_trajectory(InMotion(PATH, start, goal), LIMITS)
    for row, given in ((0, start), (-1, goal)):
        wanted = np.zeros(3) if given is None else given
        np.testing.assert_allclose(trajectory.velocities[row], wanted, atol=1e-9)
        np.testing.assert_allclose(trajectory.positions[row], PATH[row], atol=1e-9)
    require_smooth(trajectory, LIMITS)


def test_a_path_that_begins_along_the_velocity_needs_no_way_in_and_takes_less_time():
    rest = make_trajectory(PATH, LIMITS)
    moving = make_trajectory(InMotion(PATH, (PATH[1] - PATH[0]) / np.linalg.norm(PATH[1] - PATH[0])), LIMITS)
    assert len(moving.waypoints) == len(PATH)
    assert moving.duration < rest.duration - 0.05
    require_smooth(moving, LIMITS)


def test_who_is_at_full_speed_at_start_and_goal_is_so_all_along():
    fast = np.array([2.0, 0.0, 0.0])
    trajectory = make_trajectory(InMotion([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]], fast, fast), LIMITS)
    assert trajectory.duration == pytest.approx(1.5, abs=1e-6)
    assert trajectory.velocities == pytest.approx(np.tile(fast, (len(trajectory.times), 1)), abs=1e-9)


def test_it_keeps_the_acceleration_of_a_tip():
    robot = er.load_robot("ur5")
    limits = replace(limits_of(robot), tip=TipLimits(robot, "tool0", acceleration=3.0))
    path = np.array([[0.0, -1.5, 1.0, -1.0, 0.5, 0.0], [1.0, -1.0, 0.5, -1.5, 0.8, 0.4]])
    trajectory = make_trajectory(InMotion(path, [0.3, 0.2, -0.1, 0.0, 0.0, 0.1]), limits)
    assert 0.9 < trajectory.highest["tip acceleration"] <= 1.0
    np.testing.assert_allclose(trajectory.velocities[0], [0.3, 0.2, -0.1, 0.0, 0.0, 0.1], atol=1e-9)


def test_it_goes_on_farther_where_a_tip_lets_it_stop_more_slowly():
    robot = er.load_robot("ur5")
    path = np.array([[0.0, -1.5, 1.0, -1.0, 0.5, 0.0], [0.0, -1.0, 0.5, -1.5, 0.8, 0.4]])
    plain = limits_of(robot)
    slow = replace(plain, tip=TipLimits(robot, "tool0", acceleration=0.3))
    velocity = [0.4, 0.0, 0.0, 0.0, 0.0, 0.0]
    ways = [make_trajectory(InMotion(path, velocity), each) for each in (plain, slow)]
    assert ways[1].waypoints[1, 0] > 2.0 * ways[0].waypoints[1, 0] > 0.0
    assert ways[1].highest["tip acceleration"] <= 1.0
    np.testing.assert_allclose(ways[1].velocities[0], velocity, atol=1e-9)


def test_a_plan_is_driven_from_a_moving_start():
    result = er.plan("box-reach", "home", "inside", robot="ur5")
    velocity = [0.2, 0.0, 0.1, 0.0, 0.0, -0.1]
    trajectory = result.trajectory(start_velocity=velocity)
    assert trajectory.proof == "certified"
    np.testing.assert_allclose(trajectory.velocities[0], velocity, atol=1e-9)
    np.testing.assert_allclose(trajectory.velocities[-1], 0.0, atol=1e-9)


def test_what_cannot_be_driven_is_refused(tmp_path):
    with pytest.raises(InvalidValue, match=r"velocity at the start of joint 1 must be up to 2, got 2\.5"):
        make_trajectory(InMotion(PATH, [0.0, 2.5, 0.0]), LIMITS)
    with pytest.raises(InvalidValue, match="the velocity at the goal must be 3 finite"):
        make_trajectory(InMotion(PATH, None, [0.0, 1.0]), LIMITS)
    with pytest.raises(InvalidValue, match="with limits of jerk the robot must be at rest at the start"):
        make_trajectory(InMotion(PATH, START), replace(LIMITS, jerk=(100.0,) * 3))
    # Along the path, but too fast to stop at its end.
    with pytest.raises(NotAvailable, match="the velocity at the start is too fast for the path"):
        make_trajectory(InMotion([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]], [1.9, 0.0, 0.0]), LIMITS)
    result = er.plan("box-reach", "home", "inside", robot="ur5")
    moving = result.trajectory(start_velocity=[0.2, 0.0, 0.1, 0.0, 0.0, -0.1])
    with pytest.raises(InvalidValue, match="a UR arm starts and stops at rest"):
        moving.save(tmp_path / "go.script")
