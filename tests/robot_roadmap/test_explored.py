"""Scenes that are explored before queries come: what is learned there is free, the same again, and of use."""

import itertools
import math
import pickle
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.roadmap import Status
from evenroad.robot import Obstacle, Scene, link_poses, with_limits
from evenroad.robot_roadmap import explored as exploring
from evenroad.robot_roadmap import narrow_places, scene_roadmap
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.chance import Surroundings
from evenroad.robot_roadmap.known_graph import KnownGraph
from evenroad.robot_roadmap.make import make_roadmap
from evenroad.robot_roadmap.narrow_places import ends_between_obstacles
from evenroad.robot_roadmap.scene_roadmap import SceneRoadmap
from evenroad.robot_roadmap.search_memory import BLOCKED, FREE, PROVED, UNKNOWN
from evenroad.space.path import path_length, subdivide
from tests.robot.kernel_arms import TABLE, box_scene, ur5
from tests.robot.oracle import clearance, obstacle_distance

ENDS = 150


@pytest.fixture(scope="module")
def roadmap():
    robot = ur5(limits=math.pi, joints=5)
    return make_roadmap(robot, None, 128, ends=200)


@pytest.fixture(scope="module")
def ends(roadmap):
    """Free places of the tool in the box and before it, in turns, of no generator that explores."""
    world = SceneRoadmap(roadmap, box_scene()).world
    q = world.space.from_cube(np.random.default_rng(9).random((100_000, 5)))
    q = q[world.valid(q)]
    inside = q[in_box(roadmap.robot, q)]
    return np.stack([inside[:40], q[:40]], axis=1)


def in_box(robot, q):
    """Whether the last link is in the box of `box_scene`, which is open towards the robot."""
    x, y, z = link_poses(robot, q)[:, -1, :3, 3].T
    return (x > 0.5) & (x < 0.9) & (abs(y) < 0.18) & (z > 0.01) & (z < 0.37)


def explored(roadmap, scene=None, **how):
    known = SceneRoadmap(roadmap, box_scene() if scene is None else scene)
    known.explore(**{"ends": ENDS} | how)
    return known


def proved(known):
    """Two milestones and the length of each edge that is proved, as the graph links them."""
    graph, found = known._graph, []
    for node in range(int(graph.desk[at.NODES])):
        half = int(graph.first[node])
        while half >= 0:
            other, after, edge = graph.halves[half].tolist()
            if graph.edges[edge] == PROVED and graph.leads[half] == 0:
                found.append((node, other, float(graph.lengths[half])))
            half = after
    return found


def test_paths_in_an_explored_scene_are_free(roadmap, ends):
    known = explored(roadmap)
    for start, goal in ends:
        result = known.plan(start, goal)
        assert result.solved
        assert known.world.recheck(result.path).all()
        dense, _ = subdivide(result.path, known.world.space, np.full(len(result.path) - 1, 100))
        assert clearance(known.world.robot, known.world.scene, dense).min() > 0.0
        np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])


def test_motions_that_exploring_takes_for_free_are_free_and_what_it_blocks_is_not(roadmap):
    known = explored(roadmap)
    graph, world = known._graph, known.world
    n, count = int(graph.desk[at.NODES]), int(graph.desk[at.EDGES_MADE])
    assert not (graph.nodes[:n] == UNKNOWN).any()
    np.testing.assert_array_equal(world.valid(graph.milestones[:n]), graph.nodes[:n] >= FREE)
    some = np.random.default_rng(0).permutation(proved(known))[:400]
    a, b = graph.milestones[some[:, 0].astype(int)], graph.milestones[some[:, 1].astype(int)]
    dense = (a[:, None] + np.linspace(0.0, 1.0, 60)[:, None] * (b - a)[:, None]).reshape(-1, 5)
    assert clearance(world.robot, world.scene, dense).min() > 0.0
    np.testing.assert_allclose(some[:, 2], np.linalg.norm(b - a, axis=1), rtol=1e-5)
    # Nothing that could be asked about is left.
    one, other, turns = graph.motions()
    both = (graph.nodes[one] >= FREE) & (graph.nodes[other] >= FREE)
    blocked = both & (graph.edges[:count] == BLOCKED)
    assert not (graph.edges[:count][both] == UNKNOWN).any()
    assert blocked.any()
    assert not turns.any()
    assert not world.motion_certified(
        graph.milestones[one[blocked]], graph.milestones[other[blocked]], 1e-6
    ).any()


def test_what_few_motions_join_is_joined_to_all_that_it_reaches(roadmap, monkeypatch):
    # Of so few milestones three hundred are all.
    monkeypatch.setattr(exploring, "JOINED", 30)
    left = []
    for few in (exploring.FEW, 0):
        monkeypatch.setattr(exploring, "FEW", few)
        known = explored(roadmap)
        graph, (a, b, _) = known._graph, known._graph.motions()
        free = np.flatnonzero(graph.nodes[: int(graph.desk[at.NODES])] >= FREE)
        pairs = np.stack([a, b])[:, graph.edges[: len(a)] >= FREE]
        lonely = free[np.bincount(pairs.ravel(), minlength=len(graph.nodes))[free] < 10]
        assert len(lonely) >= 5
        left.append(0)
        for node in lonely:
            joined = pairs[:, (pairs == node).any(axis=0)]
            others = np.setdiff1d(free, [node, *joined.ravel()])
            here = np.broadcast_to(graph.milestones[node], (len(others), 5)).copy()
            left[-1] += known.world.motion_certified(here, graph.milestones[others], 1e-6).sum()
    assert left[0] == 0 < left[1]


def test_exploring_again_finds_the_same_and_another_seed_something_else(roadmap, ends):
    first, second, other = explored(roadmap), explored(roadmap), explored(roadmap, rng=1)
    n = int(first._graph.desk[at.NODES])
    np.testing.assert_array_equal(first._graph.milestones[:n], second._graph.milestones[:n])
    for start, goal in ends[:10]:
        np.testing.assert_array_equal(first.plan(start, goal).path, second.plan(start, goal).path)
    assert not np.array_equal(first._graph.milestones[:n], other._graph.milestones[:n])


def test_a_way_by_the_table_is_the_shortest_where_all_links_are_tried_and_longer_with_few(roadmap, ends):
    known = explored(roadmap)
    n, ratio = int(known._graph.desk[at.NODES]), []
    for start, goal in ends[:20]:
        shortest, looked_up, few = (
            known.connect(start, goal[None], links=links, greed=greed)
            for links, greed in ((n, 1.0), (n, 3.0), (5, 3.0))
        )
        length, other, longer = (
            np.linalg.norm(np.diff(way.path, axis=0), axis=1).sum() for way in (shortest, looked_up, few)
        )
        assert other == pytest.approx(length, rel=1e-5)
        if few.goal < 0:
            continue
        assert length <= longer + 1e-6
        ratio.append(longer / length)
    assert max(ratio) > 1.01


def test_fewer_queries_need_trees_once_a_scene_is_explored(roadmap, ends):
    def ways(known):
        before = len(known.learned)
        for start, goal in ends:
            assert known.plan(start, goal).solved
        return len(known.learned) - before

    assert 2 * ways(explored(roadmap)) < ways(SceneRoadmap(roadmap, box_scene()))


def test_ends_have_the_tip_where_obstacles_close_it_in(roadmap):
    world = SceneRoadmap(roadmap, box_scene()).world
    q = ends_between_obstacles(world, ENDS, np.random.default_rng(0))
    assert len(q) == ENDS
    assert world.valid(q).all()
    anywhere = world.space.from_cube(np.random.default_rng(1).random((20_000, 5)))
    usual = in_box(world.robot, anywhere[world.valid(anywhere)]).mean()
    assert in_box(world.robot, q).mean() > max(0.3, 10.0 * usual)


def closed_in(world, q, far):
    """In how many of fourteen directions a ball of a centimetre at the tool does not get so far: every 5 mm."""
    ways = [w for w in itertools.product((-1.0, 0.0, 1.0), repeat=3) if sum(map(abs, w)) in (1.0, 3.0)]
    steps = np.linspace(0.0, far, int(far / 0.005) + 1)[:, None]
    tool = link_poses(world.robot, q[np.newaxis])[0, -1, :3, 3]

    def meets(points):
        return min(obstacle_distance(points, each).min() for each in world.scene.obstacles) < 0.01

    return sum(meets(tool + steps * np.array(w) / np.linalg.norm(w)) for w in ways)


def test_ends_are_closed_in_on_more_than_half_of_fourteen_sides_and_none_of_them_is_preferred(roadmap):
    world = SceneRoadmap(roadmap, box_scene()).world
    q = ends_between_obstacles(world, 20, np.random.default_rng(0))
    rng = np.random.default_rng(0)
    blocks = [
        world.space.from_cube(rng.random((narrow_places.AT_ONCE, 5))) for _ in range(narrow_places.POOLS)
    ]
    blocks = [block[world.valid(block)] for block in blocks]
    far, drawn = narrow_places.FAR * Surroundings.of(world.robot, blocks[0]).reach, np.concatenate(blocks)
    sides = np.array([closed_in(world, row, far) for row in q])
    # Steps of the ball are not those of the oracle.
    assert (sides >= 8).mean() > 0.95
    assert sides.min() >= 7
    # As they were drawn: none is preferred for being closed in more.
    rows = [int(np.flatnonzero((drawn == row).all(axis=1))[0]) for row in q]
    assert rows == sorted(rows)
    passed = [closed_in(world, row, far) for row in drawn[np.setdiff1d(np.arange(rows[-1])[:400], rows)]]
    assert np.mean(np.array(passed) < 8) > 0.99


def test_where_no_end_is_closed_in_those_that_are_most_are_taken(roadmap):
    world = SceneRoadmap(roadmap, TABLE).world
    q = ends_between_obstacles(world, 40, np.random.default_rng(0))
    assert len(q) == 40
    anywhere = world.space.from_cube(np.random.default_rng(1).random((narrow_places.AT_ONCE, 5)))
    anywhere = anywhere[world.valid(anywhere)]
    reach, anywhere = Surroundings.of(world.robot, anywhere).reach, anywhere[:40]
    most, usual = (
        np.mean([closed_in(world, row, narrow_places.FAR * reach) for row in some]) for some in (q, anywhere)
    )
    assert most > 2.0 * usual


def test_where_too_few_ends_are_closed_in_others_follow_that_nearly_are(roadmap, monkeypatch):
    world = SceneRoadmap(roadmap, box_scene()).world
    monkeypatch.setattr(narrow_places, "POOLS", 2)
    q = ends_between_obstacles(world, 60, np.random.default_rng(0))
    first = world.space.from_cube(np.random.default_rng(0).random((narrow_places.AT_ONCE, 5)))
    far = narrow_places.FAR * Surroundings.of(world.robot, first[world.valid(first)]).reach
    sides = np.array([closed_in(world, row, far) for row in q])
    assert len(q) == 60
    # The ball's steps are not those of the oracle: one way more or less.
    assert sides[:25].min() >= 7
    assert sides[45:].max() <= 8
    assert sides[:25].mean() > sides[45:].mean() + 1.0


def test_of_two_ways_drawn_tight_the_bends_of_the_shorter_one_are_learned(roadmap, monkeypatch):
    ways, bends, tighten, learn = [], [], exploring.tighten, KnownGraph.learn

    def drawn(world, way, batches):
        ways.append(tighten(world, way, batches=batches)[0])
        return ways[-1], 0

    def learned(graph, path):
        bends.extend(path if len(path) == 1 else [])
        learn(graph, path)

    monkeypatch.setattr(exploring, "tighten", drawn)
    monkeypatch.setattr(KnownGraph, "learn", learned)
    space, pairs = explored(roadmap).world.space, 0
    for bend in bends:
        (way,) = [w for w in ways if (w[1:-1] == bend).all(axis=1).any()]
        others = [w for w in ways if w is not way and (w[[0, -1]] == way[[0, -1]]).all()]
        assert all(path_length(way, space) <= path_length(w, space) for w in others)
        pairs += len(others)
    assert pairs > 10


def test_in_an_explored_scene_paths_are_drawn_tight_with_more_checks(roadmap, ends, monkeypatch):
    spent, tighten = [], scene_roadmap.tighten

    def drawn(world, path, batches, **how):
        spent.append(batches)
        return tighten(world, path, batches=batches, **how)

    monkeypatch.setattr(scene_roadmap, "tighten", drawn)
    most = []
    for known in (SceneRoadmap(roadmap, box_scene()), explored(roadmap)):
        spent.clear()
        for pair in ends[:20]:
            known.plan(*pair)
        most.append(max(spent))
    assert most[0] <= scene_roadmap.WORK < most[1] <= scene_roadmap.EXPLORED_WORK


def test_where_milestones_are_joined_to_few_ways_of_trees_make_those_of_the_roadmap_shorter(
    roadmap, ends, monkeypatch
):
    monkeypatch.setattr(exploring, "JOINED", 30)

    def lengths(known):
        return np.array(
            [known.plan(*pair, trees=False, shorten=False).cost for pair in ends[:20]], dtype=float
        )

    after = lengths(explored(roadmap))
    monkeypatch.setattr(exploring, "BESIDE", 1)
    before = lengths(explored(roadmap))
    assert np.nanmean(after / before) < 0.995


def test_no_more_bends_are_learned_than_the_table_tells_of(roadmap, monkeypatch):
    full = int(explored(roadmap)._graph.desk[at.NODES])
    monkeypatch.setattr(exploring, "MOST_TOLD", full - 5)
    desk = explored(roadmap)._graph.desk
    assert desk[at.NODES] == desk[at.TOLD] == full - 5


def test_exploring_again_keeps_the_table_where_there_is_room_for_few_more(roadmap, monkeypatch):
    known = explored(roadmap)
    nodes = int(known._graph.desk[at.NODES])
    monkeypatch.setattr(exploring, "MOST_TOLD", nodes + 3)
    for rng in (1, 2):
        known.explore(ENDS, rng=rng)
        assert nodes <= known._graph.desk[at.TOLD] == known._graph.desk[at.NODES] <= nodes + 3


def test_a_scene_with_nothing_in_it_can_be_explored(roadmap, ends):
    known = explored(roadmap, Scene("nothing"))
    assert known.plan(*ends[0]).solved


def test_where_the_robot_is_never_free_there_is_nothing_to_explore(roadmap):
    scene = Scene("taken", (Obstacle.of("wall", "box", (4.0, 4.0, 4.0), (0.0, 0.0, 2.0)),))
    known = explored(roadmap, scene)
    assert known.learned == []
    q = roadmap.milestones
    assert known.plan(q[0], q[1]).status is Status.START_INVALID


def test_joints_of_several_turns_can_be_explored(roadmap):
    robot = with_limits(roadmap.robot, {roadmap.robot.group[0]: (-2.0 * math.pi, 2.0 * math.pi)})
    wide = make_roadmap(replace(robot, name="wide"), None, 96, ends=50)
    known = explored(wide)
    q = known.world.space.from_cube(np.random.default_rng(4).random((60, 5)))
    q = q[known.world.valid(q)]
    for start, goal in zip(q[::2], q[1::2], strict=False):
        result = known.plan(start, goal)
        assert result.solved
        assert known.world.recheck(result.path).all()


@pytest.mark.parametrize("copied", [deepcopy, lambda known: pickle.loads(pickle.dumps(known))])
def test_a_copy_of_an_explored_scene_answers_alike_from_memory_of_its_own(roadmap, ends, copied):
    known = explored(roadmap)
    before = [known.plan(*pair).path for pair in ends[:5]]
    copy = copied(known)
    for place in (at.KNOWN, at.GRAPH, at.RULES, at.VERDICTS, at.FAR, at.STEPS):
        assert copy._graph.desk[place] != known._graph.desk[place]
    again = [[one.plan(*pair).path for pair in ends[:10]] for one in (known, copy)]
    # What the other learns is not seen.
    assert all(path is not None for path in before)
    for own, others in zip(*again, strict=True):
        np.testing.assert_array_equal(own, others)


def test_motions_that_join_milestones_take_no_room_of_milestones(roadmap):
    graph = SceneRoadmap(roadmap, box_scene())._graph
    made, room = int(graph.desk[at.EDGES_MADE]), len(graph.nodes)
    pairs = np.tile([[0, 1]], (20_000, 1))
    graph.join(pairs, np.ones(len(pairs)))
    assert len(graph.nodes) < 2 * room
    assert (graph.edges[made : made + len(pairs)] == PROVED).all()
    assert graph.desk[at.EDGES_MADE] == made + len(pairs)


def test_motions_that_join_a_milestone_lie_side_by_side_and_lead_to_all_its_neighbours(roadmap):
    graph = SceneRoadmap(roadmap, box_scene())._graph
    before = {*map(tuple, np.sort(graph.motions()[:2], axis=0).T.tolist())}
    made = int(graph.desk[at.HALVES_MADE])
    rng = np.random.default_rng(3)
    pairs = np.stack([rng.permutation(40)[:2] for _ in range(30)])
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    lengths = 1.0 + np.arange(len(pairs))
    graph.join(pairs, lengths)
    a, b, turns = graph.motions()
    assert {*map(tuple, np.sort([a, b], axis=0).T.tolist())} == before | {*map(tuple, pairs.tolist())}
    assert not turns[-len(pairs) :].any()
    number = graph.edges.nonzero()[0][-len(pairs) :]
    for node in np.unique(pairs):
        half, own = int(graph.first[node]), []
        while half >= made:
            own.append(half)
            pair = int(graph.halves[half, at.NUMBER]) - number[0]
            assert {node, int(graph.halves[half, at.OTHER])} == {*pairs[pair].tolist()}
            assert graph.lengths[half] == lengths[pair]
            half = int(graph.halves[half, at.NEXT])
        assert len(own) == np.count_nonzero(pairs == node)
        assert max(own) - min(own) == len(own) - 1


def test_of_very_many_milestones_none_is_tried_to_be_joined_to_all(roadmap, monkeypatch):
    monkeypatch.setattr(exploring, "MOST_TOLD", 50)
    tried = []
    monkeypatch.setattr(exploring, "_join", lambda graph, world, a, b: tried.append(len(a)))
    known = explored(roadmap)
    learned = int(known._graph.desk[at.NODES]) - len(roadmap.milestones)
    assert 0 < sum(tried) <= learned * exploring.IN_A_SEARCH


def test_of_many_narrow_places_those_that_are_joined_to_fewest_are_joined_to_all(roadmap, monkeypatch):
    known = explored(roadmap)
    graph, (a, b, _) = known._graph, known._graph.motions()
    nodes = int(graph.desk[at.NODES])
    free = np.flatnonzero(graph.nodes[:nodes] >= FREE)
    pairs = np.stack([a, b])[:, graph.edges[: len(a)] >= FREE]
    degree = np.bincount(pairs.ravel(), minlength=nodes)
    tried = []
    monkeypatch.setattr(exploring, "_join", lambda graph, world, a, b: tried.append((a, b)))
    monkeypatch.setattr(exploring, "FEW", nodes)
    monkeypatch.setattr(exploring, "MOST_PAIRS", 7 * len(free) + 1)
    exploring._settle_and_join(graph, known.world, known._day, nodes)
    ((chosen, others),) = tried
    assert (len(chosen), len(set(chosen))) == (7 * len(free), 7)
    np.testing.assert_array_equal(np.unique(others), free)
    rest = np.setdiff1d(free, chosen)
    assert degree[np.unique(chosen)].max() <= degree[rest].min()


@pytest.mark.parametrize("bad", [{"ends": 0}, {"ends": 2.5}, {"rng": "x"}, {"rng": -1}])
def test_what_is_no_number_of_ends_or_seed_is_refused(roadmap, bad):
    with pytest.raises(InvalidValue, match="must be an? int"):
        explored(roadmap, **bad)
