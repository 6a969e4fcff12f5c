"""Cubicles and Twistycool: the protocol's numbers, free shares, and what is walled off from what."""

import math

import numpy as np
import pytest

from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad_studies.problems import source_named
from evenroad_studies.problems.puzzles import cubicles, pillar, twistycool
from evenroad_studies.rules import KEarlier
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld
from tests.plan_on import plan_on

NAMES = ["cubicles", "twistycool", "cubicles-6d", "twistycool-6d"]


@pytest.mark.parametrize("name", NAMES)
def test_a_puzzle_moves_by_the_rules_of_the_protocol(name):
    source = source_named(name)
    problem = source.make(0)
    assert source.set_dim == problem.set_dim == (6 if name.endswith("6d") else 3)
    space, world = problem.world.space, problem.world
    assert (space.dim, space.cube_dim, space.combine, space.weights) == (7, 6, "sum", (1.0, 1.0))
    box = space.parts[0]
    way, turn = world.resolution
    assert way == pytest.approx(0.01 * math.dist(box.low, box.high))
    assert turn == pytest.approx(0.01 * math.pi / 2)
    np.testing.assert_array_equal([problem.start[3:], problem.goal[3:]], [[1, 0, 0, 0]] * 2)
    assert world.valid(np.stack([problem.start, problem.goal])).all()


def test_sets_of_three_dimensions_give_the_translation_and_turns_are_uniform():
    problem = source_named("twistycool").make(0)
    points = draw("halton", 400, 3, rng=0)
    q = problem.configurations(points, np.random.default_rng(1))
    box = problem.world.space.parts[0]
    np.testing.assert_allclose(q[:, :3], box.from_cube(points.points))
    # The mean of q q^T over uniform unit quaternions is a quarter of the identity.
    np.testing.assert_allclose(q[:, 3:].T @ q[:, 3:] / len(q), np.eye(4) / 4, atol=0.08)
    assert source_named("twistycool-6d").make(0).configurations(
        draw("halton", 400, 6, rng=0), np.random.default_rng(1)
    ).shape == (400, 7)


@pytest.mark.parametrize(("name", "share"), [("cubicles", 0.4288), ("twistycool", 0.705)])
def test_the_free_share_is_that_of_the_original(name, share):
    n = 150_000
    world = source_named(name).make(0).world
    free = world.valid(world.space.from_cube(np.random.default_rng(0).random((n, 6)))).mean()
    # The reference shares are rounded, so that half of their last digit is granted, too.
    assert abs(free - share) < 4 * math.sqrt(share * (1 - share) / n) + 5e-4


def test_the_body_of_cubicles_has_the_volume_of_the_original():
    volume = sum(8 * np.prod(box.half_extents) for box in cubicles().body)
    assert volume == pytest.approx(50897, rel=1e-3)


def test_the_body_of_twistycool_is_hooked_and_tilted():
    corners = np.concatenate([box.corners for box in twistycool().body])
    nearest = np.abs(corners - (-16.99, -17.906, -24.839)).sum(axis=1).min()
    assert nearest == pytest.approx(0.0, abs=1e-9)
    # The far end of the first bar: 55 along the tilted axis.
    a = math.atan2(2.63, 54.94)
    far = np.array([-16.99 + 55 * math.cos(a), -17.906, -24.839 + 55 * math.sin(a)])
    assert np.abs(corners - far).sum(axis=1).min() == pytest.approx(0.0, abs=1e-9)


def without(puzzle_world, name):
    obstacles = [box for box in puzzle_world.obstacles if box.name != name]
    return SolidWorld(puzzle_world.space, puzzle_world.body, obstacles, puzzle_world.resolution)


def test_the_plate_of_twistycool_is_between_start_and_goal():
    problem = source_named("twistycool").make(0)
    start, goal = problem.start[np.newaxis], problem.goal[np.newaxis]
    assert not problem.world.motion_valid(start, goal)[0]
    assert without(problem.world, "plate").motion_valid(start, goal)[0]


def test_a_path_through_the_window_is_found():
    problem = source_named("twistycool").make(0)
    points = draw("uniform", 1024, 6, rng=0)
    result = plan_on(problem.world, problem.start, problem.goal, points, rule=KEarlier(10), links=None, smooth=False)
    assert result.solved
    assert problem.world.motion_valid(result.path[:-1], result.path[1:]).all()
    assert result.path[0, 2] > -293.0 > -305.0 > result.path[-1, 2]


def test_the_goal_of_cubicles_has_no_way_in_but_from_below():
    """From a large roadmap: with the floor closed there is no way, with its holes there is one."""
    problem = source_named("cubicles").make(0)
    world = problem.world
    bottom = 9.84 / 2
    holes = [
        OrientedBox([203.0, y, bottom], [93.0, half, bottom], name="lid") for y, half in ((-145.5, 54.5), (384.0, 81.0))
    ]
    closed = SolidWorld(world.space, world.body, [*world.obstacles, *holes], world.resolution)
    points = draw("halton", 3000, 6, rng=0)
    ways = [
        plan_on(
            scene, problem.start, problem.goal, points, rule=KNearest(10), links=None, success_only=True, smooth=False
        ).solved
        for scene in (world, closed)
    ]
    assert ways == [True, False]


def test_a_pillar_is_the_hexagon_in_its_bounding_box():
    """Three boxes of one pillar cover the hexagon and no more: area, extents, and corners on one circle."""
    boxes = pillar((0.0, 66.0), (0.0, 66.0 * math.sqrt(3) / 2), (0.0, 10.0))
    corners = np.concatenate([box.corners for box in boxes])
    np.testing.assert_allclose(corners.min(axis=0), [0, 0, 0], atol=0.01)
    np.testing.assert_allclose(corners.max(axis=0), [66.0, 66.0 * math.sqrt(3) / 2, 10.0], atol=0.01)
    radius = np.linalg.norm(corners[:, :2] - [33.0, 33.0 * math.sqrt(3) / 2], axis=1)
    np.testing.assert_allclose(radius, 33.0, atol=0.01)


@pytest.mark.parametrize(("width", "depth"), [(66.0, 76.0), (63.0, 72.0), (63.5, 57.0), (58.0, 50.0)])
def test_turned_pillars_fill_their_bounding_boxes(width, depth):
    corners = np.concatenate([box.corners for box in pillar((0.0, width), (0.0, depth), (0.0, 1.0))])
    extents = np.ptp(corners, axis=0)
    np.testing.assert_allclose(extents[:2], [width, depth], atol=0.3)
