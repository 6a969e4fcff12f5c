"""The compiled search against Dijkstra's over everything, edge by edge, in plain Python; and what a scene keeps."""

import heapq
import itertools
import pickle
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from evenroad._native.robot_roadmap import TURN_BITS, ProvedSearch
from evenroad.planning.arm_trees import checks_of
from evenroad.robot import ArmWorld, Scene, with_limits
from evenroad.robot.arm_world import VALIDATION_TOLERANCE
from evenroad.robot_roadmap.build import arm_roadmap
from evenroad.robot_roadmap.recipe import Recipe
from evenroad.robot_roadmap.turns import MOST_MULTI_TURN, MOST_TURNS, one_turn
from evenroad.space import JointSpace
from tests.robot.kernel_arms import box_scene, ur5
from tests.robot_roadmap.worlds import within

TURN = 2.0 * np.pi


def shortest(known, start, goals):
    """Return the length of the shortest free way from start to a goal over (milestone, turns), or inf."""
    roadmap, world = known.roadmap, known.world
    low, high = np.array(world.space.low), np.array(world.space.high)
    multi_turn = roadmap.one_turn.multi_turn
    q = roadmap.milestones

    def free(a, b):
        return bool(world.motion_certified(a[np.newaxis], b[np.newaxis], VALIDATION_TOLERANCE)[0])

    def length(a, b):
        return float(np.linalg.norm(b - a))

    def nearest_lift(i, place):
        best = [
            turns
            for turns in itertools.product(*[range(-2, 3) if lift else (0,) for lift in multi_turn])
            if np.all(q[i] + TURN * np.array(turns) >= low) and np.all(q[i] + TURN * np.array(turns) <= high)
        ]
        return min(best, key=lambda turns: length(q[i] + TURN * np.array(turns), place), default=None)

    neighbours = {i: [] for i in range(len(q))}
    for (a, b), turns in zip(roadmap.edges.tolist(), roadmap.turns.astype(int), strict=True):
        neighbours[a].append((b, turns))
        neighbours[b].append((a, -turns))
    at_goal = {}
    for g, goal in enumerate(goals):
        for i in range(len(q)):
            if (turns := nearest_lift(i, goal)) is not None:
                at_goal.setdefault((i, turns), []).append(g)
    best = min((length(start, goal) for goal in goals if free(start, goal)), default=np.inf)
    queue, done, verdicts = [], set(), {}
    for i in range(len(q)):
        turns = nearest_lift(i, start)
        if turns is not None and free(start, there := q[i] + TURN * np.array(turns)):
            heapq.heappush(queue, (length(start, there), i, turns))
    while queue:
        cost, i, turns = heapq.heappop(queue)
        if (i, turns) in done or cost >= best:
            continue
        done.add((i, turns))
        here = q[i] + TURN * np.array(turns)
        for g in at_goal.get((i, turns), []):
            if cost + length(here, goals[g]) < best and free(here, goals[g]):
                best = cost + length(here, goals[g])
        for j, by in neighbours[i]:
            there = q[j] + TURN * (np.array(turns) + by)
            if np.any(there < low) or np.any(there > high):
                continue
            edge = (i, j, *by) if i < j else (j, i, *(-by))
            if edge not in verdicts:
                verdicts[edge] = free(here, there)
            if verdicts[edge]:
                heapq.heappush(queue, (cost + length(here, there), j, tuple(np.array(turns) + by)))
    return best


@pytest.fixture(scope="module")
def roadmap():
    """Three joints of two turns each, by a table."""
    cell = box_scene()
    cell = replace(cell, obstacles=cell.obstacles[:1], allowed=frozenset(p for p in cell.allowed if p[1] == "table"))
    return arm_roadmap(ArmWorld(ur5(joints=3), cell), 48, 5, recipe=Recipe(2.0, 100))


def length_of(path):
    return float(np.sum(np.linalg.norm(np.diff(path, axis=0), axis=1)))


def test_the_path_is_as_long_as_that_of_a_slow_search_and_proved_again(roadmap):
    rng, found = np.random.default_rng(3), 0
    for goals in (1, 1, 3):
        known = within(roadmap, box_scene())
        q = known.world.space.from_cube(rng.random((4000, 3)))
        ends = q[known.world.valid(q)]
        for i in range(0, 8 * (1 + goals), 1 + goals):
            start, there = ends[i], ends[i + 1 : i + 1 + goals]
            connection = known.connect(start, there, greed=1.0, links=48)
            greedy = known.connect(start, there)
            expected = shortest(known, start, there)
            if connection.goal < 0:
                assert expected == np.inf
                assert greedy.goal < 0
                continue
            found += 1
            path = connection.path
            # Links are measured in single precision.
            assert length_of(path) == pytest.approx(expected, rel=1e-6)
            assert length_of(greedy.path) >= expected * (1.0 - 1e-6)
            assert known.world.validate(greedy.path).all()
            assert known.world.validate(path).all()
            np.testing.assert_array_equal(path[0], start)
            np.testing.assert_array_equal(path[-1], there[connection.goal])
    assert found > 10


def test_what_one_query_found_out_is_not_asked_again(roadmap):
    known = within(roadmap, box_scene())
    start, goal = far_apart(known)
    first, second = known.connect(start, goal), known.connect(start, goal)
    assert second.motions < first.motions
    np.testing.assert_array_equal(first.path, second.path)


def hard(known, least=0.0):
    """Yield starts and goals at least so far apart in the first joint that no straight motion joins, but a way does."""
    q = known.world.space.from_cube(np.random.default_rng(0).random((4000, 3)))
    # The shoulder cannot turn through the table.
    q = q[known.world.valid(q) & (q[:, 1] > -np.pi) & (q[:, 1] < 0.0)]
    q = q[np.argsort(q[:, 0])]
    for start, goal in zip(q[: len(q) // 2], q[::-1], strict=False):
        far = goal[0] - start[0] > least
        straight = known.world.motion_valid(start[np.newaxis], goal[np.newaxis])[0]
        fresh = within(known.roadmap, known.world.scene)
        if far and not straight and fresh.connect(start, goal[np.newaxis]).goal == 0:
            yield start, goal[np.newaxis]


def far_apart(known):
    return next(hard(known, 1.5 * TURN))


def test_a_goal_more_than_a_turn_away_is_reached_and_no_limit_left(roadmap):
    known = within(roadmap, box_scene())
    start, goal = far_apart(known)
    assert goal[0, 0] - start[0] > 1.5 * TURN
    path = known.connect(start, goal).path
    assert len(path) > 2
    assert np.all(path >= known.world.space.low)
    assert np.all(path <= known.world.space.high)
    assert known.world.validate(path).all()


def test_todays_narrower_limits_hold(roadmap):
    scene = replace(box_scene(), limits={"shoulder_pan_joint": (-1.0, 3.5)})
    known = within(roadmap, scene)
    for start, goal in itertools.islice(hard(known), 5):
        path = known.connect(start, goal).path
        assert len(path) > 2
        assert np.all(path[:, 0] >= -1.0)
        assert np.all(path[:, 0] <= 3.5)


def test_joints_of_very_many_turns_are_followed_over_some_of_them():
    space = JointSpace([-200.0, -1.0], [200.0, 1.0])
    one = one_turn(space, np.array([True, True]))
    assert one.multi_turn.tolist() == [True, False]
    assert one.limits[:, 0].tolist() == pytest.approx([-(MOST_TURNS + 0.5) * TURN, (MOST_TURNS + 0.5) * TURN])
    robot = with_limits(ur5(joints=2), {"shoulder_pan_joint": (-200.0, 200.0)})
    world = ArmWorld(robot, Scene())
    known = arm_roadmap(world, 32, recipe=Recipe(0.0, 100)).within(world)
    start = np.array([-60.0, -1.5])
    for turned in (-20.0, 39.0, 70.0):
        result = known.plan(start, [turned, -1.5], smooth=False)
        assert result.solved
        assert known.world.validate(result.path).all()
        assert np.abs(np.diff(result.path[:, 0])).sum() >= turned - start[0] - 1e-9


def test_of_very_many_joints_only_those_turn_on_that_the_search_can_follow():
    wide = JointSpace([-TURN] * 20, [TURN] * 20, [False] * 20, [1.0] * 20)
    one = one_turn(wide, np.ones(20, dtype=np.bool_))
    assert one.multi_turn.tolist() == [True] * MOST_MULTI_TURN + [False] * (20 - MOST_MULTI_TURN)
    # The others are planned in all of their range, and lead over no end of it.
    assert (one.high - one.low)[~one.multi_turn].tolist() == pytest.approx([2.0 * TURN] * (20 - MOST_MULTI_TURN))
    assert not one.wraps[~one.multi_turn].any()
    # Each has four bits of a whole number, of which none is the sign.
    assert 2 ** (TURN_BITS * MOST_MULTI_TURN) < 2**62


def test_a_search_in_slices_finds_what_it_finds_in_one_go(roadmap):
    start, goal = far_apart(within(roadmap, box_scene()))
    found = []
    for batches in (1, 10**9):
        known = within(roadmap, box_scene())
        checks = [checks_of(world) for world in known._worlds]
        search = ProvedSearch(known._graph, np.concatenate([start[np.newaxis], goal]), (48, 3.0), *checks)
        calls = 1
        while search.go_on(10**7, batches) == "paused":
            calls += 1
        assert (calls > 1) == (batches == 1)
        found.append((search.goal, search.counts, search.path.tolist()))
    assert found[0] == found[1]


def test_checks_run_out_and_come_back(roadmap):
    known = within(roadmap, box_scene())
    start, goal = far_apart(known)
    assert known.connect(start, goal, most_motions=1).motions == 1
    again = known.connect(start, goal)
    fresh = within(roadmap, box_scene()).connect(start, goal)
    np.testing.assert_array_equal(again.path, fresh.path)


def test_what_the_roadmap_does_not_lead_to_soon_is_left_to_the_trees_and_kept(roadmap, monkeypatch):
    monkeypatch.setattr("evenroad.robot_roadmap.world_roadmap.TRIED_MOTIONS", 1)
    known = within(roadmap, box_scene())
    ways = hard(known, 1.5 * TURN)
    start, goal = next(ends for ends in ways if within(roadmap, box_scene()).connect(*ends).motions > 10)
    first = known.plan(start, goal[0], smooth=False)
    assert first.planner == "roadmap, then trees"
    assert known.world.validate(first.path).all()
    monkeypatch.undo()
    # Both are milestones now, and the way between them is proved; in another scene they are not.
    second = known.plan(start, goal[0], smooth=False)
    assert second.planner == "roadmap"
    assert second.counts["edges_checked"] < 10
    assert known.world.validate(second.path).all()
    other = within(roadmap, box_scene()).plan(start, goal[0], smooth=False, trees=False)
    assert not other.solved or other.counts["edges_checked"] > second.counts["edges_checked"]


@pytest.mark.parametrize("copied", [deepcopy, lambda known: pickle.loads(pickle.dumps(known))])
def test_a_copy_of_a_kept_scene_answers_alike_from_memory_of_its_own(roadmap, copied):
    known = within(roadmap, box_scene())
    ends = list(itertools.islice(hard(known), 8))
    assert any(known.plan(start, goal[0]).solved for start, goal in ends[:4])
    copy = copied(known)
    # What the other learns is not seen.
    for start, goal in ends[2:]:
        np.testing.assert_array_equal(known.plan(start, goal[0]).path, copy.plan(start, goal[0]).path)


def test_there_is_room_for_more_milestones_than_the_roadmap_has(roadmap, monkeypatch):
    monkeypatch.setattr("evenroad.robot_roadmap.world_roadmap.TRIED_MOTIONS", 1)
    known = within(roadmap, box_scene())
    some = list(itertools.islice(hard(known), 6))
    found = [known.plan(start, goal[0], smooth=False) for start, goal in some]
    assert all(result.solved for result in found)
    for (start, goal), result in zip(some, found, strict=True):
        again = known.connect(start, goal, greed=1.0)
        assert again.goal == 0
        assert length_of(again.path) <= length_of(result.path) * (1.0 + 1e-6)
        assert known.world.validate(again.path).all()


def test_motions_of_many_turns_are_not_kept_but_planned():
    robot = with_limits(ur5(joints=3), {"shoulder_pan_joint": (-60.0, 60.0)})
    world = ArmWorld(robot, Scene())
    known = arm_roadmap(world, 24, 4, recipe=Recipe(0.0, 0)).within(world)
    # Sixteen turns look like none, and seven turns out is not followed.
    for start, goal in (([-50.0, 0.1, 0.2], [50.0, 0.3, 0.4]), ([46.0, 0.1, 0.2], [47.0, 0.3, 0.4])):
        for _ in range(2):
            result = known.plan(start, goal)
            assert result.solved
            assert known.world.validate(result.path).all()


def test_a_goal_that_is_not_free_is_left_out(roadmap):
    known = within(roadmap, box_scene())
    start, goal = far_apart(known)
    touching = np.array([0.0, 0.6, 0.0])
    assert not known.world.valid(touching[np.newaxis])[0]
    result = known.plan(start, np.stack([touching, goal[0]]))
    assert result.solved
    assert result.goal_index == 1
    assert known.plan(start, touching).status == "goal_invalid"
    assert known.plan(touching, goal[0]).status == "start_invalid"
