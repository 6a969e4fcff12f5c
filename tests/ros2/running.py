"""Nodes that run as processes of their own, and a node of rclpy beside them, on the loopback alone."""

import os
import signal
import subprocess
import sys
import time
import warnings
from contextlib import contextmanager

import numpy as np
import pytest

PATIENCE = 60.0
"""Largest time for a node to start, on a busy machine [s]."""


def environment():
    """A domain of this process, whose traffic stays on this machine."""
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(os.getpid() % 100),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "RCUTILS_LOGGING_USE_STDOUT": "1",
    }


@contextmanager
def asking():
    """A node of this process: its publishers, clients and a call that spins."""
    rclpy = pytest.importorskip("rclpy", reason="the extra ros2 is not installed")
    pytest.importorskip("rclpy.executors", reason="the extra ros2 is not installed")
    os.environ.update(environment())
    with warnings.catch_warnings():
        # Of the parser that rclpy brings.
        warnings.simplefilter("ignore", DeprecationWarning)
        rclpy.init()
        node = rclpy.create_node("asking")
    # One for all calls: rclpy.spin_once adds the node to one, and takes it away, each time.
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    try:
        yield node
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.shutdown()


@contextmanager
def started(log, kind, *arguments):
    """``evenroad ros2 KIND --ros-args ...`` as a process, which writes its log to a file."""
    with open(log, "w") as out:
        command = [sys.executable, "-m", "evenroad", "ros2", kind, "--ros-args", *arguments]
        process = subprocess.Popen(command, env=environment(), stdout=out, stderr=subprocess.STDOUT)
        try:
            yield process
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            assert process.wait(20.0) in (0, -signal.SIGKILL), log.read_text()
    assert "Traceback" not in log.read_text(), log.read_text()


def publisher(node, kind, topic, *, latched=False):
    from rclpy.qos import DurabilityPolicy, QoSProfile

    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    return node.create_publisher(kind, topic, QoSProfile(depth=10, durability=durability))


def wait_for(node, done, seconds=PATIENCE):
    """Spin until something is done, and return whether it was."""
    end = time.monotonic() + seconds
    while not done() and time.monotonic() < end:
        node.executor.spin_once(timeout_sec=0.05)
    return bool(done())


def answered(node, client, request, seconds=PATIENCE):
    """The answer of a service, or None if it was lost."""
    future = client.call_async(request)
    # rclpy's spin_until_future_complete takes longer each time: it keeps a task for every earlier future.
    wait_for(node, future.done, seconds)
    return future.result() if future.done() else None


def occupancy(cells, frame="map", resolution=0.05):
    from nav_msgs.msg import OccupancyGrid

    grid = OccupancyGrid()
    grid.header.frame_id = frame
    grid.info.height, grid.info.width = cells.shape
    grid.info.resolution = resolution
    grid.info.origin.orientation.w = 1.0
    grid.data = cells.astype(np.int8).ravel().tolist()
    return grid


def stamped(x, y, frame="map"):
    from geometry_msgs.msg import PoseStamped

    pose = PoseStamped()
    pose.header.frame_id = frame
    pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.w = float(x), float(y), 1.0
    return pose


def plan_request(start, goal):
    from nav_msgs.srv import GetPlan

    return GetPlan.Request(start=start, goal=goal)
