"""Ends that are cut off: the ways out that trees find for them, what they lead to, and what is learned."""

import numpy as np
import pytest

from evenroad.robot import Scene, with_limits
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap
from evenroad.robot_roadmap.search_memory import BLOCKED, FREE, NODES, PROVED
from evenroad.space.path import subdivide
from tests.robot.kernel_arms import box_scene, ur5
from tests.robot.oracle import clearance
from tests.robot_roadmap.test_search import TURN, hard


@pytest.fixture(scope="module")
def roadmap():
    """Three joints of two turns each, in nothing."""
    return make_roadmap(ur5(joints=3), None, 48, k=5, gamma=0.0, ends=100)


def known_well(roadmap, count=12):
    """A scene of which much is known, and queries in it that are not straight."""
    known = SceneRoadmap(roadmap, box_scene())
    some = [(start, goal[0]) for _, (start, goal) in zip(range(count), hard(known), strict=False)]
    for start, goal in some[:6]:
        known._graph.learn(known.connect(start, goal[np.newaxis], greed=1.0).path)
    return known, some


def groups(known):
    """Sets of milestones that edges known to be free join, worked out anew."""
    graph = known._graph
    n = int(graph.desk[NODES])
    label = np.arange(n)
    pairs = []
    for node in range(n):
        half = graph.first[node]
        while half >= 0:
            other, half, edge = graph.halves[half]
            if graph.edges[edge] in (FREE, PROVED):
                pairs.append((node, other))
    for _ in range(n):
        for a, b in pairs:
            label[a] = label[b] = min(label[a], label[b])
    return [np.flatnonzero((label == i) & (graph.nodes[:n] == FREE)) for i in np.unique(label)]


def test_ways_lead_to_the_largest_group_that_free_motions_join(roadmap):
    known, some = known_well(roadmap)
    known._ask(some[7][0], some[7][1][np.newaxis], 0, np.inf, 1)
    largest = max(groups(known), key=len)
    assert len(largest) >= 8
    weights = np.array([1.0, 2.0, 0.5])
    start, goal = some[7]
    found = known._graph.around(weights, 4.0, 5)
    for end, other, near in ((start, goal, found[0]), (goal, start, found[1])):
        q = known._graph.milestones[largest]

        def away(q, place):
            apart = q - place
            return np.linalg.norm(weights * (apart - TURN * np.rint(apart / TURN)), axis=1)

        expected = np.sort(away(q, end) + 4.0 * away(q, other))[:5]
        np.testing.assert_allclose(away(near, end) + 4.0 * away(near, other), expected, rtol=1e-5)
        assert np.all(near >= known.world.space.low)
        assert np.all(near <= known.world.space.high)


def test_a_scene_of_which_nothing_is_known_has_no_group(roadmap):
    known = SceneRoadmap(roadmap, box_scene())
    known._ask(roadmap.milestones[0], roadmap.milestones[1:2], 0, np.inf, 1)
    assert [len(near) for near in known._graph.around(np.ones(3), 4.0, 5)] == [0, 0]


def test_ends_that_are_cut_off_get_ways_out_that_are_learned(roadmap, monkeypatch):
    known, some = known_well(roadmap)
    # No link is tried: every end is cut off.
    monkeypatch.setattr("evenroad.robot_roadmap.scene_roadmap.TRIED_MOTIONS", 1)
    ways, learned, learn = 0, [], KnownGraph.learn
    monkeypatch.setattr(
        KnownGraph, "learn", lambda graph, path: (learned.append(path), learn(graph, path))[1]
    )
    for start, goal in some[6:]:
        result = known.plan(start, goal)
        assert result.solved
        assert known.world.recheck(result.path).all()
        dense, _ = subdivide(result.path, known.world.space, np.full(len(result.path) - 1, 200))
        assert clearance(known.world.robot, known.world.scene, dense).min() > 0.0
        np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
        if result.planner == "robot roadmap" and len(learned) > ways:
            # Both ends lead on from now on: once more there is nothing to be learned.
            before = len(learned)
            assert all(known.world.recheck(way).all() for way in learned[ways:])
            monkeypatch.setattr("evenroad.robot_roadmap.scene_roadmap.TRIED_MOTIONS", 90)
            again = known.plan(start, goal)
            monkeypatch.setattr("evenroad.robot_roadmap.scene_roadmap.TRIED_MOTIONS", 1)
            assert again.planner == "robot roadmap"
            assert len(learned) == before
        ways = len(learned)
    assert ways >= 4


def test_an_end_that_is_a_milestone_is_linked_to_nothing_else(roadmap):
    known, some = known_well(roadmap)
    path = known.plan(*some[0]).path
    known._graph.learn(path)
    asked = known._ask(path[0], path[-1:], 1000, np.inf, 30)
    assert asked.goal == 0
    # The straight motion, and what the search looks at on its way; no links.
    links = known._graph._links[:2, : len(roadmap.milestones)]
    assert not np.isin(links, (FREE, BLOCKED)).any()


def test_what_one_scene_learns_is_not_known_in_another(roadmap):
    first, second = SceneRoadmap(roadmap, box_scene()), SceneRoadmap(roadmap, box_scene())
    path = np.array([[0.0, -1.5, 0.0], [0.3, -1.5, 0.2]])
    assert first.world.recheck(path).all()
    before = second._graph.halves.copy()
    first._graph.learn(path)
    np.testing.assert_array_equal(second._graph.halves, before)
    np.testing.assert_array_equal(roadmap.graph.halves, before)
    assert first._graph.desk[NODES] == len(roadmap.milestones) + 2
    assert second._graph.desk[NODES] == len(roadmap.milestones)


def test_what_leads_to_the_goal_within_one_turn_is_not_lost_where_joints_turn_twice():
    robot = ur5(joints=3)
    one_turn = with_limits(robot, dict.fromkeys(robot.group, (-np.pi, np.pi)))
    narrow = make_roadmap(one_turn, None, 24, k=3, gamma=0.0, ends=0)
    wide = make_roadmap(
        with_limits(one_turn, {robot.group[0]: (-TURN, TURN)}), None, 24, k=3, gamma=0.0, ends=0
    )
    np.testing.assert_array_equal(narrow.milestones, wide.milestones)
    kept = {
        tuple(pair) for pair, turns in zip(wide.edges.tolist(), wide.turns, strict=True) if not turns.any()
    }
    assert kept >= set(map(tuple, narrow.edges.tolist()))
    # Ends are linked to milestones as these are, once those that were turned did not do.
    start, goal = np.array([5.0, -1.5, 0.0]), np.array([[-5.0, -1.5, 0.0]])
    known = SceneRoadmap(wide, Scene(name="nothing"))
    for unturned in (False, True):
        known._ask(start, goal, 0, np.inf, 24, unturned=unturned)
        assert known._graph.turns[:2].any() == (not unturned)
    known = SceneRoadmap(narrow, box_scene())
    q = known.world.space.from_cube(np.random.default_rng(1).random((400, 3)))
    q = q[known.world.valid(q)]
    solved = 0
    for start, goal in zip(q[::2], q[1::2], strict=False):
        if known.plan(start, goal, shorten=False, trees=False).solved:
            solved += 1
            result = SceneRoadmap(wide, box_scene()).plan(start, goal, shorten=False, trees=False)
            assert result.solved
            assert known.world.recheck(result.path).all()
    assert solved > 20


def test_motions_of_many_turns_are_not_learned():
    robot = with_limits(ur5(joints=3), {"shoulder_pan_joint": (-60.0, 60.0)})
    graph = SceneRoadmap(make_roadmap(robot, None, 24, k=4, gamma=0.0, ends=0), Scene(name="nothing"))._graph
    count = int(graph.desk[NODES])
    # Sixteen turns look like none, and seven turns out is not followed.
    for far in ([[-50.0, 0.1, 0.2], [50.0, 0.3, 0.4]], [[46.0, 0.1, 0.2], [47.0, 0.3, 0.4]]):
        graph.learn(np.array(far))
        assert graph.desk[NODES] == count
    graph.learn(np.array([[-9.0, 0.1, 0.2], [9.0, 0.3, 0.4]]))
    assert graph.desk[NODES] == count + 2
