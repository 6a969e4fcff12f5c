"""A footprint on a map: poses and motions are what a slow check says, to the last bit where they touch."""

import math
import pickle

import numpy as np
import pytest

import evenroad as er
from evenroad.driving import CarWorld, Footprint
from evenroad.errors import InvalidValue, UnknownName
from evenroad.testing import WorldContract
from evenroad.world import MapFrame
from tests.driving.oracle import BOX, HOOK, Oracle, curve_of, poses

FAR = [(0.3, -0.2), (0.9, -0.35), (1.1, 0.2), (0.6, 0.5)]
"""A footprint that does not hold its reference point."""


def scattered(seed=1, share=0.03, **frame):
    """A map of some cells, 24 rows by 32 columns of 0.2."""
    cells = np.random.default_rng(seed).random((24, 32)) < share
    if frame:
        return er.GridMap(cells, MapFrame(rows=24, cols=32, resolution=0.2, **frame))
    return er.GridMap(cells, resolution=0.2)


TURNED = {"origin": (-3.0, 7.0), "yaw": 0.4, "y_up": True}
WORLDS = {
    "box": scattered().world(footprint=BOX, turning_radius=0.8),
    "hook on a turned map": scattered(2, **TURNED).world(footprint=HOOK, turning_radius=0.6),
    "far on an image": scattered(3, y_up=False).world(footprint=FAR, turning_radius=1.0, reverse=False),
    "on the spot": scattered(4).world(footprint=HOOK),
    "holonomic": scattered(5, **TURNED).world(footprint=BOX, holonomic=True),
}
EVERY = pytest.mark.parametrize("name", WORLDS)


class TestCar(WorldContract):
    world = WORLDS["box"]


class TestHolonomic(WorldContract):
    world = WORLDS["holonomic"]


class TestForwardsOnly(WorldContract):
    world = WORLDS["far on an image"]


@EVERY
def test_poses_are_free_where_every_cell_is_separate(name):
    world = WORLDS[name]
    oracle, q = Oracle(world.grid, world.footprint.parts), poses(world, 250, 6)
    gaps = np.array([oracle.gap(pose) for pose in q])
    certain = np.abs(gaps) > 1e-7
    assert certain.sum() > 240
    assert 20 < (gaps < 0).sum() < 230
    np.testing.assert_array_equal(world.valid(q)[certain], gaps[certain] > 0)


@EVERY
def test_motions_are_free_where_no_pose_on_them_touches(name):
    world = WORLDS[name]
    oracle = Oracle(world.grid, world.footprint.parts)
    q = poses(world, 4000, 7)
    q = q[world.valid(q)][:120]
    a, b = q[:60], world.space.interpolate(q[:60], q[60:], np.random.default_rng(8).random(60) ** 2)
    near = 2e-3 if world.holonomic else 1e-4
    touches = np.array([oracle.touches(*curve_of(world, *each), near) for each in zip(a, b, strict=True)])
    free = world.motion_valid(a, b)
    assert 10 < free.sum() < 55
    assert (touches == None).sum() < 4  # noqa: E711
    # Lines that turn may be refused within a millimetre, all others only where they touch.
    assert not touches[free].any()
    assert (touches[~free] != False).all()  # noqa: E712


def test_what_touches_is_free_and_what_reaches_a_hair_further_is_not():
    cells = np.zeros((20, 20), dtype=bool)
    cells[:, 12] = True
    world = er.GridMap(cells, resolution=0.25).world(footprint=[(-1, -0.5), (0.5, -0.5), (0.5, 0.5), (-1, 0.5)])
    at_wall = np.array([(2.5, 2.0, 0.0), (1.0, 2.0, 0.0), (2.5, 0.5, 0.0), (2.5, 2.0, math.pi / 2)])
    assert world.valid(at_wall).all()
    inwards = np.array([(1e-8, 0, 0), (-1e-8, 0, 0), (0, -1e-8, 0)])
    assert not world.valid(at_wall[:3] + inwards).any()
    # Along the wall, and into it.
    assert world.motion_valid((2.5, 1.0, math.pi / 2), (2.5, 3.0, math.pi / 2))
    assert world.motion_valid((2.0, 2.0, 0.0), (2.5, 2.0, 0.0))
    assert not world.motion_valid((2.0, 2.0, 0.0), (2.5 + 1e-8, 2.0, 0.0))


def test_a_robot_drives_through_a_corridor_that_is_just_as_wide_and_not_through_a_narrower_one():
    cells = np.ones((8, 40), dtype=bool)
    cells[2:6, :] = False
    grid = er.GridMap(cells, resolution=0.25)
    assert grid.world(footprint=[(-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5)]).motion_valid((1.5, 1, 0), (8.5, 1, 0))
    wider = grid.world(footprint=[(-1, -0.5), (1, -0.5), (1, 0.5 + 1e-7), (-1, 0.5)])
    assert not wider.valid((1.5, 1, 0))


def test_a_turn_whose_corner_sweeps_over_a_cell_is_found_between_free_poses():
    """The corner of a box passes a cell by less than a hair, or misses it."""
    for side, free in ((0.4999, True), (0.5001, False)):
        cells = np.zeros((20, 20), dtype=bool)
        cells[10, 15] = True  # from x = 1.5, y = 0.9 to 1.0
        grid = er.GridMap(cells, resolution=0.1)
        reach = math.hypot(side, 0.1)
        world = grid.world(footprint=[(-0.1, -0.1), (side, -0.1), (side, 0.1), (-0.1, 0.1)])
        x = 1.5 - math.hypot(0.5, 0.1)
        a, b = (x, 0.95, -0.8), (x, 0.95, 0.8)
        assert world.valid([a, b]).all()
        assert world.motion_valid(a, b) == free, reach


def test_a_motion_forwards_is_no_motion_back():
    cells = np.zeros((40, 40), dtype=bool)
    cells[10:, 20] = True
    grid = er.GridMap(cells, resolution=0.1)
    world = grid.world(
        footprint=[(-0.2, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.2, 0.1)], turning_radius=0.3, reverse=False
    )
    a, b = (0.5, 3.5, 0.0), (1.5, 3.5, 0.0)
    assert world.space.is_directed
    assert world.motion_valid(a, b)
    assert not world.motion_valid((1.7, 3.5, 0.0), (0.3, 3.5, 0.0))
    assert grid.world(footprint=BOX, turning_radius=0.3).space.is_directed is False


def test_the_distance_is_that_of_the_nearest_cell_and_the_clearance_counts_for_what_is_free():
    grid = scattered(9)
    world, wide = (grid.world(footprint=HOOK, turning_radius=0.6, clearance=c) for c in (0.0, 0.15))
    oracle, q = Oracle(grid, world.footprint.parts), poses(world, 150, 10)
    distance = world.distance(q)
    np.testing.assert_array_equal(distance > 0, world.valid(q))
    np.testing.assert_array_equal(wide.distance(q), distance)
    for pose, own in zip(q, distance, strict=True):
        gap = oracle.gap(pose)
        # A gap along normals is at most the distance, and is it where a side is nearest.
        assert own >= gap - 1e-7 if gap > 0 else own == 0.0
    assert not wide.valid(q)[distance < 0.15 - 1e-9].any()
    assert wide.valid(q)[distance > 0.15 * 1.02].all()


def test_an_open_map_is_as_far_as_its_border():
    world = er.GridMap(np.zeros((40, 40), dtype=bool), resolution=0.1).world(footprint=BOX)
    assert world.distance((2.0, 2.0, 0.0)) == pytest.approx(2.0 - 0.45, abs=1e-9)


@pytest.mark.parametrize("y_up", [True, False])
def test_the_reason_names_the_corner_and_the_cell_and_by_how_much(y_up):
    cells = np.zeros((20, 20), dtype=bool)
    cells[19 - 10 if y_up else 10, 15] = True  # x from 1.5 to 1.6, y from 1.0 to 1.1
    world = er.GridMap(cells, MapFrame(rows=20, cols=20, resolution=0.1, y_up=y_up)).world(footprint=BOX)
    left, right = ("left", "right") if y_up else ("right", "left")
    said = world.explain((1.08, 0.77, 0.0))
    assert said == f"its front {left} corner touches the cell at (1.55, 1.05) by 0.03"
    assert "front side touches the cell" in world.explain((1.08, 1.05, 0.0))
    assert f"rear {right} corner touches" in world.explain((1.98, 1.33, 0.0)) or "beyond" in world.explain(
        (1.98, 1.33, 0)
    )
    assert world.explain((0.3, 1.0, 0.0)) == "its rear side reaches beyond the map" or "corner" in world.explain(
        (0.3, 1, 0)
    )
    assert world.explain((0.7, 0.5, 0.0)) == "nothing touches"


def test_no_path_is_proved_where_the_disk_inside_does_not_get_through():
    cells = np.zeros((30, 60), dtype=bool)
    cells[:, 30] = True
    cells[12:16, 30] = False  # 0.4 wide
    grid = er.GridMap(cells, resolution=0.1)
    start, goal = (1.0, 1.5, 0.0), np.array([(5.0, 1.5, 0.0)])
    found = grid.world(footprint=BOX, turning_radius=0.4).apart(np.array(start), goal)
    assert found is not None
    assert found.proved
    assert "radius 0.31" in found.message
    narrow = [(-0.3, -0.15), (0.3, -0.15), (0.3, 0.15), (-0.3, 0.15)]
    assert grid.world(footprint=narrow, turning_radius=0.4).apart(np.array(start), goal) is None


def test_a_copy_gives_the_same_results_and_other_worlds_have_other_fingerprints():
    world = WORLDS["hook on a turned map"]
    copy, q = pickle.loads(pickle.dumps(world)), poses(world, 100, 11)
    np.testing.assert_array_equal(copy.valid(q), world.valid(q))
    assert copy.fingerprint() == world.fingerprint()
    assert len({each.fingerprint() for each in WORLDS.values()}) == len(WORLDS)


GRID = scattered()


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"footprint": BOX, "radius": 0.3}, "one of the two"),
        ({"turning_radius": 0.3}, "radius=.*or footprint="),
        ({}, "radius=.*or footprint="),
        ({"footprint": BOX, "turning_radius": -1.0}, "turning_radius"),
        ({"footprint": BOX, "turning_radius": 50.0}, "at most the diagonal of the map, 8, got 50"),
        ({"footprint": BOX, "turning_radius": math.nan}, "turning_radius"),
        ({"footprint": BOX, "clearance": -0.1}, "clearance"),
        ({"footprint": 20 * np.array(BOX)}, "must fit on the map"),
        ({"footprint": BOX, "holonomic": True, "turning_radius": 1.0}, "holonomic"),
        ({"footprint": BOX[:2]}, "three corners"),
    ],
)
def test_what_is_no_robot_is_refused_in_one_line(given, says):
    with pytest.raises(InvalidValue, match=says) as refused:
        GRID.world(**given)
    assert "\n" not in str(refused.value)


def test_unknown_words_are_refused_and_poses_are_three_numbers():
    with pytest.raises(UnknownName, match="turning_radius"):
        GRID.world(footprint=BOX, turn_radius=1.0)
    with pytest.raises(InvalidValue, match=r"\(n, 3\)"):
        WORLDS["box"].valid([(1.0, 2.0)])
    with pytest.raises(InvalidValue, match="angle"):
        WORLDS["box"].valid((1.0, 2.0, 1e9))


def test_planners_of_roadmaps_and_trees_plan_for_a_car_that_may_reverse():
    world = WORLDS["box"]
    result = er.plan(world, (5.3, 1.96, 0.31), (1.77, 0.77, 2.95), er.PRM(256), seconds=20)
    assert result.solved, result.message
    assert result.proof == "exact"
    assert world.validate(result.path).all()
    assert result.cost == pytest.approx(world.space.distance(result.path[:-1], result.path[1:]).sum())


def test_a_footprint_may_be_given_as_a_value():
    world = CarWorld(GRID, Footprint(BOX), 0.8)
    np.testing.assert_array_equal(world.valid(poses(world, 50, 12)), WORLDS["box"].valid(poses(world, 50, 12)))
    assert repr(world) == "CarWorld(Footprint(4 corners, 1 convex part), turning radius 0.8, 24 x 32 cells)"
