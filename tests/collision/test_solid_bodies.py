"""A body inside of a solid is not free, whatever the solid is made of and however little of it is in reach."""

from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.geometry import Mesh, PointCloud, Pose
from evenroad.scenes.scene import Obstacle
from tests.collision.solid_bodies import (
    LONG,
    RADIUS,
    SOLIDS,
    Solid,
    at,
    ball_arm,
    distance,
    doubled,
    places_of,
    with_collapsed,
    with_sheets,
)
from tests.robots.surface_scenes import half_turned

BAND = 2e-5
"""Nearer to contact than this [m] either verdict is right, but single precision says blocked."""
ARM = ball_arm()


@pytest.fixture(scope="module", params=SOLIDS)
def case(request, tmp_path_factory):
    """A world with solids, places, and how far the ball is from the solids there."""
    make, solids = SOLIDS[request.param]
    world = er.ArmWorld(ARM, make(tmp_path_factory.mktemp("solid")))
    places = places_of(solids, np.random.default_rng(0), 400)
    return world, places, distance(solids, places) - RADIUS


def test_what_is_inside_or_touches_is_blocked_and_all_else_is_free(case):
    world, places, apart = case
    free = world.valid(at(places))
    assert not free[apart < 0.0].any()
    assert free[apart > BAND].all()


def test_the_distance_is_above_0_exactly_where_it_is_free(case):
    world, places, apart = case
    q = at(places)[::3]
    free, metres = world.valid(q), world.distance(q).metres
    np.testing.assert_array_equal(metres > 0.0, free)
    assert (metres <= np.clip(apart[::3], 0.0, 1.0)).all()
    assert (metres >= np.clip(apart[::3], 0.0, 1.0) - BAND).all()
    explained = [world.explain(row) == "it is free" for row in q[::10]]
    np.testing.assert_array_equal(explained, free[::10])


def sampled(name, folder, count=300, seed=1):
    """The scene of a solid, places around it, and their distances from it."""
    make, solids = SOLIDS[name]
    places = places_of(solids, np.random.default_rng(seed), count)
    return make(folder), places, distance(solids, places)


SOME = ("a block, its face far", "a block around all, faces either way", "bars that cross, one inside out", "a room",
        "a height map", "an OctoMap")  # fmt: skip


@pytest.mark.parametrize("name", SOME)
def test_clearance_of_a_world_or_an_obstacle_and_padding_come_on_top(name, tmp_path):
    scene, places, apart = sampled(name, tmp_path)
    q = at(places)
    farther = scene.with_clearance(dict.fromkeys(scene.names, 0.02))
    for world in (er.ArmWorld(ARM, scene, clearance=0.02), er.ArmWorld(ARM, farther),
                  er.ArmWorld(replace(ARM, padding=(("tip", 0.02),)), scene)):  # fmt: skip
        free = world.valid(q)
        assert not free[apart < RADIUS + 0.02].any()
        assert free[apart > RADIUS + 0.02 + BAND].all()


@pytest.mark.parametrize("name", SOME)
def test_nothing_is_proved_planned_or_moved_through_a_solid(name, tmp_path):
    scene, places, apart = sampled(name, tmp_path)
    world = er.ArmWorld(ARM, scene)
    q = at(places)
    rng = np.random.default_rng(2)
    a, b = rng.permutation(q)[:400], rng.permutation(q)[:400]
    proved = world.motion_certified(a, b, 1e-4)
    solids = SOLIDS[name][1]
    for share in np.linspace(0.0, 1.0, 60):
        yaw, pitch, slide = (a + share * (b - a)).T
        there = np.stack([np.sin(pitch) * np.cos(yaw), np.sin(pitch) * np.sin(yaw), np.cos(pitch)], axis=1)
        assert not (proved & (distance(solids, slide[:, np.newaxis] * there) < RADIUS)).any()
    inside = q[apart < 0.0][:4]
    answers = er.plan_many(world, inside, inside[::-1], seconds=1.0)
    assert not answers.solved.any()
    one = er.plan(world, inside[0], inside[1], seconds=1.0)
    assert (one.solved, one.status) == (False, "start_invalid")


def test_a_solid_that_comes_or_moves_is_solid():
    block = Obstacle("block", SOLIDS["a block, its face near"][0](None).obstacles[0].body)
    away = block.at(er.Pose((10.0, 0.0, 0.0)))
    inside = at(np.array([[0.9, 0.0, 0.0], [0.31, 0.1, 0.1], [0.0, 0.9, 0.0]]))
    empty = er.ArmWorld(ARM, er.Scene([]))
    for world in (empty.with_(block), empty.with_(away).moved({"block": block.body.pose}),
                  empty.within(er.Scene([block]))):  # fmt: skip
        assert world.valid(inside).tolist() == [False, False, True]
    assert empty.with_(block).moved({"block": away.body.pose}).valid(inside).all()


def test_open_sheets_within_a_block_open_no_place_in_it():
    make, solids = SOLIDS["a block, its face near"]
    mesh = with_sheets(make(None).obstacles[0].body.triangles)
    places = places_of(solids, np.random.default_rng(3), 20_000)
    inside = distance(solids, places) < 0.0
    assert not er.ArmWorld(ARM, er.Scene([Mesh(mesh)])).valid(at(places[inside])).any()


@pytest.mark.parametrize("change", [lambda mesh: mesh, half_turned, doubled, with_collapsed])
def test_a_held_solid_goes_around_what_is_within_it(change):
    held = Mesh(change(Solid((0.4, 0.4, 0.4)).mesh()))
    robot = ARM.holding(held, "tip", name="crate")
    within = (er.Box((0.02, 0.02, 0.02), xyz=(0.5, 0.1, 0.1)), er.Sphere(0.02, xyz=(0.5, 0.1, 0.1)),
              Mesh(Solid((0.02, 0.02, 0.02), Pose((0.5, 0.1, 0.1))).mesh()),
              PointCloud([[0.5, 0.1, 0.1]], 0.02))  # fmt: skip
    q = at(np.array([[0.5, 0.0, 0.1], [-0.5, 0.0, 0.0]]))
    for body in within:
        assert er.ArmWorld(robot, er.Scene([body])).valid(q).tolist() == [False, True]


def test_a_held_solid_within_a_solid_is_blocked(tmp_path):
    robot = ARM.holding(Mesh(half_turned(Solid((0.05, 0.05, 0.05)).mesh())), "tip", name="crate")
    for name in SOME:
        scene, places, apart = sampled(name, tmp_path)
        assert not er.ArmWorld(robot, scene).valid(at(places[apart < 0.0])).any()


def test_a_face_just_beyond_reach_counts_between_a_place_and_the_middle_of_its_cell():
    end = er.ArmWorld(ARM).robot_tables.reach + 1e-4
    places = np.random.default_rng(4).normal(0.0, 0.02, (200, 3))
    places[:, 0] = np.sqrt((LONG - 1e-9) ** 2 - (places[:, 1:] ** 2).sum(axis=1))
    for face in np.linspace(-0.9, 0.6, 12):
        slab = Solid((end - face, 4.0, 4.0), Pose((0.5 * (end + face), 0.0, 0.0)))
        assert not er.ArmWorld(ARM, er.Scene([Mesh(slab.mesh())])).valid(at(places)).any()
