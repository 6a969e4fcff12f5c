"""Every path of a disk on a map can be driven: what touches along a path does so in its trajectory, too."""

from itertools import product

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, NotAvailable
from evenroad.trajectory import Limits, make_trajectory
from evenroad.world import MapFrame
from tests.world.gridmap_oracle import points_to_obstacles

SIDE = 0.05
"""Side of a cell [m]."""
JERKS = (None, (20.0, 20.0))


def driven(world, path, deviation, jerk):
    """Return the trajectory along a path, whose states and those between are as far from obstacles as they must be."""
    limits = Limits(velocity=(1.0, 1.0), acceleration=(2.0, 2.0), jerk=jerk)
    made = make_trajectory(path, limits, world=world, deviation=deviation)
    assert made.proof == "exact"
    np.testing.assert_allclose(np.diff(made.times), 0.008)
    some = np.flatnonzero(np.arange(len(made.positions) - 1) % 7 == 0)
    between = 0.5 * (made.positions[some] + made.positions[some + 1])
    away = points_to_obstacles(world.grid.frame.to_pixels(between), world.grid.occupied)
    assert away.min() >= world.radius / SIDE - 1e-8
    return made


def frame(yaw, origin=(-1.1, 70.0), size=(40, 40)):
    return MapFrame(rows=size[0], cols=size[1], resolution=SIDE, y_up=True, origin=origin, yaw=yaw)


@pytest.mark.parametrize("seed", [0, 1, 36])
def test_every_path_among_clutter_and_through_doors_as_wide_as_the_disk_is_driven(seed):
    rng = np.random.default_rng(seed)
    rows, cols = map(int, rng.integers(30, 90, 2))
    radius = int(rng.integers(1, 5))
    cells = rng.random((rows, cols)) < (10.0 ** rng.uniform(-3.0, -1.7) if seed % 2 else 0.0)
    for _ in range(0 if seed % 2 else 4):
        turned = cells if rng.random() < 0.5 else cells.T
        wall, thick = rng.integers(len(turned)), rng.integers(1, 10)
        turned[wall : wall + thick] = True
        for door in rng.integers(0, turned.shape[1], 2):
            turned[wall : wall + thick, door : door + 2 * radius] = False
    world = er.GridMap(cells, frame(rng.choice([0.0, 0.3]), (-1.1, 7e4), cells.shape)).world(radius * SIDE)
    for number in range(3):
        ends = world.space.from_cube(rng.random((2, 2)))
        # The nearest free position touches.
        ends = [world.nearest_free(each) for each in ends] if number else ends
        if all(each is not None for each in ends) and (found := er.plan(world, *ends, seconds=1.0)).solved:
            for jerk in JERKS:
                driven(world, found.path, SIDE, jerk)


@pytest.mark.parametrize(("yaw", "radius", "corners"), [*product((0.0, 0.3), (0.01, 0.1), (1, 2, 5))])
def test_a_path_that_touches_a_corner_at_each_of_its_motions_is_driven_in_any_phase_of_its_steps(yaw, radius, corners):
    cells = np.zeros((40, 40), dtype=bool)
    cells[20:, :20] = True
    world = er.GridMap(cells, frame(yaw)).world(radius)
    angles = np.linspace(0.5 * np.pi, 0.0, corners + 1)
    middle, half = 0.5 * (angles[1:] + angles[:-1]), 0.25 * np.pi / corners
    # Tangents of the circle around the obstacle's corner, in pixels from there, x right and y up.
    reach = radius / SIDE * (1.0 + 1e-11)
    round_it = np.column_stack([np.cos(middle), np.sin(middle)]) * reach / np.cos(half)
    for straight in (8.2, 8.74):
        tangents = np.concatenate([[[-straight, reach]], round_it, [[reach, -10.0]]])
        path = world.grid.frame.to_map(np.column_stack([20.0 + tangents[:, 0], 20.0 - tangents[:, 1]]))
        assert world.motion_valid(path[:-1], path[1:]).all()
        for deviation, jerk in product((SIDE, 0.0), JERKS):
            made = driven(world, path, deviation, jerk)
            assert made.deviation <= deviation + 1e-6


def test_a_path_that_leads_through_a_wall_is_refused_with_the_time_of_the_whole():
    cells = np.zeros((40, 40), dtype=bool)
    cells[:, 30] = True
    world = er.GridMap(cells, frame(0.0)).world(0.1)
    path = world.grid.frame.to_map(np.array([[5.0, 5.0], [5.0, 20.0], [15.0, 20.0], [38.0, 20.0]]))
    for jerk in JERKS:
        with pytest.raises(NotAvailable, match=r"at [2-9]\.\d+ s"):
            driven(world, path, 0.0, jerk)


def test_a_state_is_free_up_to_its_rounding_and_not_beyond():
    world = er.GridMap(np.zeros((40, 40), dtype=bool), frame(0.0)).world(0.1)
    for nearer, free in ((1e-13, True), (1e-9, False)):
        states = np.array([[-1.0 - nearer, 71.0], [-1.0 - nearer, 71.2]])
        assert not world.motion_valid(states[0], states[1])
        assert world.driven_free(states).tolist() == [free]


def test_a_disk_keeps_its_acceleration_in_all_directions_together():
    world = er.load_map("office.yaml").world(radius=0.25)
    result = er.plan(world, (1.0, 2.0), (8.5, 3.0))
    times = {}
    for deviation in (0.0, 0.05, 0.3):
        made = result.trajectory(speed=1.0, acceleration=0.5, deviation=deviation)
        velocity = np.diff(made.positions, axis=0) / made.step
        change = np.diff(velocity, axis=0) / made.step
        assert np.linalg.norm(velocity, axis=1).max() <= 1.0 + 1e-9
        assert np.linalg.norm(change, axis=1).max() <= 0.5 * (1.0 + 1e-6)
        np.testing.assert_array_equal(made.positions[[0, -1]], result.path[[0, -1]])
        pixels = world.grid.frame.to_pixels(made.positions[::20])
        assert points_to_obstacles(pixels, world.grid.occupied).min() >= 0.25 / SIDE - 1e-8
        assert made.deviation <= deviation + 1e-9
        assert (made.proof, made.names) == ("exact", ("x", "y"))
        times[deviation] = made.duration
    assert times[0.0] > times[0.05] >= times[0.3]


def test_a_disk_drives_a_straight_path_in_the_shortest_whole_number_of_steps():
    world = er.GridMap(np.zeros((40, 40), dtype=bool), frame(0.0)).world(0.1)
    path = world.grid.frame.to_map(np.array([[5.0, 5.0], [25.0, 20.0]]))
    made = er.plan(world, *path).trajectory(speed=2.0, acceleration=0.5)
    # Half of the 1.25 m to accelerate, half to brake.
    assert made.duration == pytest.approx(0.008 * np.ceil(2.0 * np.sqrt(1.25 / 0.5) / 0.008))
    with pytest.raises(InvalidValue, match="starts and stops at rest"):
        er.plan(world, *path).trajectory(acceleration=0.5, start_velocity=(0.1, 0.0))
