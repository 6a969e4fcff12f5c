"""Ways in explored scenes: the table of distances against Dijkstra's in plain Python, links against every pair."""

import heapq
import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from evenroad.robot import ArmWorld, Scene, with_limits
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap import explored as exploring
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.scene_roadmap import EXPLORED_LINKS, GREED, SceneRoadmap
from evenroad.robot_roadmap.search_links import ONWARD
from evenroad.robot_roadmap.search_memory import BLOCKED, FOUND, FREE
from tests.robot.kernel_arms import box_scene, ur5
from tests.robot.oracle import clearance
from tests.robot_roadmap.test_explored import in_box

ENDS = 100


@pytest.fixture(scope="module")
def roadmap():
    return make_roadmap(ur5(limits=math.pi, joints=5), None, 96, ends=150)


def explored(roadmap, scene=None, ends=ENDS, rng=0):
    known = SceneRoadmap(roadmap, box_scene() if scene is None else scene)
    known.explore(ends, rng=rng)
    return known


@pytest.fixture(scope="module")
def once(roadmap):
    """A scene that was explored, for tests that only ask: plans would learn more than the table knows."""
    return explored(roadmap)


@pytest.fixture(scope="module")
def places(once):
    """Free configurations that no generator of the roadmap knows: every other one in the box."""
    q = once.world.space.from_cube(np.random.default_rng(9).random((120_000, 5)))
    q = q[once.world.valid(q)]
    inside = q[in_box(once.roadmap.robot, q)]
    assert len(inside) >= 30
    return np.stack([inside[:30], q[:30]], axis=1).reshape(-1, 5)


def table(known):
    """How far milestones are from each other, and the next one on the way, as exploring left them."""
    told = int(known._graph.desk[at.TOLD])
    assert known._graph._far.shape == known._graph._steps.shape == (told, told)
    return known._graph._far, known._graph._steps


def neighbours(known):
    """Where free motions lead from each milestone, and how far, from the ends of all motions."""
    graph, found = known._graph, {}
    a, b, turns = graph.motions()
    assert not turns.any()
    free = graph.edges[: len(a)] >= FREE
    for i, j in zip(a[free].tolist(), b[free].tolist(), strict=True):
        apart = float(np.linalg.norm(graph.milestones[i] - graph.milestones[j]))
        found.setdefault(i, []).append((j, apart))
        found.setdefault(j, []).append((i, apart))
    return found


def distances(known, mark, ways):
    best, queue = np.full(int(known._graph.desk[at.NODES]), np.inf), [(0.0, mark)]
    while queue:
        cost, here = heapq.heappop(queue)
        if cost < best[here]:
            best[here] = cost
            for there, apart in ways.get(here, ()):
                heapq.heappush(queue, (cost + apart, there))
    return best


def length_of(path):
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def asked(known, start, goals, links=EXPLORED_LINKS, most=10**6):
    """The way that an explored scene knows, or finds, without trees and without shortening."""
    return known._ask(start, goals, most, math.inf, links, GREED)


def tried(known, end):
    """The milestones that an end of the last query was tried to be linked to, nearest first, as memory has them."""
    near = known._graph.near[end, : int(known._graph.desk[at.LINKS])]
    return near[near >= 0]


def free(known, end, others):
    """Which motions from an end to others are proved free."""
    return known.world.motion_certified(
        np.broadcast_to(end, others.shape).copy(), np.ascontiguousarray(others), RECHECK_TOLERANCE
    )


def brute_force(known, start, goals, ways):
    """The length of the shortest way by two free links of those that were tried, over all pairs of them."""
    q, best = known._graph.milestones, np.inf
    sides = []
    for end, place in enumerate([start, *goals]):
        near = tried(known, end)
        near = near[free(known, place, q[near])]
        sides.append([(i, float(np.linalg.norm(q[i] - place))) for i in near.tolist()])
    for i, first in sides[0]:
        far = distances(known, i, ways)
        for j, last in itertools.chain(*sides[1:]):
            best = min(best, first + far[j] + last)
    return best


def apart(known, places):
    """Yield pairs of places that no straight motion joins."""
    starts, goals = places[0::2], places[1::2]
    straight = known.world.motion_certified(starts, goals, RECHECK_TOLERANCE)
    yield from zip(starts[~straight], goals[~straight], strict=True)


def assert_free(known, path):
    assert known.world.recheck(path).all()
    dense = np.concatenate(
        [a + np.linspace(0.0, 1.0, 80)[:, np.newaxis] * (b - a) for a, b in itertools.pairwise(path)]
    )
    assert clearance(known.world.robot, known.world.scene, dense).min() > 0.0


def test_the_table_is_what_a_slow_search_over_free_motions_finds(once):
    far, steps = table(once)
    ways = neighbours(once)
    n = int(once._graph.desk[at.NODES])
    assert len(far) == n > len(once.roadmap.milestones)
    apart = {(i, j): each for i, others in ways.items() for j, each in others}
    reached = 0
    for mark in range(0, n, 7):
        expected = distances(once, mark, ways)
        np.testing.assert_allclose(far[mark], expected, rtol=1e-5, atol=1e-6)
        for here in np.flatnonzero(np.isfinite(expected)):
            if here != mark:
                # One motion on, and so much nearer.
                there = int(steps[mark, here])
                assert expected[there] + apart[here, there] == pytest.approx(expected[here], rel=1e-5)
                reached += 1
    assert reached > n
    assert np.isinf(far).any(), "what is blocked is nowhere"


def test_the_way_along_the_table_is_the_shortest_over_all_pairs_of_free_links(once, places):
    ways, found = neighbours(once), 0
    for start, goal in apart(once, places):
        answer = asked(once, start, goal[np.newaxis])
        expected = brute_force(once, start, goal[np.newaxis], ways)
        if not np.isfinite(expected):
            continue
        found += 1
        assert answer.ended == FOUND
        assert once._graph.desk[at.PHASE] == at.LOOK_UP
        # The table and links are in single precision.
        assert length_of(answer.path) == pytest.approx(expected, rel=1e-5)
        np.testing.assert_array_equal(answer.path[[0, -1]], [start, goal])
        assert_free(once, answer.path)
        nodes = once._graph.milestones[: int(once._graph.desk[at.NODES])]
        assert all((nodes == waypoint).all(axis=1).any() for waypoint in answer.path[1:-1])
    assert found >= 15


def test_links_are_tried_to_the_milestones_that_are_nearest_and_on_the_way(once, places):
    compared = 0
    for start, goal in apart(once, places):
        if asked(once, start, goal[np.newaxis]).ended != FOUND:
            continue
        q = once._graph.milestones[: int(once._graph.desk[at.NODES])]
        for end, here, there in ((0, start, goal), (1, goal, start)):
            if not once._graph.desk[at.CLOSE_START if end == 0 else at.CLOSE_GOALS]:
                # Others were tried instead.
                continue
            key = np.linalg.norm(q - here, axis=1) + ONWARD * np.linalg.norm(q - there, axis=1)
            order = np.argsort(key, kind="stable")
            near, verdicts = tried(once, end), once._graph._links[end]
            refused = (once._graph.nodes[order] == BLOCKED) | (
                (verdicts[order] == BLOCKED) & ~np.isin(order, near)
            )
            np.testing.assert_array_equal(np.sort(near), np.sort(order[~refused][:EXPLORED_LINKS]))
            compared += 1
    assert compared >= 15


def test_links_come_in_order_however_many_there_are_and_however_many_goals(once, places):
    n = int(once._graph.desk[at.NODES])
    q, free_ones = once._graph.milestones[:n], np.flatnonzero(once._graph.nodes[:n] != BLOCKED)
    for links, count in itertools.product((1, 7, 20, 60, 10_000), (1, 3)):
        start, goals = places[0], places[count : 2 * count]
        once._ask(start, goals, 0, np.inf, links)
        away = np.linalg.norm(q - np.concatenate([start[np.newaxis], goals])[:, np.newaxis], axis=2)
        for end, beyond in enumerate([away[1:].min(axis=0), *[away[0]] * count]):
            key, near = away[end] + ONWARD * beyond, tried(once, end)
            assert len(near) == len(set(near.tolist())) == min(links, len(free_ones))
            assert np.isin(near, free_ones).all()
            # In memory they are in single precision.
            np.testing.assert_allclose(key[near], np.sort(key[free_ones])[: len(near)], rtol=0.0, atol=1e-5)


def test_plans_along_the_table_are_proved_with_trees_and_without(roadmap, places):
    known, found = explored(roadmap), 0
    for start, goal in list(apart(known, places))[:12]:
        plain = known.plan(start, goal, shorten=False, trees=False)
        short = known.plan(start, goal)
        assert short.solved
        assert_free(known, short.path)
        if plain.solved:
            found += 1
            assert plain.planner == "robot roadmap"
            assert_free(known, plain.path)
    assert found >= 6


def test_of_several_goals_the_one_on_the_shortest_way_is_reached(once, places):
    ways, named, found = neighbours(once), set(), 0
    for turn in range(0, 60, 4):
        start, goals = places[turn], places[turn + 1 : turn + 4]
        if free(once, start, goals).any():
            continue
        answer = asked(once, start, goals)
        expected = brute_force(once, start, goals, ways)
        if not np.isfinite(expected):
            continue
        found += 1
        named.add(answer.goal)
        assert length_of(answer.path) == pytest.approx(expected, rel=1e-5)
        np.testing.assert_array_equal(answer.path[-1], goals[answer.goal])
        assert_free(once, answer.path)
        alone = [asked(once, start, goal[np.newaxis]) for goal in goals]
        assert {each.goal for each in alone} <= {0, -1}
    assert found >= 5
    assert len(named) > 1


def test_a_goal_that_is_a_milestone_needs_no_link(once, places):
    graph, ways, found = once._graph, neighbours(once), 0
    hubs = np.flatnonzero(graph.nodes[: int(graph.desk[at.NODES])] >= FREE)
    for start, hub in zip(places[:30], hubs[:: len(hubs) // 30][:30], strict=True):
        goal = graph.milestones[hub][np.newaxis].copy()
        if free(once, start, goal)[0]:
            continue
        answer = asked(once, start, goal)
        assert tried(once, 1).tolist() == [hub]
        expected = brute_force(once, start, goal, ways)
        if np.isfinite(expected):
            found += 1
            assert length_of(answer.path) == pytest.approx(expected, rel=1e-5)
            np.testing.assert_array_equal(answer.path[-1], goal[0])
            assert_free(once, answer.path)
    assert found >= 8


def test_from_milestone_to_milestone_the_way_is_that_of_the_table(once):
    far, _ = table(once)
    q, found = once._graph.milestones, 0
    rows, columns = np.nonzero(np.isfinite(far) & (far > 0.0))
    some = np.random.default_rng(1).choice(len(rows), 40, replace=False)
    for i, j in zip(rows[some], columns[some], strict=True):
        if free(once, q[i], q[j : j + 1])[0]:
            continue
        answer = asked(once, q[i].copy(), q[j : j + 1].copy())
        # All of its motions are known: but for the straight one nothing is asked.
        assert answer.motions <= 1
        assert length_of(answer.path) == pytest.approx(float(far[i, j]), rel=1e-5)
        found += 1
    assert found >= 10


def test_start_and_goal_may_be_one_place(once, places):
    for place in (places[0], once._graph.milestones[np.flatnonzero(once._graph.nodes >= FREE)[0]]):
        result = once.plan(place, place)
        assert result.solved
        assert result.cost == 0.0
        np.testing.assert_array_equal(result.path[[0, -1]], [place, place])


def test_an_end_that_sees_none_of_its_nearest_milestones_finds_another_by_displacement(roadmap, once, places):
    without, blind, anew, found, looked_up = explored(roadmap), 0, 0, 0, 0
    without._graph.desk[at.CLOSE] = 0
    q = once._graph.milestones[: int(once._graph.desk[at.NODES])]
    for links, (start, goal) in itertools.product((1, 2, 3), apart(once, places)):
        for here, there, side in ((start, goal, 1), (goal, start, -2)):
            key = np.linalg.norm(q - here, axis=1) + ONWARD * np.linalg.norm(q - there, axis=1)
            key[once._graph.nodes[: len(q)] == BLOCKED] = np.inf
            first = np.argsort(key)[:links]
            if free(once, here, q[first]).any():
                continue
            blind += 1
            if asked(without, start, goal[np.newaxis], links).ended == FOUND:
                # A link was free at sixteen states and is not proved: then others are chosen.
                assert not np.isin(tried(without, int(side < 0)), first).all()
                anew += 1
                continue
            answer = asked(once, start, goal[np.newaxis], links)
            if answer.ended == FOUND:
                assert not (q[first] == answer.path[side]).all(axis=1).any()
                assert_free(once, answer.path)
                found += 1
                looked_up += once._graph.desk[at.PHASE] == at.LOOK_UP
    assert blind > found >= 5
    assert anew <= 2
    assert looked_up >= 5


def test_exploring_with_the_same_seed_tells_the_same_bits(roadmap, once, places):
    again, other = explored(roadmap), explored(roadmap, rng=1)
    for one, two in zip(table(once), table(again), strict=True):
        np.testing.assert_array_equal(one, two)
    assert table(other)[0].shape != table(once)[0].shape or not np.array_equal(
        table(other)[0], table(once)[0]
    )
    fresh = explored(roadmap)
    for start, goal in list(apart(once, places))[:8]:
        one, two = (asked(known, start, goal[np.newaxis]) for known in (fresh, again))
        np.testing.assert_array_equal(one.path, two.path)
        assert one.motions == two.motions


def test_a_scene_can_be_explored_twice_and_the_table_tells_of_all_that_is_known(roadmap, places):
    known = explored(roadmap)
    before = int(known._graph.desk[at.TOLD])
    known.explore(ENDS, rng=1)
    far, _ = table(known)
    assert len(far) == int(known._graph.desk[at.NODES]) > before
    ways = neighbours(known)
    for mark in range(0, len(far), 40):
        np.testing.assert_allclose(far[mark], distances(known, mark, ways), rtol=1e-5, atol=1e-6)
    for start, goal in list(apart(known, places))[:8]:
        result = known.plan(start, goal)
        assert result.solved
        assert_free(known, result.path)


def test_what_is_learned_after_exploring_is_no_part_of_the_table_and_does_no_harm(roadmap, places):
    known = explored(roadmap)
    ways, told, room = neighbours(known), int(known._graph.desk[at.TOLD]), int(known._graph.desk[at.CAPACITY])
    before = table(known)[0].copy()
    q = known.world.space.from_cube(np.random.default_rng(3).random((8000, 5)))
    # More than there was room for.
    for some in q[known.world.valid(q)][: room + 10 - told, np.newaxis]:
        known._graph.learn(some)
    assert known._graph.desk[at.NODES] == room + 10
    assert known._graph.desk[at.TOLD] == told
    np.testing.assert_array_equal(table(known)[0], before)
    looked_up = 0
    for start, goal in apart(known, places):
        answer = asked(known, start, goal[np.newaxis])
        expected = brute_force(known, start, goal[np.newaxis], ways)
        if answer.ended == FOUND:
            assert_free(known, answer.path)
        if np.isfinite(expected):
            looked_up += 1
            assert length_of(answer.path) == pytest.approx(expected, rel=1e-5)
    assert looked_up >= 5


def test_where_ways_bend_is_learned_but_not_close_to_what_is_known(roadmap, once, monkeypatch):
    monkeypatch.setattr(exploring, "THIN", math.inf)
    count, n = int(explored(roadmap)._graph.desk[at.NODES]), int(once._graph.desk[at.NODES])
    assert n >= count + 10
    q = once._graph.milestones[:n]
    hubs = roadmap.milestones[once.world.valid(roadmap.milestones)]
    spacing = np.median(cKDTree(hubs).query(hubs, k=2)[0][:, 1])
    monkeypatch.undo()
    for row in range(count, n):
        assert np.linalg.norm(q[:row] - q[row], axis=1).min() > exploring.THIN * spacing
    assert once.world.valid(q[count:]).all()


def test_of_too_many_milestones_nothing_is_told_and_plans_are_made(roadmap, places, monkeypatch):
    monkeypatch.setattr(exploring, "MOST_TOLD", 10)
    known = explored(roadmap)
    assert known._graph.desk[at.TOLD] == 0
    assert known._graph.desk[at.NODES] > 10
    for start, goal in list(apart(known, places))[:8]:
        result = known.plan(start, goal)
        assert result.solved
        assert_free(known, result.path)


def test_joints_of_two_turns_plan_without_the_table(roadmap):
    robot = with_limits(roadmap.robot, {roadmap.robot.group[0]: (-2.0 * math.pi, 2.0 * math.pi)})
    known = explored(make_roadmap(replace(robot, name="wide"), None, 64, ends=50), ends=40)
    assert known._graph.desk[at.LIFTING]
    assert known._graph.desk[at.TOLD] == 0
    q = known.world.space.from_cube(np.random.default_rng(4).random((200, 5)))
    q = q[known.world.valid(q)]
    q = q[np.argsort(q[:, 0])]
    for start, goal in zip(q[:8], q[::-1][:8], strict=True):
        assert goal[0] - start[0] > 2.0 * math.pi
        result = known.plan(start, goal)
        assert result.solved
        assert_free(known, result.path)


def test_joints_that_turn_on_for_ever_have_a_table_of_the_short_way_round():
    robot = ur5(limits=math.pi, joints=4)
    pan = replace(robot.joints[0], kind="continuous", lower=-math.inf, upper=math.inf)
    robot = replace(robot, joints=(pan, *robot.joints[1:]), name="endless")
    known = explored(make_roadmap(robot, None, 64, ends=50), ends=30)
    far, _ = table(known)
    space, graph = known.world.space, known._graph
    a, b, turns = graph.motions()
    edges = (graph.edges[: len(a)] >= FREE) & ~turns
    ways = {}
    for i, j in zip(a[edges].tolist(), b[edges].tolist(), strict=True):
        apart = float(space.distance(graph.milestones[i : i + 1], graph.milestones[j : j + 1])[0])
        ways.setdefault(i, []).append((j, apart))
        ways.setdefault(j, []).append((i, apart))
    for mark in range(0, len(far), 20):
        np.testing.assert_allclose(far[mark], distances(known, mark, ways), rtol=1e-5, atol=1e-6)
    q = space.from_cube(np.random.default_rng(4).random((400, 4)))
    # The shoulder cannot turn through the table.
    q = q[known.world.valid(q) & (q[:, 1] > -math.pi) & (q[:, 1] < 0.0)]
    found = 0
    for start, goal in zip(q[:12], q[12:24], strict=True):
        answer = asked(known, start, goal[np.newaxis])
        if answer.ended == FOUND:
            found += 1
            assert known.world.recheck(answer.path).all()
    assert found >= 8


@pytest.mark.parametrize("scene", [Scene("nothing"), box_scene()], ids=["nothing", "box"])
def test_a_roadmap_of_one_milestone_can_be_explored(roadmap, scene, places):
    known = explored(make_roadmap(roadmap.robot, None, 1, ends=20), scene, ends=20)
    assert len(known.roadmap.milestones) == 1
    for start, goal in places[:12].reshape(-1, 2, 5):
        result = known.plan(start, goal)
        assert result.solved
        assert_free(known, result.path)


def test_a_world_without_lanes_looks_the_same_way_up(roadmap, once, places):
    slow = explored(roadmap)
    slow._asked = tuple(ArmWorld(each.robot, each.scene, backend="scalar") for each in slow._asked)
    same = 0
    for start, goal in list(apart(once, places))[:4]:
        one, two = (asked(known, start, goal[np.newaxis]) for known in (once, slow))
        assert one.ended == two.ended
        if one.ended == FOUND:
            assert_free(slow, two.path)
            # Of links beside contact single precision may say something else.
            same += length_of(one.path) == pytest.approx(length_of(two.path), rel=1e-6)
    assert same >= 2
