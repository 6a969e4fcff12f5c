"""One search for several goals: the cheapest to reach wins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.planning import Status
from evenroad.points import draw
from evenroad.roadmap import Budget, KNearest
from evenroad.roadmap.build import roadmap_of_points
from evenroad.world import GridMap
from tests.plan_on import fmt_on, plan_growing, plan_on
from tests.planning.worlds import ChanceWorld

START = (0.0, 0.0)
GOALS = np.array([(1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), free=st.floats(0.2, 0.9))
def test_several_goals_are_reached_at_the_cost_of_the_cheapest_one(seed, free):
    world, points = ChanceWorld(seed, 0.8, free), draw("uniform", 40, 2, rng=seed)
    known = roadmap_of_points(world.space, points, KNearest(6)).within(world)
    # On a kept roadmap a goal's links do not depend on the other goals, so that each can be asked alone.
    alone = [known.plan(START, goal, smooth=False) for goal in GOALS]
    costs = [np.inf if result.cost is None else result.cost for result in alone]
    together = known.plan(START, GOALS, smooth=False)
    assert together.solved == np.isfinite(min(costs))
    np.testing.assert_array_equal(together.goals, GOALS)
    if together.solved:
        assert together.cost == pytest.approx(min(costs), abs=1e-12)
        assert costs[together.goal_index] == pytest.approx(min(costs), abs=1e-12)
        np.testing.assert_array_equal(together.path[-1], GOALS[together.goal_index])
        np.testing.assert_array_equal(together.goal, GOALS[together.goal_index])
        assert f"to goal {together.goal_index}" in together.message


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), free=st.floats(0.2, 0.9))
def test_all_planners_take_several_goals_and_lazy_is_full(seed, free):
    world, points = ChanceWorld(seed, 0.8, free), draw("sobol", 40, 2, rng=seed)
    full = plan_on(world, START, GOALS, points, smooth=False)
    lazy = plan_on(world, START, GOALS, points, search="lazy", smooth=False)
    assert (full.status, full.cost, full.goal_index) == (lazy.status, lazy.cost, lazy.goal_index)
    if full.solved:
        assert full.path.tobytes() == lazy.path.tobytes()
    grown = plan_growing(world, START, GOALS, budget=Budget(samples=128))
    tree = fmt_on(world, START, GOALS, points, smooth=False)
    for result in (full, grown, tree):
        if result.solved:
            assert world.motion_valid(result.path[:-1], result.path[1:]).all()
            np.testing.assert_array_equal(result.path[-1], GOALS[result.goal_index])
    if tree.solved:
        assert tree.cost >= full.cost * (1 - 1e-12)


WALL = np.zeros((20, 20), dtype=bool)
WALL[9] = True


@pytest.mark.parametrize("kept", [False, True])
def test_goals_in_collision_are_left_out_and_only_if_all_are_it_is_said(kept):
    world, points = GridMap(WALL).world(0.5), draw("halton", 64, 2)
    ask = roadmap_of_points(world.space, points).within(world).plan if kept else None

    def answer(goals):
        return ask((2, 2), goals) if kept else plan_on(world, (2, 2), goals, points)

    result = answer([(2, 9.5), (18, 2), (18, 18)])
    assert result.solved
    assert result.goal_index == 1
    blocked = answer([(2, 9.5), (18, 9.5)])
    assert blocked.status is Status.GOAL_INVALID
    assert blocked.goal_index is None
    assert blocked.message.startswith("all 2 goals are in collision; the first: its centre lies in an obstacle")
    apart = answer([(2, 9.5), (2, 18), (18, 18)])
    assert apart.status is Status.NOT_CONNECTED
    assert apart.counts["start_component"] + apart.counts["goal_component"] <= apart.counts["valid"]


@pytest.mark.parametrize("bad", [np.empty((0, 2)), np.zeros((2, 3)), np.zeros((1, 2, 2)), [(1, 2), (3,)], "ab"])
def test_goals_that_are_none_are_refused_by_name(bad):
    with pytest.raises(InvalidValue, match=r"goal must be 2 finite numbers, or an array \(g, 2\)"):
        plan_on(ChanceWorld(0), START, bad, draw("sobol", 8, 2))


@pytest.mark.parametrize("n", [200, 1000])
def test_start_and_goals_are_linked_to_the_nearest_hundred_or_to_all_of_a_few(n):
    world, points = ChanceWorld(1, 1.0, 1.0), draw("sobol", n, 2)
    free, plain = (plan_on(world, START, GOALS[:2], points, links=links, smooth=False) for links in (100, None))
    assert (free.links, plain.links) == (100, None)
    assert free.rule == plain.rule
    edges = free.roadmap.edges
    for node, place in zip(range(n, n + 3), [START, *GOALS[:2]], strict=True):
        linked = edges[(edges[:, 1] == node) & (edges[:, 0] < n), 0]
        away = np.hypot(*(points.points - np.array(place)).T)
        nearest = np.argsort(away, kind="stable")[: n if n <= 256 else 100]
        # The rule's own links come on top: those milestones of which an end is one of the k nearest.
        assert set(nearest) <= set(linked)
        assert len(linked) <= len(nearest) + 60
    same = {tuple(edge) for edge in plain.roadmap.edges.tolist()}
    assert same <= {tuple(edge) for edge in edges.tolist()}
    kept = roadmap_of_points(world.space, points, KNearest(4)).within(world).plan(START, GOALS[:2])
    assert kept.counts["edges_considered"] - len(roadmap_of_points(world.space, points, KNearest(4)).edges) == (
        3 * min(n, 100 if n > 256 else n) + 2
    )


def test_a_start_that_is_blocked_from_all_that_is_near_is_connected_by_its_links():
    class Ringed:
        """Nothing that is nearer than .3 to the start can be reached from there, and not the goal."""

        space = ChanceWorld.space

        def valid(self, q):
            return np.ones(len(q), dtype=bool)

        def motion_valid(self, a, b):
            from_start = (a == START).all(axis=1) | (b == START).all(axis=1)
            away = np.hypot(*(a - b).T)
            return ~from_start | ((away > 0.3) & (away < 1.0))

    query = Ringed(), START, (1.0, 1.0), draw("sobol", 1000, 2)
    assert plan_on(*query, links=None).status is Status.NOT_CONNECTED
    assert plan_on(*query).solved
    assert fmt_on(*query).solved
    assert roadmap_of_points(Ringed.space, query[3], KNearest(10)).within(query[0]).plan(*query[1:3]).solved


@pytest.mark.parametrize("links", [0, -1, 2.5, True])
def test_a_number_of_links_that_is_none_is_refused(links):
    with pytest.raises(InvalidValue, match="links"):
        plan_on(ChanceWorld(0), START, GOALS, draw("sobol", 8, 2), links=links)
