"""Trajectories as others read and make them: rosbags for ROS 2, ur_rtde for URScript, toppra for the fastest law."""

import re

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import BrokenFile
from evenroad.trajectory import Limits, make_trajectory, save_trajectory
from evenroad.trajectory.waypoints_file import read_waypoints

PATH = np.random.default_rng(4).uniform(-1.5, 1.5, (5, 6))
LIMITS = Limits((3.15,) * 3 + (3.2,) * 3, (6.0,) * 6)
FASTEST = 3.14
"""The most that ur_rtde lets a movej be told [rad/s]."""


@pytest.fixture(scope="module")
def trajectory():
    return make_trajectory(PATH, LIMITS, names=[f"joint_{i}" for i in range(6)])


def message_of(bag):
    """The connection and the message of a bag that has one."""
    stores = pytest.importorskip("rosbags.typesys")
    store = stores.get_typestore(stores.Stores.ROS2_JAZZY)
    reader = pytest.importorskip("rosbags.rosbag2.storage_mcap").McapReader(bag)
    reader.open()
    [(connection, _, raw)] = list(reader.messages(reader.connections))
    reader.close()
    return connection, store.deserialize_cdr(raw, connection.msgtype)


def test_a_bag_is_read_back_by_rosbags(trajectory, tmp_path):
    pytest.importorskip("rosbags")
    save_trajectory(tmp_path / "t.mcap", trajectory)
    connection, message = message_of(tmp_path / "t.mcap")
    assert connection.topic == "/joint_trajectory"
    assert tuple(message.joint_names) == trajectory.names
    np.testing.assert_array_equal([p.positions for p in message.points], trajectory.positions)
    np.testing.assert_array_equal([p.velocities for p in message.points], trajectory.velocities)
    times = [p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]
    np.testing.assert_allclose(times, trajectory.times, atol=1e-9)


def test_a_bag_is_read_back_as_waypoints(trajectory, tmp_path):
    pytest.importorskip("rosbags")
    save_trajectory(tmp_path / "t.mcap", trajectory)
    found = read_waypoints(tmp_path / "t.mcap")
    np.testing.assert_array_equal(found.positions, trajectory.positions)
    assert found.joints == trajectory.names
    (tmp_path / "t.mcap").write_bytes((tmp_path / "t.mcap").read_bytes()[:200])
    with pytest.raises(BrokenFile, match=r"t\.mcap"):
        read_waypoints(tmp_path / "t.mcap")


def test_the_moves_of_a_program_are_those_that_ur_rtde_writes(trajectory, tmp_path):
    rtde = pytest.importorskip("rtde_control")
    save_trajectory(tmp_path / "t.movej.script", trajectory)
    theirs, entry = rtde.Path(), rtde.PathEntry
    for q in PATH[1:]:
        values = [*q, FASTEST, min(LIMITS.acceleration), 0.0]
        theirs.addEntry(entry(entry.MoveJ, entry.PositionJoints, values))
    assert _moves((tmp_path / "t.movej.script").read_text()) == pytest.approx(_moves(theirs.toScriptCode()), abs=1e-5)


def _moves(script):
    """Return the numbers of all movej of a program: six joints, then a, v and r."""
    calls = re.findall(r"movej\(\[(.*?)\],\s*a=(.*?),\s*v=(.*?),\s*r=(.*?)\)", script)
    return np.array([[float(x) for x in (*joints.split(","), *rest)] for joints, *rest in calls])


def test_it_is_as_fast_as_toppra_on_the_same_corners():
    toppra = pytest.importorskip("toppra")
    from evenroad._native.trajectory import rounded
    from evenroad.trajectory.timing import fastest

    curve = rounded(PATH, np.full(len(PATH), 0.05))
    ours = fastest(curve, LIMITS).duration
    s = np.linspace(0.0, curve.length, 1500)
    spline = toppra.SplineInterpolator(s, curve.at(s).positions)
    velocity, push = np.array(LIMITS.velocity), np.array(LIMITS.acceleration)
    constraints = [
        toppra.constraint.JointVelocityConstraint(np.column_stack([-velocity, velocity])),
        toppra.constraint.JointAccelerationConstraint(np.column_stack([-push, push])),
    ]
    theirs = toppra.algorithm.TOPPRA(constraints, spline, gridpoints=np.linspace(0, curve.length, 1500))
    assert ours == pytest.approx(theirs.compute_trajectory().duration, rel=0.02)


def test_a_bag_of_a_car_is_a_nav_path_for_rosbags(tmp_path):
    pytest.importorskip("rosbags")
    box = [(-0.45, -0.31), (0.45, -0.31), (0.45, 0.31), (-0.45, 0.31)]
    world = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1).world(footprint=box, turning_radius=0.5)
    made = er.plan(world, (2, 2, 0), (4, 4, 2)).trajectory(speed=1.0, step=0.05)
    made.save(tmp_path / "go.mcap")
    connection, message = message_of(tmp_path / "go.mcap")
    assert (connection.topic, connection.msgtype) == ("/plan", "nav_msgs/msg/Path")
    for each, time, (x, y, angle) in zip(message.poses, made.times, made.positions, strict=True):
        assert each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec == pytest.approx(time, abs=1e-9)
        assert (each.pose.position.x, each.pose.position.y) == (x, y)
        turned = each.pose.orientation
        np.testing.assert_allclose([turned.z, turned.w], [np.sin(angle / 2), np.cos(angle / 2)], atol=1e-15)
