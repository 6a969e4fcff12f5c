"""The disk world where the answer is known by heart: walls, gaps, touching, borders, bad input."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.testing import WorldContract
from evenroad.world import GridMap, MapFrame
from evenroad.world.gridmap import DiskWorld
from tests.refused import refused
from tests.world.gridmap_oracle import distance_to_obstacles


def empty(rows=40, cols=60):
    return np.zeros((rows, cols), dtype=np.bool_)


def with_cells(occupied, *cells):
    for row, col in cells:
        occupied[row, col] = True
    return occupied


def scattered():
    return np.random.default_rng(0).random((48, 64)) < 0.01


TURNED = MapFrame(rows=48, cols=64, resolution=0.05, origin=(-3.0, 7.0), yaw=0.7, y_up=True)


class TestDiskOnImage(WorldContract):
    world = GridMap(scattered()).world(2.5)


class TestDiskOnTurnedRosMap(WorldContract):
    world = GridMap(scattered(), TURNED).world(0.1, clearance=0.02)


def test_the_text_of_an_error_names_the_place():
    world = GridMap(scattered()).world(2.5)
    q = world.space.from_cube(np.random.default_rng(0).random((10, 2)))
    refused(InvalidValue, "shape", world.valid, np.append(q[0], 1.0))
    refused(InvalidValue, "length", world.motion_valid, q[:3], q[:4])
    wrong = q.copy()
    wrong[5, 0] = np.nan
    refused(InvalidValue, r"\[5, 0\]", world.valid, wrong)
    refused(InvalidValue, "b must be finite", world.motion_valid, q, wrong)


@pytest.mark.parametrize("radius", [1e-9, 0.1, 0.5, 3.0])
@pytest.mark.parametrize("angle", np.linspace(0.0, 1.4, 15))
def test_a_wall_one_pixel_thick_stops_a_motion(radius, angle):
    occupied = empty()
    occupied[:, 30] = True
    half = 8.0 * np.array([math.cos(angle), math.sin(angle)])
    middle = np.array([30.5, 20.0])
    world = GridMap(occupied).world(radius)
    assert not world.motion_valid([middle - half], [middle + half])[0]


@pytest.mark.parametrize("radius", [1e-12, 1e-6, 0.3])
def test_nothing_passes_between_two_cells_that_touch_at_a_corner(radius):
    world = GridMap(with_cells(empty(4, 4), (1, 1), (2, 2))).world(radius)
    assert world.valid([[2.5, 1.5], [1.5, 2.5]]).all()
    assert not world.motion_valid([[2.5, 1.5]], [[1.5, 2.5]])[0]
    assert not world.motion_valid([[3.5, 1.0]], [[0.5, 3.0]])[0]


def test_a_staircase_of_corners_is_a_wall():
    world = GridMap(np.eye(30, dtype=np.bool_)).world(1e-9)
    rng = np.random.default_rng(1)
    above = np.sort(rng.random((200, 2)) * 30)[:, ::-1]
    below = np.sort(rng.random((200, 2)) * 30)
    clear = world.valid(above) & world.valid(below)
    assert clear.sum() > 100
    assert not world.motion_valid(above, below).any()


def test_a_gap_lets_a_disk_pass_that_fits_exactly_and_no_larger_one():
    occupied = empty()
    occupied[:, 30] = True
    occupied[14:26, 30] = False
    a, b = [[20.0, 20.0]], [[41.0, 20.0]]
    assert GridMap(occupied).world(6.0).motion_valid(a, b)[0]
    assert not GridMap(occupied).world(np.nextafter(6.0, 7.0)).motion_valid(a, b)[0]
    assert not GridMap(occupied).world(6.0).motion_valid([[20.0, 20.0]], [[41.0, 20.0001]])[0]


def test_a_motion_along_a_grid_line_between_two_walls_is_blocked_and_beside_one_is_not():
    between = with_cells(empty(), (19, 30), (20, 30))
    world = GridMap(between).world(0.25)
    assert not world.motion_valid([[20.0, 20.0]], [[40.0, 20.0]])[0]
    assert world.motion_valid([[20.0, 21.25]], [[40.0, 21.25]])[0]
    assert world.motion_valid([[20.0, 22.0]], [[40.0, 22.0]])[0]


def test_a_disk_that_just_touches_a_wall_is_free():
    occupied = empty()
    occupied[:, 30] = True
    world = GridMap(occupied).world(6.0)
    assert world.valid([[24.0, 20.0], [37.0, 20.0]]).all()
    assert not world.valid([[np.nextafter(24.0, 25.0), 20.0], [np.nextafter(37.0, 36.0), 20.0]]).any()
    assert world.motion_valid([[24.0, 10.0]], [[24.0, 30.0]])[0]
    assert not world.motion_valid([[24.0, 10.0]], [[np.nextafter(24.0, 25.0), 30.0]])[0]


def test_a_disk_that_just_touches_a_border_or_a_corner_is_free_and_so_is_a_slanted_way():
    world = GridMap(empty()).world(6.0)
    corners = np.array([[6.0, 6.0], [54.0, 6.0], [54.0, 34.0], [6.0, 34.0]])
    assert world.valid(corners).all()
    assert world.motion_valid(corners, np.roll(corners, 1, axis=0)).all()
    assert not world.valid(corners + 1e-12 * np.sign([30, 20] - corners) * -1).any()
    world = GridMap(with_cells(empty(), (20, 30))).world(5.0)
    touching = np.array([[27.0, 16.0], [34.0, 25.0], [26.0, 24.0]])  # 3-4-5 triangles
    assert world.valid(touching).all()
    assert not GridMap(world.grid.occupied).world(np.nextafter(5.0, 6.0)).valid(touching).any()
    grid = GridMap(with_cells(empty(), (20, 30)))
    # The corner (30, 20) is 5 from the line through (27, 16) along (4, -3).
    a, b = [[27.0 - 8.0, 16.0 + 6.0]], [[27.0 + 8.0, 16.0 - 6.0]]
    assert grid.world(5.0).motion_valid(a, b)[0]
    assert not grid.world(np.nextafter(5.0, 6.0)).motion_valid(a, b)[0]


@pytest.mark.parametrize("angle", [0.3, 0.6, 0.9, 1.2])
@pytest.mark.parametrize("beyond", [0.02, 0.05, 0.1])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_corner_that_is_passed_just_before_a_long_motion_ends_blocks_it(angle, beyond, mirrored):
    radius, long = 1.0, 150.0
    corner = np.array([200.0, 200.0])
    away = -np.array([math.sin(angle), math.cos(angle)])
    ahead = np.array([math.cos(angle), -math.sin(angle)])
    occupied = with_cells(empty(400, 400), (200, 200))
    world = GridMap(occupied[:, ::-1] if mirrored else occupied).world(radius)
    # At its foot the way is a hair too near; at its end it is a hair farther than the radius again.
    for hair, free in ((-0.25, False), (0.25, True)):
        foot = corner + (radius + hair * beyond**2) * away
        end, start = foot + beyond * ahead, foot - long * ahead
        if mirrored:
            start, end = ([400.0 - x, y] for x, y in (start, end))
        assert world.valid([start, end]).all()
        assert world.motion_valid([start, end], [end, start]).tolist() == [free, free]


def test_outside_the_map_nothing_is_free_nor_where_the_disk_is_wider_than_it():
    world = GridMap(empty()).world(0.001)
    outside = [[-1.0, 5.0], [5.0, -1e-9], [60.0, 5.0], [5.0, 40.5], [1e300, 1e300], [0.0, 0.0], [60.0, 40.0]]
    assert not world.valid(outside).any()
    assert not world.motion_valid(outside, [[30.0, 20.0]] * len(outside)).any()
    grid = GridMap(empty(10, 1000))
    places = grid.space.from_cube(np.random.default_rng(0).random((200, 2)))
    assert not grid.world(5.001).valid(places).any()
    assert not grid.world(1e200).valid(places).any()
    assert grid.world(5.0).motion_valid([[5.0, 5.0]], [[995.0, 5.0]])[0]


def test_maps_and_open_spaces_wider_than_the_longest_run_are_no_problem():
    tall = GridMap(np.zeros((70_000, 3), dtype=np.bool_)).world(1.5)
    assert tall.motion_valid([[1.5, 1.5]], [[1.5, 69_998.5]])[0]
    assert not tall.motion_valid([[1.5, 1.5]], [[1.5, 69_998.6]])[0]
    assert tall.distance([[1.0, 35_000.0]])[0] == -0.5
    world = GridMap(with_cells(empty(700, 700), (350, 600))).world(1.0)
    assert world.valid([[350.0, 350.0], [300.0, 300.0]]).all()
    assert world.motion_valid([[2.0, 340.0]], [[690.0, 347.0]])[0]
    assert not world.motion_valid([[2.0, 350.0]], [[690.0, 351.0]])[0]


def test_motions_too_short_to_measure_are_as_free_as_their_ends():
    world = GridMap(with_cells(empty(), (20, 30))).world(1.0)
    a = np.array([[29.0, 20.5], [29.5, 20.5], [10.0, 10.0]])
    for step in (5e-324, 1e-310, 1e-200, 1e-16):
        np.testing.assert_array_equal(world.motion_valid(a, a + step), world.valid(a) & world.valid(a + step))


def test_the_distance_is_from_the_disk_to_the_nearest_obstacle_and_negative_where_it_overlaps():
    world = GridMap(with_cells(empty(), (20, 30))).world(1.0)
    q = [[30.5, 15.0], [27.0, 16.0], [3.0, 20.0], [30.5, 20.5], [-5.0, 1.0], [30.0, 15.0]]
    np.testing.assert_array_equal(world.distance(q), [4.0, 4.0, 2.0, -1.0, -1.0, 4.0])
    assert repr(world.distance(q[0])) == "4.0"
    assert GridMap(with_cells(empty(), (20, 30))).world(1.0, clearance=0.5).distance(q[0]) == 4.0
    np.testing.assert_array_equal(
        world.nearest_obstacle(q), [[30.5, 20.0], [30.0, 20.0], [0.0, 20.0], [30.5, 20.5], [-5.0, 1.0], [30.0, 20.0]]
    )


def test_the_nearest_obstacle_point_is_an_obstacle_at_the_distance_and_decides_validity():
    frame = MapFrame(rows=48, cols=64, resolution=0.05, origin=(-3.0, 7.0), yaw=0.7, y_up=True)
    grid = GridMap(scattered(), frame)
    world = grid.world(0.12)
    q = grid.space.from_cube(np.random.default_rng(2).random((500, 2)))
    distance, nearest = world.distance(q), world.nearest_obstacle(q)
    np.testing.assert_allclose(np.hypot(*(q - nearest).T), distance + world.radius, atol=1e-12)
    np.testing.assert_array_equal(world.valid(q), distance >= 0.0)
    np.testing.assert_allclose(world.distance(nearest), -world.radius, atol=1e-12)


def test_distance_agrees_with_the_oracle():
    rng = np.random.default_rng(8)
    for _ in range(60):
        rows, cols = rng.integers(1, 15, 2)
        occupied = rng.random((rows, cols)) < rng.choice([0.0, 0.02, 0.2])
        q = rng.random((8, 2)) * [cols, rows]
        expected = [distance_to_obstacles(p, p, occupied) - 1.0 for p in q.tolist()]
        np.testing.assert_allclose(GridMap(occupied).world(1.0).distance(q), expected, atol=1e-12)


@pytest.mark.parametrize("radius", [0, 0.0, -1.0, math.nan, math.inf, "6", True])
def test_a_radius_that_is_no_positive_number_is_refused(radius):
    refused(InvalidValue, r"radius must be a finite number > 0, got", lambda: GridMap(empty()).world(radius))
    refused(InvalidValue, "radius", DiskWorld, GridMap(empty()), radius)


@pytest.mark.parametrize("clearance", [-0.1, math.nan, math.inf, "1"])
def test_a_clearance_that_is_negative_or_no_number_is_refused(clearance):
    with pytest.raises(InvalidValue, match=r"clearance must be a finite number >= 0, got"):
        GridMap(empty()).world(1.0, clearance=clearance)


def test_clearance_is_added_to_the_radius():
    world = GridMap(empty()).world(5.0, clearance=1.0)
    assert world.radius == 6.0
    np.testing.assert_array_equal(world.valid([[6.0, 20.0], [5.99, 20.0]]), [True, False])
