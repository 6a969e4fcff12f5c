"""The map node of examples/ros2 without ROS: rosbags' messages in, and what goes out compared byte for byte."""

import math
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue
from tests_peers.ros2_messages import Cdr, _header, _module, _pose, _sent, _written
from tests_peers.ros2_messages import _folder as _folder
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
    given = _module("messages").grid_map(_sent(store, _occupancy(make, cells, yaw=0.3)))
    read = er.load_map(tmp_path / "map.yaml")
    np.testing.assert_array_equal(given.occupied, read.occupied)
    np.testing.assert_array_equal(given.unknown, read.unknown)
    assert given.frame.resolution == 0.05
    assert given.frame.origin == read.frame.origin
    assert given.frame.yaw == pytest.approx(0.3, abs=1e-12)


def test_unknown_cells_may_be_free(make):
    cells = np.array([[-1, 0], [70, 60]])
    messages = _module("messages")
    free = messages.grid_map(_occupancy(make, cells), unknown_is_free=True)
    np.testing.assert_array_equal(free.occupied, [[True, False], [False, False]])
    np.testing.assert_array_equal(messages.grid_map(_occupancy(make, cells)).occupied[1], [True, False])


def test_a_map_that_does_not_lie_flat_is_refused(make):
    message = _occupancy(make, np.zeros((2, 2)))
    message.info.origin.orientation.x = 0.1
    with pytest.raises(InvalidValue, match="flat"):
        _module("messages").grid_map(message)


def test_a_path_is_written_byte_for_byte(store, make):
    path = np.array([[0.5, 0.25], [1.5, 0.25], [1.5, 3.0]])
    message = _module("messages").path_message(make, path, "map", (12, 34), -2.0)
    cdr = Cdr().header(12, 34, "map").put("I", 3)
    for (x, y), angle in zip(path.tolist(), (0.0, 0.5 * math.pi, -2.0), strict=True):
        cdr.header(12, 34, "map").put("d", x, y, 0.0, 0.0, 0.0, math.sin(0.5 * angle), math.cos(0.5 * angle))
    assert _written(store, message) == cdr.message()


def test_the_map_planner_answers_with_a_free_path(store, make):
    cells = np.zeros((60, 60))
    cells[30, :45] = 100
    grid = _sent(store, _occupancy(make, cells))
    start, goal = _pose(make, (1.4, -1.4, 0.0)), _pose(make, (1.4, 0.4, 0.0), (0.0, 0.0, 1.0, 0.0))
    path, why = _module("map_planner").answer(make, grid, start, goal, 0.2, (1, 2))
    assert "path" in why
    path = _sent(store, path)
    assert path.header.frame_id == "map"
    places = np.array([[each.pose.position.x, each.pose.position.y] for each in path.poses])
    np.testing.assert_allclose(places[[0, -1]], [[1.4, -1.4], [1.4, 0.4]])
    world = _module("messages").grid_map(grid).world(0.2)
    assert world.motion_valid(places[:-1], places[1:]).all()
    assert path.poses[-1].pose.orientation.z == pytest.approx(1.0)
    shut, why = _module("map_planner").answer(make, grid, start, goal, 0.6, (1, 2))
    assert shut is None
    assert why


@pytest.fixture
def node(monkeypatch):
    """The map's node as it runs: its subscriptions by topic, what it says, and what it publishes."""
    node = SimpleNamespace(takes={}, said=[], published=[])
    log = SimpleNamespace(**dict.fromkeys(("info", "warning", "error"), node.said.append))
    clock = SimpleNamespace(now=lambda: SimpleNamespace(to_msg=lambda: SimpleNamespace(sec=1, nanosec=2)))
    wired = SimpleNamespace(
        declare_parameter=lambda name, value: SimpleNamespace(value=value),
        create_publisher=lambda *_: SimpleNamespace(publish=node.published.append),
        create_subscription=lambda kind, topic, callback, quality: node.takes.update({topic: callback}),
        get_logger=lambda: log,
        get_clock=lambda: clock,
    )
    quality = SimpleNamespace(DurabilityPolicy=SimpleNamespace(TRANSIENT_LOCAL=1), QoSProfile=lambda **_: None)
    kinds = SimpleNamespace(PoseStamped=0, PoseWithCovarianceStamped=0, OccupancyGrid=0, Path=0)
    ros = SimpleNamespace(init=lambda: None, create_node=lambda _: wired, spin=lambda _: None)
    for name, module in {
        "rclpy": ros,
        "rclpy.qos": quality,
        "geometry_msgs.msg": kinds,
        "nav_msgs.msg": kinds,
    }.items():
        monkeypatch.setitem(sys.modules, name, module)
    for name in ("geometry_msgs", "nav_msgs"):
        monkeypatch.setitem(sys.modules, name, SimpleNamespace(msg=kinds))
    module = _module("map_planner")
    monkeypatch.setattr(module, "answer", lambda make, *given: ("a path", "found"))
    module.main()
    node.answers = lambda answer: monkeypatch.setattr(module, "answer", answer)
    return node


def _in_frame(frame, pose=None):
    return SimpleNamespace(header=SimpleNamespace(frame_id=frame), pose=SimpleNamespace(pose=pose))


def test_the_map_node_plans_within_one_frame_only(node):
    node.takes["map"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("map"))
    assert (node.said, node.published) == (["no start yet"], [])
    node.takes["initialpose"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("odom"))
    assert node.said[1:] == ["map, start and goal are in different frames: map, odom"]
    assert node.published == []
    node.takes["goal_pose"](_in_frame("map"))
    assert node.published == ["a path"]


def test_the_map_node_outlives_what_it_refuses(node):
    def refuse(*_):
        raise InvalidValue("the map must lie flat")

    node.answers(refuse)
    node.takes["map"](_in_frame("map"))
    node.takes["initialpose"](_in_frame("map"))
    node.takes["goal_pose"](_in_frame("map"))
    assert (node.said, node.published) == (["the map must lie flat"], [])
