"""Bags that we write, read by the library mcap and by ROS's own CDR."""

import numpy as np
import pytest

import evenroad as er

pytest.importorskip("rclpy", reason="the extra ros2 is not installed")
reader = pytest.importorskip("mcap.reader", reason="the extra ros is not installed")


# Of the parser that rclpy brings.
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_trajectory_in_a_bag_is_the_message_that_to_ros_returns(tmp_path):
    from rclpy.serialization import deserialize_message
    from trajectory_msgs.msg import JointTrajectory

    trajectory = er.plan("box-reach", "home", "inside", robot="ur5").trajectory(speed=0.5)
    trajectory.save(tmp_path / "reach.mcap")
    with open(tmp_path / "reach.mcap", "rb") as file:
        schema, channel, message = next(reader.make_reader(file).iter_messages())
    assert (schema.name, channel.message_encoding) == ("trajectory_msgs/msg/JointTrajectory", "cdr")
    read, expected = deserialize_message(message.data, JointTrajectory), trajectory.to_ros()
    assert read == expected
    assert read.joint_names == list(trajectory.names)
    positions = np.array([point.positions for point in read.points])
    np.testing.assert_array_equal(positions, trajectory.positions)
    last = read.points[-1].time_from_start
    assert last.sec + 1e-9 * last.nanosec == pytest.approx(trajectory.duration, abs=1e-8)
