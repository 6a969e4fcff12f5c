"""Counting: same answers, and every question counted."""

from __future__ import annotations

import numpy as np

from evenroad.testing import WorldContract
from evenroad.world import Explains, GridMap
from evenroad_studies.worlds import Corridor
from tests.counting import Counting

CORRIDOR = Corridor(2, 0.3)


class TestCounting(WorldContract):
    world = Counting(CORRIDOR)
    free_between = False


def test_answers_are_the_worlds_and_questions_are_counted():
    q = np.random.default_rng(0).random((30, 2))
    world = Counting(CORRIDOR)
    np.testing.assert_array_equal(world.valid(q), CORRIDOR.valid(q))
    np.testing.assert_array_equal(
        world.motion_valid(q[:10], q[10:20]), CORRIDOR.motion_valid(q[:10], q[10:20])
    )
    assert (world.configurations, world.motions) == (30, 10)
    world.valid(q[:0])
    world.motion_valid(q, q)
    assert (world.configurations, world.motions) == (30, 40)
    assert world.space is CORRIDOR.space


def test_a_world_explains_itself_through_the_count_if_it_does_without():
    disk = GridMap(np.zeros((10, 10), dtype=bool)).world(2.0)
    assert isinstance(Counting(disk), Explains)
    assert Counting(disk).explain(np.array([0.5, 5.0])) == disk.explain(np.array([0.5, 5.0]))
    assert not isinstance(Counting(CORRIDOR), Explains)
