"""The search where questions are dear: it finds what the lazy search finds, with fewer questions."""

from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap
from tests.robot.kernel_arms import box_scene, ur5


class Counted:
    """An arm's world that is no arm's world, and counts what it is asked; `soon` says what it proves for little."""

    backend, proof = "other", "resolution"

    def __init__(self, world):
        self.world, self.space, self.explain = world, world.space, world.explain
        self.valid, self.motion_valid, self.shorten = world.valid, world.motion_valid, world.shorten
        self.motions = []

    def motion_certified(self, a, b, tolerance):
        free = self.world.motion_certified(a, b, tolerance)
        self.motions += zip(map(tuple, a.tolist()), map(tuple, b.tolist()), free.tolist(), strict=True)
        return free


class TwoStage(Counted):
    """Proves half of the motions that are free for little."""

    def proved(self, q):
        return self.world.valid(q) & (q[:, 1] < -0.8)

    def motion_proved(self, a, b):
        return self.proved(a) & self.proved(b) & self.world.motion_certified(a, b, 1e-6)


@pytest.fixture(scope="module")
def roadmap():
    """Three joints of two turns each, on a table."""
    cell = box_scene()
    on_table = frozenset(pair for pair in cell.allowed if pair[1] == "table")
    cell = replace(cell, obstacles=cell.obstacles[:1], allowed=on_table)
    return make_roadmap(ur5(joints=3), cell, 48, k=5, gamma=2.0)


def dear(roadmap, kind=Counted):
    known = SceneRoadmap(roadmap, box_scene())
    known._asked = kind(known.world), kind(known._day)
    return known


def asked(known):
    return [motion for world in known._asked for motion in world.motions]


def queries(known, count):
    q = known.world.space.from_cube(np.random.default_rng(5).random((4000, 3)))
    q = q[known.world.valid(q) & (q[:, 1] > -np.pi) & (q[:, 1] < 0.0)]
    q = q[np.argsort(q[:, 0])]
    far = np.stack([q[: len(q) // 2], q[::-1][: len(q) // 2]], axis=1)
    return far[~known.world.motion_valid(far[:, 0], far[:, 1])][:count]


@pytest.mark.parametrize("kind", [Counted, TwoStage])
def test_it_finds_a_way_where_the_lazy_search_does_and_each_motion_is_proved(roadmap, kind):
    found, lazy, known = 0, SceneRoadmap(roadmap, box_scene()), dear(roadmap, kind)
    for start, goal in queries(known, 25):
        few = known.connect(start, goal[np.newaxis])
        assert few.goal == lazy.connect(start, goal[np.newaxis]).goal
        if few.goal == 0:
            found += len(few.path) > 2
            np.testing.assert_array_equal(few.path[[0, -1]], [start, goal])
            assert known.world.recheck(few.path).all()
    assert found > 5


def test_no_motion_is_asked_about_twice_in_a_query_and_known_ones_never_again(roadmap):
    known = dear(roadmap)
    for start, goal in queries(known, 10):
        known.connect(start, goal[np.newaxis])
        motions = [frozenset(motion[:2]) for motion in asked(known)]
        assert len(set(motions)) == len(motions)
        of_edges = [motion for motion in motions if not motion & {tuple(start), tuple(goal)}]
        known._asked[0].motions.clear()
        known._asked[1].motions.clear()
        known.connect(start, goal[np.newaxis])
        assert not set(of_edges) & {frozenset(motion[:2]) for motion in asked(known)}


def test_fewer_motions_are_asked_about_in_a_kept_scene(roadmap):
    lazy, few = SceneRoadmap(roadmap, box_scene()), dear(roadmap)
    count = 0
    for start, goal in queries(few, 40):
        count += lazy.plan(start, goal, trees=False, shorten=False).counts["edges_checked"]
        few.plan(start, goal, trees=False, shorten=False)
    assert 0 < len(asked(few)) < 0.6 * count


def test_what_is_proved_for_little_is_not_asked_about_dearly(roadmap):
    known = dear(roadmap, TwoStage)
    for start, goal in queries(known, 20):
        known.plan(start, goal, trees=False)
    dearly = asked(known)
    assert dearly
    for world in known._asked:
        a, b = (np.array([motion[i] for motion in world.motions]).reshape(-1, 3) for i in (0, 1))
        assert not world.motion_proved(a, b).any()


def test_several_goals_and_a_budget_of_one_motion(roadmap):
    known = dear(roadmap)
    (start, goal), (other, _) = queries(known, 2)
    both = known.connect(start, np.array([goal, other]))
    assert both.goal in (0, 1)
    np.testing.assert_array_equal(both.path[-1], (goal, other)[both.goal])
    fresh = dear(roadmap)
    assert fresh.connect(start, goal[np.newaxis], most_motions=1).motions <= 1
    assert len(asked(fresh)) <= 1


def test_the_path_of_trees_says_that_capsules_prove_it(roadmap, monkeypatch):
    monkeypatch.setattr("evenroad.robot_roadmap.scene_roadmap.TRIED_MOTIONS", 1)
    planners = set()
    known = dear(roadmap)
    for start, goal in queries(known, 12):
        result = known.plan(start, goal, budget=er.Budget(seconds=5.0))
        planners.add(result.planner)
        if result.solved:
            assert known.world.recheck(result.path).all()
            assert result.proof == "certified"
    assert "robot roadmap, then trees" in planners


def test_ends_of_queries_are_learned_and_the_same_path_is_found_again(roadmap):
    first, second = dear(roadmap), dear(roadmap)
    some = queries(first, 8)
    for start, goal in some:
        one, other = (known.plan(start, goal, trees=False) for known in (first, second))
        assert one.solved == other.solved
        if one.solved:
            np.testing.assert_array_equal(one.path, other.path)
    before = len(asked(first))
    for start, goal in some:
        if first.plan(start, goal, trees=False).solved:
            # The straight motion is asked about anew, and a link to an end that is a milestone but for its last bits.
            assert len(asked(first)) <= before + 2
        before = len(asked(first))
