"""Polygons as obstacles: poses and motions are what a slow check of separating axes says, whatever the cells are."""

import json
import math
import pickle

import numpy as np
import pytest

import evenroad as er
from evenroad.driving import load_parking_case
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.testing import WorldContract
from tests.driving.oracle import BOX, HOOK, curve_of, poses
from tests.driving.polygon_oracle import PolygonOracle

BOUNDS = (0.0, 0.0), (6.5, 5.0)
STAR = [(1.0, 3.4), (1.4, 3.6), (1.2, 4.2), (1.7, 3.8), (2.2, 4.4), (2.0, 3.5), (2.6, 3.3), (1.8, 3.1), (1.5, 2.6)]
COURT = [(3.4, 2.4), (6.1, 2.6), (6.0, 4.8), (3.6, 4.6)], [(3.7, 2.7), (5.8, 2.9), (5.7, 4.5), (3.9, 4.3)]
"""A wall around a court: an outline and its hole."""
WALL = [(2.0, 0.3), (2.9, 1.3)]
SPECK = [(4.9, 1.0), (4.93, 1.0), (4.91, 1.04)]
BLOCK = [(0.2, 1.2), (1.1, 1.2), (1.1, 1.9), (0.2, 1.9)]


def yard(resolution=None):
    """A star, a court, a wall without thickness, a speck and a block."""
    return er.PolygonMap([STAR, COURT, WALL, SPECK, BLOCK], bounds=BOUNDS, resolution=resolution)


WORLDS = {
    "box, fine cells": yard().world(footprint=BOX, turning_radius=0.8),
    "hook, cells larger than polygons": yard(1.3).world(footprint=HOOK, turning_radius=0.6),
    "on the spot": yard(0.11).world(footprint=BOX),
    "holonomic": yard(0.11).world(footprint=BOX, holonomic=True),
}
EVERY = pytest.mark.parametrize("name", WORLDS)


class TestAmongPolygons(WorldContract):
    world = WORLDS["box, fine cells"]


@EVERY
def test_poses_are_free_where_every_side_is_separate(name):
    world = WORLDS[name]
    oracle, q = PolygonOracle(world.polygons, world.footprint.parts), poses(world, 120, 6)
    # Half of them at contact: a pose that is free moves towards one that is not.
    gaps = np.array([oracle.gap(pose) for pose in q])
    free, blocked = q[gaps > 0][:8], q[gaps < 0][:8]
    for a, b in zip(free, blocked, strict=False):
        low, high = 0.0, 1.0
        while high - low > 1e-9:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if oracle.gap(a + middle * (b - a)) > 0 else (low, middle)
        q = np.vstack([q, a + (low - 1e-7) * (b - a), a + (high + 1e-7) * (b - a)])
    gaps = np.array([oracle.gap(pose) for pose in q])
    certain = np.abs(gaps) > 5e-9
    assert certain.sum() > 130
    assert 20 < (gaps < 0).sum() < 150
    np.testing.assert_array_equal(world.valid(q)[certain], gaps[certain] > 0)
    inside = q[(gaps > 0)][:15]
    np.testing.assert_allclose(world.distance(inside), [oracle.distance(pose) for pose in inside], atol=3e-9)


def test_cells_decide_nothing():
    q = poses(WORLDS["on the spot"], 20_000, 1)
    a, b = q[:2000], q[:2000] + np.random.default_rng(2).normal(0.0, 0.4, (2000, 3))
    worlds = [yard(resolution).world(footprint=HOOK, turning_radius=0.7) for resolution in (0.02, 0.3, 4.0)]
    first = worlds[0]
    assert 1000 < first.valid(q).sum() < 19_000
    assert 20 < first.motion_valid(a, b).sum() < 1900
    for world in worlds[1:]:
        np.testing.assert_array_equal(world.valid(q), first.valid(q))
        np.testing.assert_array_equal(world.motion_valid(a, b), first.motion_valid(a, b))


@EVERY
def test_motions_are_free_where_no_pose_on_them_touches(name):
    world = WORLDS[name]
    oracle = PolygonOracle(world.polygons, world.footprint.parts)
    q = poses(world, 2000, 7)
    q = q[world.valid(q)][:60]
    a, b = q[:30], world.space.interpolate(q[:30], q[30:], np.random.default_rng(8).random(30) ** 2)
    near = 2e-3 if world.holonomic else 1e-3
    touches = np.array([oracle.touches(*curve_of(world, *each), near) for each in zip(a, b, strict=True)])
    free = world.motion_valid(a, b)
    assert 4 < free.sum() < 29
    assert (touches == None).sum() < 4  # noqa: E711
    assert not touches[free].any()
    assert (touches[~free] != False).all()  # noqa: E712


def test_what_touches_is_free_and_what_reaches_a_hair_further_is_not():
    walls = er.PolygonMap([[(3, 0), (3, 4)], [(1, 3), (2, 3), (2, 3.5)]], bounds=((0, 0), (6, 4)), resolution=0.35)
    world = walls.world(footprint=[(-1, -0.5), (0.5, -0.5), (0.5, 0.5), (-1, 0.5)])
    at_wall = np.array([(2.5, 1.0, 0.0), (1.0, 1.0, 0.0), (1.5, 2.5, 0.0), (3.5, 1.0, math.pi), (5.0, 0.5, math.pi)])
    assert world.valid(at_wall).all()
    inwards = np.array([(1e-8, 0, 0), (-1e-8, 0, 0), (0, 1e-8, 0), (-1e-8, 0, 0), (0, -1e-8, 0)])
    assert not world.valid(at_wall + inwards).any()
    assert world.motion_valid((1.6, 1.0, 0.0), (2.5, 1.0, 0.0))
    assert not world.motion_valid((1.6, 1.0, 0.0), (2.5 + 1e-8, 1.0, 0.0))


def test_it_says_what_is_touched_and_where():
    map_ = er.PolygonMap([WALL, BLOCK], bounds=BOUNDS, names=["the wall", "the block"])
    world = map_.world(footprint=BOX)
    assert world.explain((2.0, 0.8, 0.0)) == "its front right corner touches the wall at (2.3105, 0.645) by 0.207"
    assert world.explain((0.8, 1.6, 0.0)) == "its front side touches the block at (1.1, 1.595) by 0.15"
    small = map_.world(footprint=[(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)])
    assert small.explain((0.65, 1.55, 0.0)) == "it lies inside of the block"
    assert "reaches beyond the map" in world.explain((0.2, 3.0, 0.0))
    result = er.plan(world, (0.65, 1.55, 0.0), (5.0, 1.0, 0.0))
    assert result.status == "start_invalid"
    assert "the block" in result.message


def test_a_path_is_found_where_there_is_one_and_a_proof_where_there_is_none():
    def room(door):
        walls = [[(3, 0), (3, 2 - door / 2)], [(3, 2 + door / 2), (3, 4)]]
        return er.PolygonMap(walls, bounds=((0, 0), (6, 4)), resolution=0.02).world(footprint=BOX, turning_radius=0.5)

    found = er.plan(room(0.64), (1, 2, 0), (5, 2, 0))
    assert found.solved
    assert found.proof == "exact"
    oracle = PolygonOracle(room(0.64).polygons, [BOX])
    assert min(oracle.gap(pose) for pose in found.resample(0.05)) > -1e-9
    none = er.plan(room(0.58), (1, 2, 0), (5, 2, 0))
    assert none.status == "not_connected"
    assert "largest disk" in none.message


def test_a_corner_of_two_corridors_is_proved_too_narrow():
    box = [(-1.0, -0.2), (1.0, -0.2), (1.0, 0.2), (-1.0, 0.2)]

    def corner(wide):
        blocks = [[(0, 0), (4, 0), (4, 4), (0, 4)], [(0, 4 + wide), (4 + wide, 4 + wide), (4 + wide, 5 + wide), (0, 9)]]
        return er.PolygonMap(blocks, bounds=((0, 0), (4 + wide, 4 + wide)), resolution=0.03).world(footprint=box)

    # A rectangle of length 2 and width 0.4 gets around where corridors are wider than 1.1 or so.
    a, b = (1.2, 4.4, 0.0), (4.4, 1.2, -math.pi / 2)
    assert er.plan(corner(1.3), a, b).solved
    none = er.plan(corner(0.85), a, b)
    assert none.status == "not_connected"
    assert "slices" in none.message


def test_a_clearance_is_kept_and_a_copy_is_the_same():
    world = yard().world(footprint=BOX, turning_radius=0.8, clearance=0.1)
    copy = pickle.loads(pickle.dumps(world))
    q = poses(world, 3000, 3)
    np.testing.assert_array_equal(world.valid(q), copy.valid(q))
    assert world.fingerprint() == copy.fingerprint() != yard().world(footprint=BOX).fingerprint()
    assert (world.distance(q[world.valid(q)]) > 0.1 - 1e-6).all()


def test_geojson_is_read_with_holes_lines_and_names(tmp_path):
    ring = [*STAR, STAR[0]]
    features = [
        {"type": "Feature", "properties": {"name": "star"}, "geometry": {"type": "Polygon", "coordinates": [ring]}},
        {"type": "Feature", "geometry": {"type": "MultiPolygon", "coordinates": [[list(border) for border in COURT]]}},
        {"type": "Feature", "properties": {"id": 7}, "geometry": {"type": "LineString", "coordinates": WALL}},
        {"type": "Feature", "geometry": {"type": "Point", "coordinates": [0, 0, 5]}},
        {"type": "Feature", "geometry": None},
    ]
    file = tmp_path / "yard.geojson"
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    read = er.PolygonMap(file, bounds=BOUNDS)
    assert read.names == ("star", "polygon 1", "7")
    assert read.notes == (f"1 point of {file} are no obstacles",)
    for found, wanted in zip(read.polygons, ([STAR], COURT, [WALL]), strict=True):
        for border, corners in zip(found, wanted, strict=True):
            np.testing.assert_array_equal(sorted(border.tolist()), sorted(map(list, corners)))
    file.write_text(json.dumps({"type": "FeatureCollection", "features": features, "bbox": [-1, -2, 0, 9, 8, 3]}))
    assert [each.tolist() for each in er.PolygonMap(file).bounds] == [[-1, -2], [9, 8]]
    court = er.PolygonMap(file, bounds=BOUNDS).world(footprint=[(-0.1, -0.1), (0.1, -0.1), (0, 0.2)])
    assert court.valid((4.8, 3.6, 0.0))
    assert not court.valid((3.6, 3.6, 0.0))


def test_a_parking_case_is_read(tmp_path):
    file = tmp_path / "case.csv"
    file.write_text("1,1,0,5,1,3.1,2,3,4,2,2,3,2,3,3,4,0,5,0,5,0.5,4,0.5,\n")
    case = load_parking_case(file)
    assert case.map.names == ("polygon 0", "polygon 1")
    assert [len(each[0]) for each in case.map.polygons] == [3, 4]
    np.testing.assert_array_equal(case.goal, (5, 1, 3.1))
    assert np.ptp(case.map.bounds, axis=0).tolist() == [6.0, 5.0]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.geojson", "[1]", "is not GeoJSON: an object with a type"),
        ("a.geojson", '{"type": "Polygone", "coordinates": []}', "did you mean 'Polygon'"),
        ("a.geojson", '{"type": "Polygon", "coordinates": [[[0, 1], [1]]]}', "must have positions"),
        ("a.geojson", '{"type": "Polygon", "coordinates": 5}', "must have a list"),
        ("a.geojson", "{", "is not JSON"),
        ("a.geojson", '{"type": "FeatureCollection", "features": [], "bbox": [0, 1]}', "four or six finite numbers"),
        ("a.geojson", '{"type": "FeatureCollection", "features": [], "bbox": [0, 1, 0, 2]}', "before the largest"),
        ("a.csv", "1,2,x", "numbers alone"),
        ("a.csv", "1,2,3,4,5,6,1,3,0,0", "need 6"),
        ("a.csv", "1,2,3,4,5,6,1.5,3,0,0", "is no parking case"),
        ("a.csv", "1,2,3,4,5,6,1e300,3,0,0", "is no parking case"),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, name, text, said):
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(BrokenFile) as refused:
        er.PolygonMap(file)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("polygons", "options", "said"),
    [
        ([[(0, 0), (1, 0), (math.nan, 1)]], {}, "corners of polygon 0 must be finite"),
        ([[(0, 0), (0, 0)]], {}, "two different corners"),
        ([[(0, 0, 1), (1, 0, 1)]], {}, r"polygons must be corners \(n, 2\) each"),
        (5, {}, r"polygons must be corners \(n, 2\) each"),
        ([], {}, "must have bounds"),
        ([STAR], {"bounds": ((1, 1), (0, 2))}, "the least and the largest"),
        ([STAR], {"resolution": 1e-5}, "resolution must be larger"),
        ([[(0, 0), (1e9, 0)]], {"bounds": BOUNDS}, "must reach at most"),
        ([STAR], {"names": ["a", "b"]}, "names must be one for each of 1 polygon"),
    ],
)
def test_what_is_no_polygon_is_refused(polygons, options, said):
    with pytest.raises(InvalidValue, match=said):
        er.PolygonMap(polygons, **options)


def test_a_footprint_that_is_larger_than_a_small_obstacle_asks_for_bounds():
    speck = er.PolygonMap([[(3, 3), (3.1, 3), (3, 3.1)]])
    with pytest.raises(InvalidValue, match="bounds= of the PolygonMap"):
        speck.world(footprint=BOX)
    with pytest.raises(InvalidValue, match="bounds= of the PolygonMap"):
        speck.world(footprint=[(0, 0), (0.01, 0), (0, 0.01)], turning_radius=1.0)


def test_a_disk_and_other_files_are_refused():
    with pytest.raises(InvalidValue, match="polygons go with footprint="):
        yard().world(0.3)
    with pytest.raises(UnknownName, match="suffix"):
        er.PolygonMap("a.shp")
    assert yard().grid.world(0.3).valid((4.8, 3.6))
