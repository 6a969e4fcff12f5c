"""Proofs of whole paths: what they leave is proved by double precision, and a bent motion keeps its ends."""

from dataclasses import replace

import numpy as np
import pytest

from evenroad._native import planning
from evenroad.planning.arm_trees import checks_of
from evenroad.robot.tree_sequences import sphere_points
from tests.robot.oracle import clearance
from tests.robot.test_kernel_smoothing import proved
from tests.robot.test_trees import box_world

MOST_BENT = 2
"""So many motions of a path are bent at most."""


def proved_path(world, path):
    """The path whose motions are all proved, with bends; without waypoints where there is none."""
    margins = planning.CLEARANCES
    found = planning.prove_or_bend(
        checks_of(world, margins), path, margins[0], sphere_points(world.space.dim)
    )
    return path[:0] if found is None else found


@pytest.fixture(scope="module")
def motions():
    """A world whose states are far apart, and motions free at them: such that are not proved, and such that are."""
    world = replace(box_world(), resolution=0.2)
    q = world.space.from_cube(np.random.default_rng(5).random((60_000, world.space.dim)))
    q = q[world.valid(q)]
    a, b = q[0::2][: len(q) // 2], q[1::2]
    some = np.stack([a, b], axis=1)[world.motion_valid(a, b)]
    sure = world.motion_certified(some[:, 0], some[:, 1], 1e-6)
    return world, some[~sure], some[sure]


def test_a_motion_that_is_not_proved_is_bent_and_both_ways_are_proved(motions):
    world, doubtful, _ = motions
    bent = lost = 0
    for motion in doubtful[:60]:
        path = proved_path(world, motion)
        if not len(path):
            lost += 1
            continue
        bent += 1
        assert path.shape == (3, world.space.dim)
        np.testing.assert_array_equal(path[[0, -1]], motion)
        assert np.linalg.norm(path[1] - motion.mean(axis=0)) == pytest.approx(world.resolution)
        assert proved(world, path)
        dense = np.concatenate([np.linspace(path[i], path[i + 1], 500) for i in range(2)])
        assert clearance(world.robot, world.scene, dense).min() > 0.0
    assert bent >= 10
    # What goes right through is not made a way around.
    assert lost >= 1


def test_a_proved_path_stays_as_it_is(motions):
    world, _, certain = motions
    for motion in certain[:40]:
        to_and_fro = motion[[0, 1, 0]]
        np.testing.assert_array_equal(proved_path(world, to_and_fro), to_and_fro)


def test_no_more_motions_are_bent_than_there_are_rows_for(motions):
    world, doubtful, _ = motions
    motion = next(m for m in doubtful if len(proved_path(world, m)))
    for passes in range(1, MOST_BENT + 3):
        path = proved_path(world, motion[np.arange(passes + 1) % 2])
        assert len(path) == (2 * passes + 1 if passes <= MOST_BENT else 0)


def test_the_same_motion_is_bent_at_the_same_place(motions):
    world, doubtful, certain = motions
    for motion in doubtful[:10]:
        first = proved_path(world, motion)
        proved_path(world, certain[0])
        np.testing.assert_array_equal(proved_path(world, motion), first)
