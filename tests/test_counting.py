"""Counting: same answers, and every question counted."""

from types import SimpleNamespace

import numpy as np

from evenroad.space import BoxSpace
from evenroad.testing import WorldContract
from evenroad.world import Explains, FunctionWorld, GridMap
from tests.counting import Counting

CORRIDOR = FunctionWorld(BoxSpace([0, 0], [1, 1]), lambda q: (q[:, 0] < 0.3) | (q[:, 1] > 0.7), 0.01)


class TestCounting(WorldContract):
    world = Counting(CORRIDOR)
    free_between = False


def test_answers_are_the_worlds_and_questions_are_counted():
    q = np.random.default_rng(0).random((30, 2))
    world = Counting(CORRIDOR)
    np.testing.assert_array_equal(world.valid(q), CORRIDOR.valid(q))
    np.testing.assert_array_equal(world.motion_valid(q[:10], q[10:20]), CORRIDOR.motion_valid(q[:10], q[10:20]))
    assert (world.configurations, world.motions) == (30, 10)
    world.valid(q[:0])
    world.motion_valid(q, q)
    assert (world.configurations, world.motions) == (30, 40)
    assert world.space is CORRIDOR.space


def test_a_world_explains_itself_through_the_count_if_it_does_without():
    disk = GridMap(np.zeros((10, 10), dtype=bool)).world(2.0)
    assert isinstance(Counting(disk), Explains)
    assert Counting(disk).explain(np.array([0.5, 5.0])) == disk.explain(np.array([0.5, 5.0]))
    plain = SimpleNamespace(space=CORRIDOR.space, valid=CORRIDOR.valid, motion_valid=CORRIDOR.motion_valid)
    assert not isinstance(Counting(plain), Explains)
