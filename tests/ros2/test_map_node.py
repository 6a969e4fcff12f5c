"""The map's node as it runs, in its own process, where ROS's wheels are installed."""

import math
import signal

import numpy as np
import pytest

from tests.ros2 import running

WALL = np.zeros((60, 60))
WALL[30, :45] = 100


@pytest.fixture(scope="module")
def node():
    with running.asking() as node:
        yield node


def test_a_map_and_a_request_are_answered_and_a_bad_map_changes_nothing(node, tmp_path):
    from nav_msgs.msg import OccupancyGrid, Path
    from nav_msgs.srv import GetPlan

    log, paths = tmp_path / "log", []
    maps = running.publisher(node, OccupancyGrid, "/robot1/map", latched=True)
    node.create_subscription(Path, "/robot1/plan", paths.append, 1)
    client = node.create_client(GetPlan, "/robot1/get_plan")
    request = running.plan_request(running.stamped(0.5, 0.5), running.stamped(0.5, 2.5))
    maps.publish(running.occupancy(WALL))
    with running.started(log, "map", "-p", "robot_radius:=0.2", "-r", "__ns:=/robot1") as process:
        assert running.wait_for(node, client.service_is_ready)
        assert running.wait_for(node, lambda: "map of 60 x 60" in log.read_text())
        path = running.answered(node, client, request).plan
        assert path.header.frame_id == "map"
        points = np.array([[each.pose.position.x, each.pose.position.y] for each in path.poses])
        np.testing.assert_allclose(points[[0, -1]], [[0.5, 0.5], [0.5, 2.5]])
        assert running.wait_for(node, lambda: paths)
        short = running.occupancy(WALL)
        short.data = short.data[:-1]
        bad = (running.occupancy(WALL, resolution=math.nan), running.occupancy(WALL, frame=""), short)
        for refused, each in enumerate(bad, 1):
            # One after the other: the node keeps the last map alone.
            maps.publish(each)
            assert running.wait_for(node, lambda n=refused: log.read_text().count("[ERROR]") == n), log.read_text()
        assert len(running.answered(node, client, request).plan.poses) == len(path.poses)
        in_odom = running.plan_request(running.stamped(0.5, 0.5, "odom"), running.stamped(0.5, 2.5))
        assert not running.answered(node, client, in_odom).plan.poses
        process.send_signal(signal.SIGTERM)
        assert process.wait(20.0) == 0
    text = log.read_text()
    for said in ("got nan", "no frame_id", "60 x 60 = 3600 cells, got 3599", "TF_ERROR: the start is in frame 'odom'"):
        assert said in text
