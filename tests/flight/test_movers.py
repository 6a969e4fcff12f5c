"""Obstacles that move: flights are proved over space and time, and it is known until when they stay free."""

import pickle

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.flight import FlightWorld
from tests.flight.carts import GOAL, START, crossing
from tests.flight.oracle import flown


@pytest.mark.parametrize("seed", range(4))
def test_a_flight_touches_nothing_at_the_time_at_which_it_passes(seed):
    world, at, to = crossing(seed)
    result = er.plan(world, START, GOAL)
    assert result, result.message
    assert world.validate(result.path).all()
    along, times = flown(result.start, result.trajectory().pieces, 100)
    carts = at + times[:, np.newaxis, np.newaxis] * to
    assert np.linalg.norm(carts - along[:, np.newaxis, :2], axis=2).min() > 0.2 + world.radius


def test_motions_are_refused_where_a_cart_is_at_that_time():
    found = 0
    for seed in range(30):
        world, at, to = crossing(100 + seed, 8)
        path = np.array([np.array(START), (6, 0, 2, 3, 0, 0), np.array(GOAL)])
        along, times = flown(path[0], world.space.native.pieces_along(path), 100)
        carts = at + times[:, np.newaxis, np.newaxis] * to
        gap = np.linalg.norm(carts - along[:, np.newaxis, :2], axis=2).min() - 0.2 - world.radius
        if abs(gap) > 5e-3:
            assert world.validate(path).all() == (gap > 0.0)
            found += gap > 0.0
    assert 3 < found < 27


def test_it_is_known_until_when_a_flight_and_its_rest_are_free():
    ball = er.Scene([er.Sphere(0.5, xyz=(9, 0, 1), name="ball")])
    world = FlightWorld(ball, speed=6.0, acceleration=8.0, velocities={"ball": (-1, 0, 0)})
    rest = np.array([[0, 0, 1, 0, 0, 0]] * 2)
    assert world.free_until(rest) == pytest.approx(8.25, abs=2e-3)
    assert world.free_until(rest, horizon=3.0) == 3.0
    across = np.array([[0, 0, 1, 0, 0, 0], [12, 0, 1, 0, 0, 0]])
    assert world.free_until(across) == 0.0
    result = er.plan(world, er.State((0, 0, 1)), er.State((0, 3, 1)))
    assert result.free_until == 1000.0
    moving = er.plan(world, er.State((0, 0, 1)), er.State((0, 3, 1), (0, 1, 0)))
    assert moving.free_until == pytest.approx(moving.cost)


def test_a_world_some_time_later_has_its_obstacles_elsewhere():
    world, at, to = crossing(1)
    later = world.with_moved({"cart 1": (1, 1, 2)}, {"cart 2": (0, 1, 0)}, elapsed=0.5)
    moved = at + 0.5 * to
    moved[1] = 1.0, 1.0
    trunks = [er.Cylinder(0.2, 6.0, xyz=(x, y, 2), name=f"cart {k}") for k, (x, y) in enumerate(moved.tolist())]
    fresh = FlightWorld(er.Scene(trunks), 0.25, speed=6.0, acceleration=8.0, bounds=world.bounds)
    q = world.space.from_cube(np.random.default_rng(5).random((500, 6)))
    np.testing.assert_array_equal(later.valid(q), fresh.valid(q))
    assert later.velocities["cart 2"] == (0.0, 1.0, 0.0)
    assert later.fingerprint() != world.fingerprint()
    copy = pickle.loads(pickle.dumps(later))
    assert copy.fingerprint() == later.fingerprint()
    np.testing.assert_array_equal(copy.valid(q), later.valid(q))


def test_a_saved_plan_is_loaded_with_its_world(tmp_path):
    world, _, _ = crossing(1)
    result = er.plan(world.with_moved({"cart 1": (1, 1, 2)}, {}), START, GOAL)
    result.save(tmp_path / "plan.json")
    loaded = er.load(tmp_path / "plan.json")
    assert loaded.world.fingerprint() == result.world.fingerprint()
    assert loaded.world.validate(loaded.path).all()
    assert loaded.plot().size[0] > 900


def test_what_cannot_move_is_refused():
    cloud = er.Scene([er.PointCloud(np.zeros((1, 3)), radius=0.1, name="bush"), er.Sphere(0.1, name="ball")])
    make = {"speed": 1.0, "acceleration": 1.0}
    with pytest.raises(InvalidValue, match="'bush' has a velocity"):
        FlightWorld(cloud, **make, velocities={"bush": (1, 0, 0)})
    with pytest.raises(UnknownName, match="hedge"):
        FlightWorld(cloud, **make, velocities={"hedge": (1, 0, 0)})
    with pytest.raises(InvalidValue, match="the velocity of 'ball'"):
        FlightWorld(cloud, **make, velocities={"ball": (1, 0)})
    world = FlightWorld(cloud, **make, velocities={"ball": (1, 0, 0)})
    with pytest.raises(UnknownName, match="bush"):
        world.with_moved({"bush": (0, 0, 0)}, {})
    with pytest.raises(InvalidValue, match="the position of 'ball'"):
        world.with_moved({"ball": (0, np.nan, 0)}, {})
