import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, UnknownName
from evenroad.planning import Status, plan
from evenroad.points import PointSet, draw
from evenroad.roadmap import Budget, Complete, KNearest, Radius
from evenroad.roadmap.build import roadmap_of_points
from evenroad.roadmap.neighbours import Surroundings, nearest_of
from evenroad.space import Rectangle
from evenroad.world import GridMap
from tests.planning.spaces import Great, Torus
from tests.planning.worlds import ChanceWorld, costs_from
from tests.refused import refused

SQUARE = ChanceWorld.space
CORNERS = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)]


@st.composite
def reuses(draw_value):
    """A roadmap, a chance world, and some queries between corners of the square."""
    seed = draw_value(st.integers(0, 10**6))
    random = np.random.default_rng(seed)
    points = random.random((draw_value(st.integers(0, 40)), 2))
    if draw_value(st.booleans()):
        points = np.floor(points * 5) / 5
    rule = draw_value(st.sampled_from([KNearest(4), KNearest(8), Radius(0.3), Complete()]))
    world = ChanceWorld(seed, draw_value(st.sampled_from([1.0, 0.8])), draw_value(st.floats(0.3, 0.9)))
    queries = [tuple(CORNERS[i] for i in random.integers(4, size=2)) for _ in range(6)]
    return roadmap_of_points(SQUARE, PointSet(points), rule), world, queries


def _cheapest(roadmap, world, start, goal, links):
    """The definition: both ends joined as the rule's reach says, and the least cost by Bellman and Ford."""
    q = np.concatenate([roadmap.milestones, [start], [goal]])
    n = len(roadmap.milestones)
    valid = world.valid(q)
    reach = roadmap.rule.reach(n, roadmap.space)
    edges = [tuple(edge) for edge in roadmap.edges.tolist()] + [(n, n + 1)]
    for end in (n, n + 1):
        away = np.hypot(*(q[:n] - q[end]).T)
        near = [i for i in np.argsort(away, kind="stable") if valid[i]]
        close = [] if links is None else near  # all of so few milestones
        near = [i for i in near if reach.radius is None or away[i] <= reach.radius]
        edges += [(int(i), end) for i in [*near[: reach.k], *close]]
    first, second = np.array(edges).T
    free = world.motion_valid(q[first], q[second]) & valid[first] & valid[second]
    # Milestones on the way only: nothing goes on from the goal, or back to the start.
    return costs_from(n, n + 2, np.array(edges)[free], np.hypot(*(q[first] - q[second]).T)[free])[n + 1]


@settings(max_examples=60, deadline=None)
@given(reuses(), st.sampled_from([None, 100]))
def test_a_query_finds_the_shortest_path_of_the_roadmap_and_its_two_ends(reuse, links):
    roadmap, world, queries = reuse
    known = roadmap.within(world)
    for start, goal in queries:
        result = known.plan(start, goal, links=links, smooth=False)
        expected = _cheapest(roadmap, world, start, goal, links)
        assert result.solved == np.isfinite(expected)
        if result.solved:
            assert result.cost == pytest.approx(expected, abs=1e-12)
            np.testing.assert_array_equal(result.path[[0, -1]], [start, goal])
            assert world.motion_valid(result.path[:-1], result.path[1:]).all()


@settings(max_examples=60, deadline=None)
@given(reuses(), st.sampled_from(["full", "lazy"]))
def test_an_answer_does_not_depend_on_what_was_asked_before(reuse, search):
    roadmap, world, queries = reuse
    known = roadmap.within(world)
    for start, goal in queries:
        late = known.plan(start, goal, smooth=False)
        again = roadmap.within(world)
        fresh = again.plan(start, goal, search=search, smooth=False)
        assert late.status is fresh.status
        assert late.counts["edges_checked"] <= fresh.counts["edges_checked"]
        if late.solved:
            assert late.path.tobytes() == fresh.path.tobytes()
            assert late.cost == fresh.cost


def test_no_edge_of_the_roadmap_is_asked_about_twice():
    roadmap = roadmap_of_points(SQUARE, draw("sobol", 64, 2), KNearest(6))
    world = ChanceWorld(5, 0.9, 0.8)
    known = roadmap.within(world)
    assert world.asked_configurations == 64
    for _ in range(2):
        known.plan(CORNERS[0], CORNERS[3], search="full", smooth=False)
    asked = world.asked_motions
    again = known.plan(CORNERS[0], CORNERS[3], smooth=False)
    assert world.asked_motions - asked == again.counts["edges_checked"] <= 13
    assert again.counts["configurations_checked"] == 2
    states = known.evaluated
    assert states["milestones_free"] + states["milestones_blocked"] == 64
    assert states["edges_free"] + states["edges_blocked"] <= len(roadmap.edges)


def test_a_roadmap_is_made_once_for_several_worlds_and_cannot_be_changed():
    roadmap = roadmap_of_points(SQUARE, draw("sobol", 64, 2))
    assert str(roadmap.rule) == "k=20 symmetrised"
    for array in (roadmap.milestones, roadmap.edges):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    assert not roadmap.within(ChanceWorld(1, 1.0, 0.0)).plan(*CORNERS[::3]).solved
    assert roadmap.within(ChanceWorld(1, 1.0, 1.0)).plan(*CORNERS[::3]).solved


def test_statuses_counts_and_names_of_a_query():
    world = GridMap(np.eye(20, dtype=bool)).world(0.5)
    known = roadmap_of_points(world.space, draw("sobol", 64, 2), KNearest(8)).within(world)
    assert known.plan((0.2, 5), (5, 15)).status is Status.START_INVALID
    assert known.plan((5, 15), (0.2, 5)).status is Status.GOAL_INVALID
    apart = known.plan((5, 15), (15, 5))
    assert apart.status is Status.NOT_CONNECTED
    assert 0 < apart.counts["start_component"] < apart.counts["valid"]
    joined = known.plan((5, 15), (5, 18))
    assert joined.solved
    assert joined.rule == "k=8 symmetrised of all points"
    assert joined.planner == "prm lazy"
    assert joined.counts["points"] == 64
    refused(UnknownName, "full, lazy", known.plan, (5, 15), (5, 18), search="best")
    refused(InvalidValue, "start must be 2", known.plan, (5, 15, 1), (5, 18))


def test_ends_far_outside_of_the_milestones_are_measured_as_well():
    roadmap = roadmap_of_points(SQUARE, PointSet(np.array([[0.5, 0.5], [0.5, 0.5 + 1e-12]])), KNearest(1))
    known = roadmap.within(ChanceWorld(0, 1.0, 1.0))
    assert known.plan((-1e6, 0.0), (1e6, 0.0)).cost == pytest.approx(2e6)
    assert known.plan((0.0, 0.0), (1.0, 1.0)).cost == pytest.approx(np.sqrt(2))


def test_a_world_of_another_space_is_refused():
    roadmap = roadmap_of_points(SQUARE, draw("sobol", 16, 2), KNearest(4))
    wide = GridMap(np.zeros((4, 9), dtype=bool)).world(0.1)
    refused(InvalidValue, "was built for", roadmap.within, wide)
    same = ChanceWorld(0)
    same.space = Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    roadmap.within(same)


def test_an_edge_cost_is_kept_over_all_queries():
    def twice(a, b):
        return 2.0 * np.linalg.norm(a - b, axis=1)

    roadmap = roadmap_of_points(SQUARE, draw("sobol", 64, 2), KNearest(6))
    known = roadmap.within(ChanceWorld(5, 1.0, 0.8), edge_cost=twice)
    plain = roadmap.within(ChanceWorld(5, 1.0, 0.8))
    for goal in CORNERS[1:]:
        costs = [each.plan(CORNERS[0], goal).milestone_cost for each in (known, plain)]
        assert costs[0] == pytest.approx(2.0 * costs[1])


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    n=st.integers(0, 30),
    k=st.one_of(st.none(), st.integers(1, 40)),
    radius=st.one_of(st.none(), st.floats(0.1, 1.0)),
    space=st.sampled_from([SQUARE, Torus(2), Torus(2, [1.0, 2.0], [0.7, np.inf]), Great()]),
)
def test_newcomers_find_the_usable_milestones_that_are_nearest(seed, n, k, radius, space):
    random = np.random.default_rng(seed)
    q = np.floor(random.random((n, 2)) * 8) / 8
    usable = random.random(n) < 0.7
    newcomer = np.floor(random.random(2) * 8) / 8
    distances = Surroundings(q, space).distances(newcomer)
    np.testing.assert_allclose(distances, space.distance(np.tile(newcomer, (n, 1)), q), atol=1e-12)
    order = [i for i in np.argsort(distances, kind="stable") if usable[i]]
    order = [i for i in order if radius is None or distances[i] <= radius][:k]
    found = nearest_of(distances, usable, k, radius).tolist()
    assert found == (order if k is not None else sorted(order))


def test_the_graph_of_a_set_from_a_pool_is_joined_once_and_others_each_time():
    space = GridMap(np.zeros((20, 20), dtype=bool)).space
    banked, other = draw("hickernell", 64, 2), draw("uniform", 64, 2)
    assert roadmap_of_points(space, banked).edges is roadmap_of_points(space, banked).edges
    assert roadmap_of_points(space, other).edges is not roadmap_of_points(space, other).edges
    for different in (
        roadmap_of_points(space, banked, KNearest(5)),
        roadmap_of_points(space, draw("hickernell", 64, 2, rng=1)),
        roadmap_of_points(GridMap(np.zeros((20, 30), dtype=bool)).space, banked),
    ):
        assert different.edges is not roadmap_of_points(space, banked).edges


def test_a_roadmap_in_a_world_can_be_sent_to_another_process():
    roadmap = roadmap_of_points(SQUARE, draw("sobol", 32, 2), KNearest(6))
    known = roadmap.within(GridMap(np.zeros((1, 1), dtype=bool)).world(0.01))
    known.plan((0.1, 0.1), (0.9, 0.9))
    sent = pickle.loads(pickle.dumps(known))
    assert sent.plan((0.1, 0.1), (0.9, 0.9)).cost == known.plan((0.1, 0.1), (0.9, 0.9)).cost


def test_a_roadmap_measures_its_edges_once_and_only_when_asked():
    class Ruled(Great):
        measured = 0

        def distance(self, a, b):
            Ruled.measured += len(a)
            return super().distance(a, b)

    space = Ruled()
    roadmap = roadmap_of_points(space, draw("sobol", 256, 2), Radius(0.9))
    Ruled.measured = 0
    worlds = [ChanceWorld(seed, 1.0, 0.9) for seed in range(3)]
    for world in worlds:
        world.space = space
    known = [roadmap.within(world) for world in worlds]
    assert Ruled.measured == 0
    for one in known:
        one.plan(*CORNERS[::3], smooth=False)
    # The edges once, and what each query measures of all milestones.
    assert len(roadmap.edges) <= Ruled.measured < 2 * len(roadmap.edges) + 3 * 3 * 300
    assert np.array_equal(roadmap.lengths, space.distance(*roadmap.milestones[roadmap.edges.T]))


def test_a_budget_of_a_query_is_kept_to_and_what_was_asked_is_kept():
    world = ChanceWorld(5, 1.0, 0.0)
    known = roadmap_of_points(SQUARE, draw("sobol", 64, 2), KNearest(6)).within(world)
    result = known.plan(*CORNERS[::3], search="full", links=None, budget=Budget(motions=10))
    assert result.status is Status.BUDGET_SPENT
    assert world.asked_motions == result.counts["edges_checked"] == 10
    assert result.message.startswith("no path within 10 motions, 60 s; start reaches")
    known.plan(*CORNERS[::3], search="full", links=None)
    assert world.asked_motions <= 10 + len(known.roadmap.edges) + 13


def test_a_roadmap_its_file_and_its_planner_in_a_world_give_the_same_path(tmp_path):
    world = GridMap(np.eye(20, dtype=bool)).world(0.5)
    roadmap = roadmap_of_points(world.space, draw("sobol", 64, 2), KNearest(8))
    roadmap.save(tmp_path / "map.roadmap")
    within = roadmap.within(world)
    planners = (roadmap, tmp_path / "map.roadmap", str(tmp_path / "map.roadmap"), within)
    paths = [plan(world, (5, 15), (5, 18), each).path.tolist() for each in planners]
    assert paths == [paths[0]] * 4
    with pytest.raises(InvalidValue, match="a roadmap plans in its own world"):
        plan(GridMap(np.eye(20, dtype=bool)).world(0.6), (5, 15), (5, 18), within)
