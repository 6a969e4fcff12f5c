"""Parts of messages: types of ROS, stamps, quaternions."""

import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from evenroad.errors import InvalidValue, NotAvailable
from evenroad.ros2.messages import heading, require_recent, ros_message, ros_type, seconds_of, time_message
from evenroad.trajectory import Limits, make_trajectory
from tests.ros2.stand_ins import made, pose


def test_messages_of_ros_get_lists(monkeypatch):
    """Setters of ROS refuse arrays."""
    types = SimpleNamespace(Point=lambda **fields: fields)
    monkeypatch.setitem(sys.modules, "pretended_msgs", SimpleNamespace(msg=types))
    monkeypatch.setitem(sys.modules, "pretended_msgs.msg", types)
    message = ros_message("pretended_msgs/msg/Point", positions=np.array([1.0, 2.0]), effort=np.zeros(0))
    assert message == {"positions": [1.0, 2.0], "effort": []}
    assert type(message["positions"]) is list
    with pytest.raises(ImportError, match="pretended_msgs has no Line"):
        ros_type("pretended_msgs/msg/Line")


def test_a_trajectory_is_a_message_where_ros_is():
    trajectory = make_trajectory([[0.0, 0.0], [1.0, 0.5]], Limits((1.0, 1.0), (2.0, 2.0)), names=("a", "b"))
    try:
        import trajectory_msgs  # noqa: F401
    except ImportError:
        with pytest.raises(NotAvailable, match=r"pip install 'evenroad\[ros2\]'"):
            trajectory.to_ros()
        return
    message = trajectory.to_ros(["b", "a"])
    assert message.joint_names == ["b", "a"]
    np.testing.assert_array_equal([point.positions for point in message.points], trajectory.positions[:, ::-1])


@pytest.mark.parametrize("seconds", [0.0, 1.0, 12.000000034, 1795914073.25])
def test_seconds_become_stamps_and_back(seconds):
    assert seconds_of(time_message(made, seconds)) == pytest.approx(seconds, rel=1e-15, abs=1e-9)
    assert 0 <= time_message(made, 0.9999999999).nanosec < 1_000_000_000


@pytest.mark.parametrize("angle", [0.0, 1.0, -3.0, math.pi, 5.0, -7.0])
def test_a_heading_is_the_angle_within_one_turn(angle):
    found = heading(pose(angle=angle).orientation, "it")
    assert -math.pi < found <= math.pi
    assert math.cos(found - angle) == pytest.approx(1.0)


def test_stamps_that_are_too_old_are_refused_and_zero_is_now():
    require_recent([("the goal", 0.0), ("the start", 95.0)], now=100.0, oldest=5.0)
    require_recent([("the goal", 1.0)], now=100.0, oldest=0.0)
    with pytest.raises(InvalidValue, match=r"the goal is 5\.500 s old, more than stale_after = 5 s"):
        require_recent([("the goal", 94.5)], now=100.0, oldest=5.0)
