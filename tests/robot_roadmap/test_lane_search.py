"""Ways that are to be drawn tight: free at their states, but for what has to be proved at once; plans all the same."""

import itertools
import math

import numpy as np
import pytest

from evenroad.roadmap import Budget
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap
from evenroad.robot_roadmap.search_memory import FOUND
from tests.robot.kernel_arms import box_scene, ur5
from tests.robot.oracle import clearance
from tests.robot.test_tighten import with_ball_beside


@pytest.fixture(scope="module")
def roadmap():
    """Of states so far apart that many a motion is free at them, and cannot be proved."""
    return make_roadmap(ur5(limits=math.pi, joints=5), None, 96, ends=150, resolution=1.0)


@pytest.fixture(scope="module")
def pairs(roadmap):
    world = SceneRoadmap(roadmap, box_scene()).world
    q = world.space.from_cube(np.random.default_rng(3).random((600, 5)))
    q = q[world.valid(q)]
    return np.stack([q[:120:2], q[1:120:2]], axis=1)


def way(known, start, goal, proved=False):
    """The way of a new query, (p, dim), or None; along what is only free, where no proof is asked for."""
    asked = known._ask(start, goal[np.newaxis], 10**6, math.inf, 40, proved=proved)
    assert asked.proved == proved
    return asked.path if asked.ended == FOUND else None


def certified(known, path):
    return known.world.motion_certified(path[:-1], path[1:], RECHECK_TOLERANCE)


def test_ways_that_are_to_be_drawn_tight_are_free_at_states_and_straight_ones_proved(roadmap, pairs):
    unproved = straight = 0
    for start, goal in pairs:
        path, known = way(SceneRoadmap(roadmap, box_scene()), start, goal), SceneRoadmap(roadmap, box_scene())
        if path is None:
            continue
        assert known.world.motion_valid(path[:-1], path[1:]).all()
        np.testing.assert_array_equal(path[[0, -1]], [start, goal])
        unproved += not certified(known, path).all()
        if len(path) == 2:
            straight += 1
            assert certified(known, path).all()
        proved = way(known, start, goal, proved=True)
        assert proved is None or certified(known, proved).all()
    assert min(unproved, straight) >= 5


def test_links_of_ends_that_nearly_touch_something_are_proved_first(roadmap, pairs):
    rng, unproved, touching = np.random.default_rng(4), 0, 0
    for start, goal in pairs[:24]:
        free = SceneRoadmap(roadmap, box_scene())
        without = way(free, start, goal)
        if without is None or len(without) < 3:
            continue
        unproved += not certified(free, without)[[0, -1]].all()
        world = with_ball_beside(free.world, start, 4e-4, rng.normal(size=3))
        if not 3e-4 < clearance(world.robot, world.scene, start[np.newaxis])[0] < 6e-4:
            continue
        for ends, row in (((start, goal), 0), ((goal, start), -1)):
            known = SceneRoadmap(roadmap, world.scene)
            path = way(known, *ends)
            if path is not None and len(path) > 2:
                assert certified(known, path)[row]
                touching += 1
    assert unproved >= 3
    assert touching >= 10


def test_a_plan_of_which_nothing_tight_is_proved_is_asked_again_and_proved(roadmap, pairs, monkeypatch):
    found, again, ask = [], 0, SceneRoadmap._ask

    def listed(*given, **flags):
        found.append(ask(*given, **flags))
        return found[-1]

    monkeypatch.setattr(SceneRoadmap, "_ask", listed)
    for (start, goal), shorten in itertools.product(pairs, (True, False)):
        known = SceneRoadmap(roadmap, box_scene())
        found.clear()
        result = known.plan(start, goal, shorten=shorten, budget=Budget(motions=3000))
        if not result.solved:
            continue
        assert certified(known, result.path).all()
        dense = [
            a + np.linspace(0.0, 1.0, 20)[:, np.newaxis] * (b - a) for a, b in itertools.pairwise(result.path)
        ]
        assert clearance(known.world.robot, known.world.scene, np.concatenate(dense)).min() > 0.0
        first = found[0]
        if first.ended == FOUND and len(found) > 1:
            again += 1
            assert shorten
            assert not certified(known, first.path).all()
            assert result.counts["edges_checked"] >= first.motions
    assert again >= 3
