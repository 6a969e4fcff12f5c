"""Where pixels lie: bare images, ROS maps, turned ROS maps."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.world import GridMap, MapFrame
from tests.refused import refused

YAW = 0.9


def random_occupied():
    return np.random.default_rng(0).random((20, 30)) < 0.05


def turned(q, yaw, about):
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x, y = (np.asarray(q) - about).T
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y]) + about


def test_in_a_bare_image_pixel_c_r_is_the_square_from_c_r_with_y_down():
    occupied = np.zeros((4, 6), dtype=np.bool_)
    occupied[1, 4] = True
    world = GridMap(occupied).world(0.1)
    assert world.distance((4.5, 1.5)) == -0.1
    np.testing.assert_array_equal(world.nearest_obstacle([[3.5, 1.5], [4.5, 2.5]]), [[4.0, 1.5], [4.5, 2.0]])


def test_in_a_ros_map_the_origin_is_the_lower_left_corner_of_the_lower_left_pixel():
    occupied = np.zeros((4, 6), dtype=np.bool_)
    occupied[3, 0] = True  # the lower-left pixel is in the image's last row
    frame = MapFrame(rows=4, cols=6, resolution=0.5, origin=(10.0, -2.0), y_up=True)
    world = GridMap(occupied, frame).world(0.01)
    np.testing.assert_array_equal(world.distance([[10.25, -1.75], [10.75, -1.75], [10.25, -1.25]]), [-0.01, 0.24, 0.24])
    np.testing.assert_array_equal(world.nearest_obstacle([[10.625, -1.75]]), [[10.5, -1.75]])


def test_a_ros_map_turned_by_a_quarter_has_its_columns_along_y():
    frame = MapFrame(rows=4, cols=6, resolution=0.5, origin=(10.0, -2.0), yaw=math.pi / 2, y_up=True)
    pixels = frame.to_pixels(np.array([[10.0, -2.0], [10.0, 1.0], [8.0, -2.0], [8.0, 1.0]]))
    np.testing.assert_allclose(pixels, [[0, 4], [6, 4], [0, 0], [6, 0]], atol=1e-12)


def test_pixels_and_map_points_are_inverse():
    rng = np.random.default_rng(3)
    for frame in (
        MapFrame(rows=20, cols=30),
        MapFrame(rows=20, cols=30, resolution=0.05, origin=(-7.5, 3.0), yaw=YAW, y_up=True),
    ):
        pixels = rng.random((50, 2)) * [30, 20]
        np.testing.assert_allclose(frame.to_pixels(frame.to_map(pixels)), pixels, atol=1e-11)


def test_the_space_is_the_image_rectangle_turned_as_the_map_is():
    frame = MapFrame(rows=20, cols=30, resolution=0.1, origin=(1.0, 2.0), yaw=YAW, y_up=True)
    grid = GridMap(random_occupied(), frame)
    q = grid.space.from_cube(np.random.default_rng(1).random((300, 2)))
    assert grid.contains(q).all()
    np.testing.assert_allclose(
        frame.to_pixels(grid.space.from_cube([[0, 0], [1, 0], [0, 1]])), [[0, 20], [30, 20], [0, 0]], atol=1e-12
    )
    assert math.isclose(grid.space.area, 3.0 * 2.0)


def test_a_turned_map_gives_turned_points_the_verdicts_of_the_upright_one():
    upright = MapFrame(rows=20, cols=30, resolution=0.25, origin=(-2.0, 5.0), y_up=True)
    tilted = MapFrame(rows=20, cols=30, resolution=0.25, origin=(-2.0, 5.0), yaw=YAW, y_up=True)
    plain, rotated = (GridMap(random_occupied(), frame).world(0.3) for frame in (upright, tilted))
    rng = np.random.default_rng(2)
    a, b = (plain.space.from_cube(rng.random((2000, 2))) for _ in range(2))
    b = 0.8 * a + 0.2 * b
    turned_a, turned_b = (turned(q, YAW, upright.origin) for q in (a, b))
    verdicts = plain.motion_valid(a, b)
    assert 100 < verdicts.sum() < 1900
    np.testing.assert_array_equal(rotated.valid(turned_a), plain.valid(a))
    np.testing.assert_array_equal(rotated.motion_valid(turned_a, turned_b), verdicts)
    np.testing.assert_allclose(rotated.distance(turned_a), plain.distance(a), atol=1e-12)


def test_an_upright_ros_map_is_its_image_upside_down():
    image = GridMap(random_occupied()).world(1.2)
    ros = GridMap(random_occupied(), MapFrame(rows=20, cols=30, y_up=True)).world(1.2)
    q = image.space.from_cube(np.random.default_rng(4).random((500, 2)))
    np.testing.assert_array_equal(ros.valid(np.column_stack([q[:, 0], 20.0 - q[:, 1]])), image.valid(q))


def test_the_border_is_inside_and_nothing_beyond_however_far():
    grid = GridMap(np.zeros((4, 6), dtype=np.bool_))
    np.testing.assert_array_equal(
        grid.contains([[0, 0], [6, 4], [3, 2], [-1e-9, 1], [6.001, 1], [1, 4.001], [1, -1]]),
        [True, True, True, False, False, False, False],
    )
    frame = MapFrame(rows=4, cols=6, resolution=1e-3, yaw=YAW, y_up=True)
    grid = GridMap(np.zeros((4, 6), dtype=np.bool_), frame)
    far = np.array([[1e308, -1e308], [1e308, 1e308]])
    assert not grid.contains(far).any()
    assert not grid.world(1e-4).valid(far).any()
    np.testing.assert_array_equal(grid.world(1e-4).nearest_obstacle(far), far)


@pytest.mark.parametrize(("change", "text"), [
    ({"resolution": 0.0}, "resolution"), ({"resolution": -1.0}, "resolution"), ({"resolution": math.nan}, "resolution"),
    ({"rows": 0}, "rows"), ({"origin": (math.inf, 0.0)}, "origin"), ({"yaw": math.nan}, "yaw"),
    ({"yaw": 0.5, "y_up": False}, "yaw must be 0"),
])  # fmt: skip
def test_a_frame_of_impossible_numbers_is_refused(change, text):
    refused(InvalidValue, text, MapFrame, **{"rows": 4, "cols": 6, "y_up": True, **change})


def test_a_map_keeps_a_read_only_copy_of_its_cells():
    occupied = np.zeros((4, 6), dtype=np.bool_)
    grid = GridMap(occupied)
    occupied[0, 0] = True
    assert not grid.occupied.any()
    with pytest.raises(ValueError, match="read-only"):
        grid.occupied[0, 0] = True


@pytest.mark.parametrize("occupied", [
    np.zeros((0, 3), np.bool_), np.zeros(4, np.bool_), np.zeros((2, 2), np.uint8), np.zeros((2, 2, 2), np.bool_),
])  # fmt: skip
def test_cells_that_are_no_boolean_image_are_refused(occupied):
    refused(InvalidValue, "boolean array", GridMap, occupied)


def test_a_frame_and_unknown_cells_of_another_size_are_refused():
    refused(InvalidValue, "unknown has shape", GridMap, np.zeros((3, 4), bool), unknown=np.zeros((4, 3), bool))
    refused(InvalidValue, "6 rows and 4 columns", GridMap, np.zeros((6, 4), dtype=np.bool_), MapFrame(rows=4, cols=6))
