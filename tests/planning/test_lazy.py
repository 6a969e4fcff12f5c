import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue, UnknownName
from evenroad.points import PointSet, draw
from evenroad.roadmap import Complete, KNearest, Radius
from evenroad.roadmap.rules import ascending
from evenroad.world.gridmap.load import load_maze
from tests.plan_on import plan_on
from tests.planning.worlds import ChanceWorld, costs_from
from tests.refused import refused

START, GOAL = (0.0, 0.0), (1.0, 1.0)


def _steps(a, b):
    """A cost full of ties: every motion costs 2, whatever its length (at most sqrt 2)."""
    return np.full(len(a), 2.0)


def _detour(a, b):
    return np.linalg.norm(a - b, axis=1) * (1.0 + 3.0 * ((a + b)[:, 0] < 1.0))


@st.composite
def queries(draw_value):
    """Chance worlds with random points, coarse grids (all ties) or duplicates, and all kinds of rules."""
    seed = draw_value(st.integers(0, 10**6))
    random = np.random.default_rng(seed)
    n = draw_value(st.integers(0, 60))
    points = random.random((n, 2))
    if draw_value(st.booleans()):
        points = np.floor(points * 6) / 6
    rule = draw_value(st.sampled_from([KNearest(4), KNearest(9), Radius(0.25), Complete()]))
    world = ChanceWorld(seed, draw_value(st.sampled_from([1.0, 0.8])), draw_value(st.sampled_from([0.3, 0.6, 0.9])))
    cost = draw_value(st.sampled_from([None, _steps, _detour]))
    links = draw_value(st.sampled_from([None, 3, 100]))
    return world, PointSet(points), dict(rule=rule, edge_cost=cost, links=links, smooth=False)


@settings(max_examples=150, deadline=None)
@given(queries())
def test_lazy_finds_the_path_of_the_full_search_bit_for_bit(query):
    world, points, options = query
    full = plan_on(world, START, GOAL, points, **options)
    lazy = plan_on(world, START, GOAL, points, search="lazy", **options)
    assert lazy.status is full.status
    assert lazy.counts["edges_considered"] == full.counts["edges_considered"]
    assert lazy.counts["edges_checked"] <= full.counts["edges_checked"]
    assert lazy.counts["configurations_checked"] <= full.counts["configurations_checked"]
    if full.solved:
        assert lazy.path.tobytes() == full.path.tobytes()
        assert lazy.cost == full.cost
    else:
        # Both know the piece of the start: the lazy one has seen the same cut, if not all that lies beyond.
        assert lazy.counts["start_component"] >= full.counts["start_component"]


@settings(max_examples=100, deadline=None)
@given(queries())
def test_the_full_path_is_the_cheapest_one_and_follows_the_lowest_nodes_back(query):
    world, points, options = query
    options |= dict(links=None)
    result = plan_on(world, START, GOAL, points, **options)
    nodes = np.concatenate([points.points[world.valid(points.points)], [START], [GOAL]])
    edges = options["rule"].edges(nodes, world.space, terminals=2)
    a, b = nodes[edges[:, 0]], nodes[edges[:, 1]]
    free = world.motion_valid(a, b)
    lengths = (options["edge_cost"] or world.space.distance)(a, b)
    cost = costs_from(-2, len(nodes), edges[free], lengths[free])
    assert (result.counts["edges_checked"], result.counts["edges_free"]) == (len(edges), free.sum())
    assert result.solved == np.isfinite(cost[-1])
    if result.solved:
        assert result.cost == pytest.approx(cost[-1], rel=1e-9)
        if options["edge_cost"] is _steps:
            # Whole costs: the walk back is exact here.
            way = [len(nodes) - 1]
            joined = {tuple(edge) for edge in ascending(edges[free], len(nodes)).tolist()}
            while way[-1] != len(nodes) - 2:
                here = way[-1]
                way.append(
                    min(
                        i
                        for i in range(len(nodes))
                        if cost[i] == cost[here] - 2 and (min(i, here), max(i, here)) in joined
                    )
                )
            np.testing.assert_array_equal(result.path, nodes[way[::-1]])


@settings(max_examples=100, deadline=None)
@given(queries())
def test_success_only_agrees_on_success_and_returns_a_free_path(query):
    world, points, options = query
    full = plan_on(world, START, GOAL, points, **options)
    some = plan_on(world, START, GOAL, points, success_only=True, **options)
    assert some.status is full.status
    assert some.counts["edges_checked"] <= full.counts["edges_checked"]
    if some.solved:
        assert world.motion_valid(some.path[:-1], some.path[1:]).all()
        assert some.cost >= full.cost * (1 - 1e-12)
        np.testing.assert_array_equal(some.path[[0, -1]], [START, GOAL])


@settings(max_examples=50, deadline=None)
@given(queries(), st.sampled_from(["full", "lazy"]))
def test_the_counts_are_what_the_world_was_asked(query, search):
    world, points, options = query
    world.asked_configurations = world.asked_motions = 0
    result = plan_on(world, START, GOAL, points, search=search, **options)
    assert result.counts["configurations_checked"] == world.asked_configurations
    assert result.counts["edges_checked"] == world.asked_motions
    assert result.counts["points"] == points.n


def test_with_costs_below_the_lengths_by_as_much_as_rounding_may_the_path_still_is_the_cheapest():
    # All nodes on one line, so that the distance to the goal is no slack bound; 1e-9 below it, and it is too large.
    def below(a, b):
        place = (a + b)[:, 0] + 3.0 * np.abs(a - b)[:, 0]
        return np.linalg.norm(a - b, axis=1) * (1.0 - 0.99e-9 * np.abs(np.sin(1e3 * place)))

    line = PointSet(np.stack([np.arange(1, 16) / 16, np.zeros(15)], axis=1))
    for seed in range(30):
        options = dict(rule=Radius(0.3), edge_cost=below, smooth=False)
        full, lazy = (
            plan_on(ChanceWorld(seed, 1.0, 0.6), (0.0, 0.0), (1.0, 0.0), line, search=search, **options)
            for search in ("full", "lazy")
        )
        assert full.status is lazy.status
        if not full.solved:
            continue
        assert full.path.tobytes() == lazy.path.tobytes()
        nodes, edges = full.roadmap.configurations, full.roadmap.edges
        costs = below(nodes[edges[:, 0]], nodes[edges[:, 1]])
        cost = costs_from(-2, len(nodes), edges, costs)
        assert full.cost == pytest.approx(cost[-1], rel=1e-13)


def test_a_number_of_points_is_drawn_from_the_even_family():
    world = ChanceWorld(3, 1.0, 1.0)
    drawn = plan_on(world, START, GOAL, 128)
    assert drawn.counts["points"] == 128
    assert drawn.path.tobytes() == plan_on(world, START, GOAL, draw("even", 128, 2)).path.tobytes()
    for wrong in (0, -3, True, 2.5, "512", [[0.5, 0.5]]):
        refused(InvalidValue, "points", plan_on, world, START, GOAL, wrong)


@pytest.mark.parametrize("level", [1, 2, 3])
def test_on_the_mazes_lazy_checks_few_edges_and_finds_the_same_path(level):
    maze = load_maze(level)
    query = maze.world(), maze.start, maze.goal, draw("sobol", 1024, 2, rng=2)
    full, lazy = (plan_on(*query, search=search) for search in ("full", "lazy"))
    assert full.solved
    assert lazy.path.tobytes() == full.path.tobytes()
    assert lazy.counts["edges_checked"] < 0.2 * full.counts["edges_checked"]


def test_every_phase_is_timed_and_none_twice():
    result = plan_on(ChanceWorld(3), START, GOAL, draw("sobol", 64, 2), search="lazy")
    assert set(result.timings) == {"validity", "neighbours", "motions", "search", "shortcut"}
    assert min(result.timings.values()) > 0


def test_the_shortcut_keeps_to_the_edge_cost():
    result = plan_on(ChanceWorld(3, free_motions=1.0), START, GOAL, draw("sobol", 64, 2), edge_cost=_detour)
    assert result.cost <= result.milestone_cost
    assert result.cost == pytest.approx(_detour(result.path[:-1], result.path[1:]).sum())
    assert "path of cost" in result.message


@pytest.mark.parametrize(("option", "text"), [
    ({"edge_cost": lambda a, b: np.zeros(len(a))}, "at least the length"),
    ({"edge_cost": lambda a, b: np.full(len(a), np.nan)}, "finite"),
    ({"edge_cost": lambda a, b: 7.0}, "shape"),
    ({"search": "lazzy"}, "unknown search 'lazzy'; did you mean 'lazy'"),
])  # fmt: skip
def test_an_edge_cost_that_cannot_be_one_and_an_unknown_search_are_refused(option, text):
    refused((InvalidValue, UnknownName), text, plan_on, ChanceWorld(0), START, GOAL, draw("sobol", 8, 2), **option)
