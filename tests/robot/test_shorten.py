"""Shortened paths of arms: not longer, about as short as the batch shortcut's, and free at every state."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.planning.arm_trees import connect, shorten
from evenroad.roadmap.shortcut import shortcut
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from tests.robot.kernel_arms import random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance
from tests.robot.test_trees import GOAL, START, box_world, dense_states

ARMS = {
    "ur5": (ur5(np.pi), random_scene(5), 25),
    "seven joints": (seven_joint_arm(), random_scene(3), 25),
    "tree": (random_tree(8), random_scene(108, spread=0.7, clear=0.45), 25),
    "tree with a joint that wraps": (random_tree(13), random_scene(113, spread=0.7, clear=0.45), 25),
}


def length(world, path):
    return world.space.distance(path[:-1], path[1:]).sum()


def queries(world, count, seed=0):
    q = world.space.from_cube(np.random.default_rng(seed).random((200 * count, world.space.dim)))
    q = q[world.valid(q)][: 2 * count]
    return zip(q[0::2], q[1::2], strict=True)


@pytest.fixture(scope="module", params=ARMS)
def paths(request):
    """A world, and paths in it as the trees give them."""
    robot, scene, count = ARMS[request.param]
    world = ArmWorld(robot, scene)
    found = [connect(world, a, [b], most_motions=5_000, seconds=30).path for a, b in queries(world, count)]
    found = [path for path in found if len(path) > 2]
    assert len(found) > count / 4
    return world, found


def test_no_shortened_path_touches_anything(paths):
    world, found = paths
    for path in found:
        shorter, _ = shorten(world, path)
        assert clearance(world.robot, world.scene, dense_states(world, shorter)).min() > 0.0


def test_every_motion_is_proved(paths):
    world, found = paths
    proofs = CertifiedWorld(replace(world, backend="scalar"), 1e-6)
    for path in found:
        shorter, motions = shorten(world, path)
        assert proofs.motion_valid(shorter[:-1], shorter[1:]).all()
        assert motions > 0


def test_paths_keep_their_ends_and_become_shorter(paths):
    world, found = paths
    for path in found:
        shorter, _ = shorten(world, path)
        np.testing.assert_array_equal(shorter[[0, -1]], path[[0, -1]])
        assert length(world, shorter) <= length(world, path) * (1 + 1e-12)
        assert world.space.contains(shorter).all()


def test_paths_are_about_as_short_as_those_of_all_pairs(paths):
    world, found = paths
    ours = sum(length(world, shorten(world, path)[0]) for path in found)
    theirs = sum(length(world, shortcut(world, path)[0]) for path in found)
    assert ours <= 1.03 * theirs


def test_the_same_path_gives_the_same_path(paths):
    world, found = paths
    first, motions = shorten(world, found[0])
    again, motions_again = shorten(world, found[0])
    np.testing.assert_array_equal(first, again)
    assert motions == motions_again


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_both_backends_shorten(backend):
    world = box_world(backend)
    path = connect(box_world(), START, [GOAL], seconds=60).path
    detour = np.concatenate([path, path[::-1], path])
    shorter, _ = shorten(world, detour)
    assert length(world, shorter) <= length(world, path) * (1 + 1e-12)
    assert clearance(world.robot, world.scene, dense_states(world, shorter)).min() > 0.0


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_a_straight_path_stays(backend):
    world = box_world(backend)
    path = np.stack([START, START + 0.1])
    np.testing.assert_array_equal(shorten(world, path)[0], path)
    twice = np.stack([START, START])
    np.testing.assert_array_equal(shorten(world, twice)[0], twice)


def test_a_path_of_hundreds_of_waypoints_is_no_trouble():
    world = box_world()
    path = connect(world, START, [GOAL], seconds=60).path
    many = world.space.interpolate(
        np.repeat(path[:-1], 60, axis=0),
        np.repeat(path[1:], 60, axis=0),
        np.tile(np.arange(60) / 60, len(path) - 1),
    )
    many = np.concatenate([many, path[-1:]])
    shorter, _ = shorten(world, many)
    assert length(world, shorter) <= length(world, path) * (1 + 1e-9)
    assert len(shorter) < len(path) + 20
    assert clearance(world.robot, world.scene, dense_states(world, shorter)).min() > 0.0


@pytest.mark.parametrize("path", [[START], np.empty((0, 5)), START, np.full((2, 5), np.nan)])
def test_what_is_no_path_is_refused(path):
    with pytest.raises(InvalidValue):
        shorten(box_world(), path)
