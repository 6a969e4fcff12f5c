"""Messages of maps and paths without ROS: rosbags' messages in, and what goes out compared byte for byte."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad.ros2.map_query import MapQuery, plan_on_map
from evenroad.ros2.map_state import MapRobot, MapState, grid_map
from evenroad.ros2.messages import path_message
from tests_peers.ros2_messages import Cdr, _header, _pose, _sent, _written
from tests_peers.ros2_messages import make as make
from tests_peers.ros2_messages import store as store


def _occupancy(make, cells, origin=(1.0, -2.0), yaw=0.0):
    info = make(
        "nav_msgs/msg/MapMetaData",
        resolution=0.05,
        width=cells.shape[1],
        height=cells.shape[0],
        origin=_pose(make, (*origin, 0.0), (0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw))),
    )
    data = cells.astype(np.int8).ravel()
    return make("nav_msgs/msg/OccupancyGrid", header=_header(make, "map"), info=info, data=data)


def test_a_map_is_the_one_that_its_file_is(store, make, tmp_path):
    """The message of a map server and the file that it serves are one map."""
    from PIL import Image

    cells = np.zeros((40, 60), dtype=np.int8)
    cells[10:14, :40] = 100
    cells[30:35, 10:20] = -1
    pixels = np.where(cells == 100, 0, np.where(cells < 0, 205, 254))[::-1].astype(np.uint8)
    Image.fromarray(pixels).save(tmp_path / "map.pgm")
    (tmp_path / "map.yaml").write_text(
        "image: map.pgm\nresolution: 0.05\norigin: [1.0, -2.0, 0.3]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    given = grid_map(_sent(store, _occupancy(make, cells, yaw=0.3)))
    read = er.load_map(tmp_path / "map.yaml")
    np.testing.assert_array_equal(given.occupied, read.occupied)
    np.testing.assert_array_equal(given.unknown, read.unknown)
    assert given.frame.resolution == 0.05
    assert given.frame.origin == read.frame.origin
    assert given.frame.yaw == pytest.approx(0.3, abs=1e-12)


def test_a_path_is_written_byte_for_byte(store, make):
    path = np.array([[0.5, 0.25, 0.0], [1.5, 0.25, 0.5 * math.pi], [1.5, 3.0, -2.0]])
    message = path_message(make, path, "map", 12.000000034)
    cdr = Cdr().header(12, 34, "map").put("I", 3)
    for x, y, angle in path.tolist():
        cdr.header(12, 34, "map").put("d", x, y, 0.0, 0.0, 0.0, math.sin(0.5 * angle), math.cos(0.5 * angle))
    assert _written(store, message) == cdr.message()


def test_a_query_of_messages_is_answered_with_a_free_path(store, make):
    cells = np.zeros((60, 60))
    cells[30, :45] = 100
    grid = _sent(store, _occupancy(make, cells))
    start, goal = _pose(make, (1.4, -1.4, 0.0)), _pose(make, (1.4, 0.4, 0.0), (0.0, 0.0, 1.0, 0.0))
    ends = [make("geometry_msgs/msg/PoseStamped", header=_header(make, "map"), pose=pose) for pose in (start, goal)]
    state = MapState(MapRobot(radius=0.2))
    state.take_map(grid)
    answer = plan_on_map(state, MapQuery(*(_sent(store, each) for each in ends)))
    path = _sent(store, path_message(make, answer.poses, answer.frame, 1.0))
    assert path.header.frame_id == "map"
    places = np.array([[each.pose.position.x, each.pose.position.y] for each in path.poses])
    np.testing.assert_allclose(places[[0, -1]], [[1.4, -1.4], [1.4, 0.4]])
    assert grid_map(grid).world(0.2).motion_valid(places[:-1], places[1:]).all()
    assert path.poses[-1].pose.orientation.z == pytest.approx(1.0)
