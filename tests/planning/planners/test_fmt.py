import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.planning import Status
from evenroad.points import PointSet, draw
from evenroad.roadmap import Radius
from evenroad.roadmap.search import EdgeStates, SearchProblem, graph_of, march
from evenroad.world.gridmap.load import load_maze
from tests.plan_on import fmt_on, plan_on
from tests.planning.worlds import ChanceWorld

START, GOAL = (0.0, 0.0), (1.0, 1.0)


def _reading_of_the_paper(nodes, neighbours, length, is_free, start, goal):
    """Algorithm 2 of Janson et al. with sets, word by word; ties to the lower node."""
    unvisited, open_, closed = set(range(nodes)) - {start}, {start}, set()
    cost, z = {start: 0}, start
    while z != goal:
        open_new = set()
        for x in sorted(neighbours[z] & unvisited):
            _, y_min = min((cost[y] + length[x, y], y) for y in neighbours[x] & open_)
            if is_free[x, y_min]:
                open_new.add(x)
                unvisited.remove(x)
                cost[x] = cost[y_min] + length[x, y_min]
        open_ = (open_ | open_new) - {z}
        closed.add(z)
        if not open_:
            return None, cost
        z = min(open_, key=lambda y: (cost[y], y))
    return cost[goal], cost


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 25), share=st.floats(0.1, 0.9), steps=st.integers(1, 30))
def test_the_tree_is_that_of_the_papers_algorithm(seed, n, share, steps):
    random = np.random.default_rng(seed)
    first, second = np.triu_indices(n, k=1)
    kept = random.random(len(first)) < share
    edges = np.stack([first[kept], second[kept]], axis=1).astype(np.int32)
    weights = random.integers(1, steps + 1, len(edges))
    free = random.random(len(edges)) < 0.7
    neighbours = {v: set() for v in range(n)}
    length, is_free = {}, {}
    for (a, b), weight, verdict in zip(edges.tolist(), weights.tolist(), free.tolist(), strict=True):
        neighbours[a].add(b)
        neighbours[b].add(a)
        length[a, b] = length[b, a] = weight
        is_free[a, b] = is_free[b, a] = verdict
    states = EdgeStates(ChanceWorld(0), np.zeros((n, 2)), edges)
    states.edge_states[:] = np.where(free, 1, 2)
    nodes, along, reached = march(
        SearchProblem(n - 2, np.array([n - 1]), graph_of(n, edges), weights, np.zeros(n, dtype=np.int64)), states
    )
    expected, tree = _reading_of_the_paper(n, neighbours, length, is_free, n - 2, n - 1)
    assert reached == len(tree)
    if expected is None:
        assert nodes.size == 0
        return
    assert weights[along].sum() == expected
    assert nodes[0] == n - 2
    assert nodes[-1] == n - 1
    assert free[along].all()
    for a, b, edge in zip(nodes[:-1], nodes[1:], along, strict=True):
        assert {a, b} == set(edges[edge].tolist())


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), rule=st.sampled_from([Radius(0.2), Radius(0.3)]))
def test_with_nothing_in_the_way_and_a_radius_the_tree_finds_the_shortest_path(seed, rule):
    world, points = ChanceWorld(seed, 0.8, 1.0), draw("uniform", 60, 2, rng=seed)
    shortest, tree = (planner(world, START, GOAL, points, rule=rule, smooth=False) for planner in (plan_on, fmt_on))
    assert tree.status is shortest.status
    if tree.solved:
        assert tree.cost == pytest.approx(shortest.cost)


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), free=st.floats(0.2, 1.0))
def test_a_path_of_the_tree_is_free_and_not_shorter_than_the_shortest(seed, free):
    world, points = ChanceWorld(seed, 0.9, free), draw("uniform", 60, 2, rng=seed)
    shortest, tree = (planner(world, START, GOAL, points, smooth=False) for planner in (plan_on, fmt_on))
    assert tree.counts["edges_checked"] <= shortest.counts["edges_checked"]
    if tree.solved:
        assert shortest.solved
        assert tree.cost >= shortest.cost * (1 - 1e-12)
        assert world.motion_valid(tree.path[:-1], tree.path[1:]).all()
        np.testing.assert_array_equal(tree.path[[0, -1]], [START, GOAL])
    else:
        assert tree.status is Status.NOT_CONNECTED
        assert f"reached {tree.counts['start_component']} of {tree.counts['valid']}" in tree.message


@pytest.mark.parametrize("level", [1, 2, 3])
def test_on_the_mazes_it_checks_a_fraction_of_the_edges(level):
    maze = load_maze(level)
    query = maze.world(), maze.start, maze.goal, draw("sobol", 1024, 2, rng=2)
    tree, shortest = fmt_on(*query), plan_on(*query)
    assert tree.solved
    assert tree.planner == "fmt*"
    assert tree.counts["edges_checked"] < 0.5 * shortest.counts["edges_checked"]
    assert tree.milestone_cost < 1.1 * shortest.milestone_cost
    again = fmt_on(*query)
    assert again.path.tobytes() == tree.path.tobytes()


def test_a_start_a_goal_and_points_that_will_not_do_are_named():
    world = ChanceWorld(0, 0.0, 1.0)
    assert fmt_on(world, (0.3, 0.3), GOAL, draw("sobol", 8, 2)).status is Status.START_INVALID
    assert fmt_on(world, START, (0.3, 0.3), draw("sobol", 8, 2)).status is Status.GOAL_INVALID
    with pytest.raises(InvalidValue, match="d=3"):
        fmt_on(world, START, GOAL, draw("sobol", 8, 3))
    # No points and an equal start and goal are no special cases.
    empty = PointSet(np.empty((0, 2)))
    assert fmt_on(ChanceWorld(0, 1.0, 1.0), START, GOAL, empty).cost == pytest.approx(np.sqrt(2))
    assert fmt_on(ChanceWorld(0, 1.0, 1.0), START, START, empty).cost == 0.0
