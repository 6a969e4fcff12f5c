"""Queries of stamped poses: paths that keep clear of obstacles, and nav2's error codes for what has none."""

import math
import threading
import time

import numpy as np
import pytest

from evenroad._time_limit import Stop
from evenroad.ros2.map_query import CANCELLED, MapQuery, plan_on_map
from evenroad.ros2.map_state import MapRobot, MapState
from evenroad.ros2.messages import path_message
from tests.ros2.stand_ins import made, occupancy, stamped

WALL = np.zeros((60, 60))
WALL[30, :45] = 100
BOX = ((-0.2, -0.1), (0.3, -0.1), (0.3, 0.1), (-0.2, 0.1))


def _state(robot, cells=WALL):
    state = MapState(robot)
    state.take_map(occupancy(cells))
    return state


def test_a_path_goes_around_the_wall_in_steps_that_face_each_other():
    answer = plan_on_map(_state(MapRobot(0.2)), MapQuery(stamped(0.5, 0.5), stamped(0.5, 2.5, 1.0)))
    assert (answer.outcome, answer.frame) == ("NONE", "map")
    points, angles = answer.poses[:, :2], answer.poses[:, 2]
    np.testing.assert_allclose(points[[0, -1]], [[0.5, 0.5], [0.5, 2.5]])
    steps = np.diff(points, axis=0)
    assert np.linalg.norm(steps, axis=1).max() <= 0.05 + 1e-9
    np.testing.assert_allclose(angles[:-1], np.arctan2(steps[:, 1], steps[:, 0]))
    assert angles[-1] == pytest.approx(1.0)
    # The wall ends at x = 2.25, y from 1.5 to 1.55; the oracle is the distance from that rectangle.
    away = np.hypot(np.maximum(points[:, 0] - 2.25, 0.0), np.maximum(np.abs(points[:, 1] - 1.525) - 0.025, 0.0))
    assert away.min() > 0.2 - 1e-9


def test_a_footprint_begins_and_ends_at_the_angles_of_its_poses():
    robot = MapRobot(footprint=BOX, turning_radius=0.3)
    answer = plan_on_map(_state(robot), MapQuery(stamped(0.5, 0.5, 0.3), stamped(0.5, 2.5, -2.0), spacing=0.05))
    assert answer.outcome == "NONE"
    ends = answer.poses[[0, -1]]
    # It turns without jumps, so its last angle may be one turn off.
    ends[:, 2] = np.remainder(ends[:, 2] + math.pi, 2.0 * math.pi) - math.pi
    np.testing.assert_allclose(ends, [[0.5, 0.5, 0.3], [0.5, 2.5, -2.0]], atol=1e-6)


@pytest.mark.parametrize(
    ("ends", "outcome"),
    [
        ((stamped(0.5, 1.52), stamped(0.5, 2.5)), "START_OCCUPIED"),
        ((stamped(0.5, 0.5), stamped(0.5, 1.52)), "GOAL_OCCUPIED"),
        ((stamped(-5.0, 0.5), stamped(0.5, 2.5)), "START_OUTSIDE_MAP"),
        ((stamped(0.5, 0.5), stamped(0.5, 25.0)), "GOAL_OUTSIDE_MAP"),
        ((stamped(0.5, 0.5), stamped(0.5, 2.5, frame="odom")), "TF_ERROR"),
        ((stamped(0.5, 0.5, seconds=80.0), stamped(0.5, 2.5)), "TF_ERROR"),
        ((stamped(math.nan, 0.5), stamped(0.5, 2.5)), "UNKNOWN"),
    ],
)
def test_what_has_no_path_has_the_error_code_of_nav2(ends, outcome):
    answer = plan_on_map(_state(MapRobot(0.2)), MapQuery(*ends, now=100.0, oldest=10.0))
    assert answer.outcome == outcome
    assert answer.poses is None
    assert answer.message


def test_a_wall_without_a_gap_has_no_valid_path_and_a_node_without_map_says_so():
    shut = WALL.copy()
    shut[30] = 100
    assert plan_on_map(_state(MapRobot(0.2), shut), MapQuery(stamped(0.5, 0.5), stamped(0.5, 2.5))).outcome == (
        "NO_VALID_PATH"
    )
    answer = plan_on_map(MapState(MapRobot(0.2)), MapQuery(stamped(0.5, 0.5), stamped(0.5, 2.5)))
    assert (answer.outcome, answer.message) == ("UNKNOWN", "there is no map yet")


def test_a_path_is_a_message_of_poses():
    path = path_message(made, np.array([[0.5, 0.25, 0.0], [1.5, 0.25, math.pi]]), "map", 12.000000034)
    assert (path.kind, path.header.frame_id) == ("nav_msgs/msg/Path", "map")
    assert (path.header.stamp.sec, path.header.stamp.nanosec) == (12, 34)
    turn = path.poses[1].pose.orientation
    assert (turn.z, turn.w) == pytest.approx((1.0, 0.0))


def test_a_query_that_is_cancelled_ends_within_20_ms():
    """A car in a field of blocks that it cannot cross: its search goes on until its time is over."""
    rng = np.random.default_rng(5)
    cells = np.kron(rng.random((60, 60)) < 0.35, np.ones((6, 6))) * 100
    cells[:40, :40] = cells[-40:, -40:] = 0
    state = _state(MapRobot(footprint=BOX, turning_radius=0.6, reverse=False), cells)
    query, stop, ended = MapQuery(stamped(1.0, 1.0), stamped(17.0, 17.0), seconds=20.0), Stop(), []
    plan_on_map(state, MapQuery(query.start, query.goal, seconds=0.05))

    def run():
        answer = plan_on_map(state, query, stop)
        ended.append((time.process_time(), answer.outcome))

    thread = threading.Thread(target=run)
    thread.start()
    thread.join(0.3)
    assert not ended, "the query must take longer, or this shows nothing"
    # Of processor time: a busy machine runs other processes meanwhile.
    began = time.process_time()
    stop.set()
    thread.join(5.0)
    [(at, outcome)] = ended
    assert outcome == CANCELLED
    assert at - began < 0.02
