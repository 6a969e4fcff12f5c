"""Proofs that a car that drives only forwards does not get to a pose."""

import math

import numpy as np
import pytest

import evenroad as er
from evenroad._native.drive import Steering
from tests.driving.oracle import BOX

MOST = 10**6


def world_of(cells, radius=1.5):
    return er.GridMap(cells, resolution=0.1).world(footprint=BOX, turning_radius=radius, reverse=False)


def is_apart(world, start, goal, most=MOST):
    return world.vehicle.is_unreachable(world.space.steering, np.array(start), np.array(goal), most)


def test_a_car_in_front_of_a_wall_and_a_goal_behind_one_are_proved_out_of_reach():
    """A room of 6 by 4 in which a turn of radius 1.5 ends at the walls, and a wide one."""
    world = world_of(np.zeros((40, 60), dtype=bool))
    facing, middle = (5.0, 2.0, 0.0), (2.0, 2.0, 0.0)
    assert is_apart(world, facing, middle)
    assert is_apart(world, middle, (0.9, 2.0, 0.0))
    assert not is_apart(world, middle, facing)
    result = er.plan(world, facing, middle, seconds=20)
    assert result.status == "not_connected"
    assert result.message.startswith("proved: there is no path; forwards alone")
    wide = world_of(np.zeros((90, 90), dtype=bool))
    assert not is_apart(wide, (4.0, 4.5, 0.0), (3.0, 4.5, 0.0), 30_000)
    assert not is_apart(world, facing, middle, 10)


@pytest.mark.parametrize(
    ("radius", "fine", "coarse"), [(0.4, 1, 1), (1.5, 1, 1), (4.0, 1, 1), (1.5, 1, 5), (1.5, 12, 1)]
)
def test_nothing_is_proved_out_of_reach_that_a_random_drive_leads_to(radius, fine, coarse):
    """Drives of random curvatures up to the largest, and of any length, among scattered cells, large ones and small.

    Small cells make drives of more than 64 of them, and large ones are divided.  Half of the starts lie between two
    slices of the angle.
    """
    rng = np.random.default_rng(7)
    cells = np.kron(rng.random((34, 44)) < 0.01, np.ones((fine, fine), dtype=bool))
    world = er.GridMap(cells, resolution=0.1 * coarse / fine).world(footprint=BOX, turning_radius=radius, reverse=False)
    starts = world.space.from_cube(rng.random((600, 3)))
    starts[::2, 2] = 0.0
    driven, wanted = 0, 25 if fine == 1 else 6
    for start in starts[world.valid(starts)]:
        pose, gone = start, 0.0
        is_locked = rng.random() < 0.5
        for _ in range(rng.integers(1, 9)):
            steering = Steering(radius / (1.0 if is_locked else rng.uniform(0.1, 1.0)), 1.0, False, 0.0)
            piece = np.array([[rng.integers(-1, 2), rng.uniform(0.05, 1.5)]])
            if not world.vehicle.pieces_free(steering, pose, piece):
                break
            pose, gone = steering.poses_along(pose, piece, 10.0)[-1], gone + piece[0, 1]
        if gone > 0.0 and driven < wanted:
            driven += 1
            assert not is_apart(world, start, pose, 400_000), (start, pose)
            assert math.isfinite(gone)
    assert driven == wanted
