"""``evenroad ros2``: what ROS is given, and what is said where there is no ROS."""

import sys

import pytest

from evenroad.cli.read_options import read_options
from evenroad.cli.ros2 import Ros2
from evenroad.errors import InvalidValue


def test_words_behind_ros_args_are_those_of_ros():
    words = ["map", "--ros-args", "-p", "robot_radius:=0.25", "-r", "__ns:=/robot1", "--", "--help"]
    assert read_options("ros2", Ros2, words) == Ros2(node="map", ros_args=tuple(words[2:]))
    assert read_options("ros2", Ros2, ["map"]) == Ros2(node="map")


def test_other_words_are_refused():
    with pytest.raises(InvalidValue, match="NODE must be one of map, arm"):
        read_options("ros2", Ros2, ["car"])
    with pytest.raises(InvalidValue, match="no use for the word 'robot_radius:=0.25'"):
        read_options("ros2", Ros2, ["map", "robot_radius:=0.25"])


def test_without_ros_the_command_says_what_to_install(refuse, monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    said = refuse("ros2", "map", "--ros-args", "-p", "robot_radius:=0.25")
    assert "pip install 'evenroad[ros2]'" in said
    assert "source a workspace of ROS 2" in said
