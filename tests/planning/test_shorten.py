"""Shortened paths of arms: not longer, about as short as the batch shortcut's, and free at every state."""

from functools import partial

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.planning.arm_trees import connect, shorten, smooth
from evenroad.planning.shortcut import shortcut
from tests.robots.oracle import clearance
from tests.robots.paths import GOAL, START, box_world, dense_states, length, proved

TIGHTENED = partial(smooth, batches=400)


def test_shortened_paths_are_free_proved_not_longer_and_keep_their_ends(paths):
    world, found = paths
    ours, theirs, every = 0.0, 0.0, []
    for path in found:
        shorter, motions = shorten(world, path)
        assert motions > 0
        every.append(shorter)
        np.testing.assert_array_equal(shorter[[0, -1]], path[[0, -1]])
        assert world.space.contains(shorter).all()
        assert clearance(world.robot, world.scene, dense_states(world, shorter, 5)).min() > 0.0
        assert length(world, shorter) <= length(world, path) * (1 + 1e-12)
        ours, theirs = ours + length(world, shorter), theirs + length(world, shortcut(world, path)[0])
    assert proved(world, *every)
    # About as short as those of all pairs.
    assert ours <= 1.03 * theirs
    again, motions_again = shorten(world, path)
    np.testing.assert_array_equal(shorter, again)
    assert motions == motions_again


def test_a_path_to_and_fro_becomes_as_short_as_it_is_one_way():
    world = box_world()
    path = connect(world, START, [GOAL], seconds=60).path
    detour = np.concatenate([path, path[::-1], path])
    shorter, _ = shorten(world, detour)
    assert length(world, shorter) <= length(world, path) * (1 + 1e-12)
    assert clearance(world.robot, world.scene, dense_states(world, shorter)).min() > 0.0
    for straight in (np.stack([START, START + 0.1]), np.stack([START, START])):
        for shortened in (shorten(world, straight), TIGHTENED(world, straight)):
            np.testing.assert_array_equal(shortened[0], straight)


def test_a_path_of_hundreds_of_waypoints_is_no_trouble():
    world = box_world()
    path = connect(world, START, [GOAL], seconds=60).path
    ends = np.repeat(path[:-1], 60, axis=0), np.repeat(path[1:], 60, axis=0)
    many = world.space.interpolate(*ends, np.tile(np.arange(60) / 60, len(path) - 1))
    many = np.concatenate([many, path[-1:]])
    shorter, _ = shorten(world, many)
    assert length(world, shorter) <= length(world, path) * (1 + 1e-9)
    assert len(shorter) < len(path) + 20
    assert clearance(world.robot, world.scene, dense_states(world, shorter)).min() > 0.0


@pytest.mark.parametrize("shortened", [shorten, TIGHTENED])
@pytest.mark.parametrize("path", [
    [START], np.empty((0, 5)), START, np.full((3, 5), np.nan), np.stack([START, START + np.inf, START]),
    np.zeros((3, 4)), np.zeros((3, 6)), [START, START + np.nan], [START, GOAL, ["x"] * 5],
])  # fmt: skip
def test_what_is_no_path_is_refused(path, shortened):
    with pytest.raises(InvalidValue):
        shortened(box_world(), path)
