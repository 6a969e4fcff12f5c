"""Success by connectivity, against slow and simple answers."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.roadmap.search import FREE, EdgeStates
from evenroad.space import BoxSpace
from evenroad_studies.bench.searches import SEARCHES, is_connected, milestones_until_connected, search_named
from evenroad_studies.rules import rule_named
from evenroad_studies.worlds import Corridor
from tests.counting import Counting


class _Graph:
    """A world whose motions are free where a table says so; node i is the configuration (i,)."""

    def __init__(self, nodes, free_pairs):
        self.space = BoxSpace([0.0], [float(max(nodes, 1))])
        self._free = {frozenset(pair) for pair in free_pairs}

    def valid(self, q):
        return np.ones(len(q), dtype=bool)

    def motion_valid(self, a, b):
        return np.array([frozenset((int(i), int(j))) in self._free for i, j in zip(a[:, 0], b[:, 0], strict=True)])


def _states_of(nodes, edges, free):
    pairs = np.array(edges, dtype=np.int32).reshape(-1, 2)
    free_pairs = [pair for pair, is_free in zip(edges, free, strict=True) if is_free]
    world = Counting(_Graph(nodes, free_pairs))
    states = EdgeStates(world, np.arange(nodes, dtype=float)[:, np.newaxis], pairs)
    states.node_states[:] = FREE
    return states


def _reaches(nodes, edges):
    """Say by flooding whether the last node is reached from the last but one."""
    reached = {nodes - 2}
    for _ in range(nodes):
        for i, j in edges:
            if i in reached or j in reached:
                reached |= {i, j}
    return nodes - 1 in reached


@st.composite
def _graphs(draw):
    nodes = draw(st.integers(2, 9))
    pairs = [(i, j) for i in range(nodes) for j in range(i + 1, nodes)]
    edges = draw(st.lists(st.sampled_from(pairs), unique=True))
    free = draw(st.lists(st.booleans(), min_size=len(edges), max_size=len(edges)))
    return nodes, sorted(edges), free


@settings(max_examples=300)
@given(_graphs())
def test_connected_is_what_flooding_the_free_edges_says(graph):
    nodes, edges, free = graph
    free_edges = [pair for pair, is_free in zip(edges, free, strict=True) if is_free]
    states = _states_of(nodes, edges, free)
    assert is_connected(states) == _reaches(nodes, free_edges)
    assert states.world.motions == states.motions_checked <= len(edges)


@settings(max_examples=300)
@given(_graphs())
def test_the_first_connected_prefix_is_what_trying_all_prefixes_says(graph):
    nodes, edges, free = graph
    free_edges = [pair for pair, is_free in zip(edges, free, strict=True) if is_free]
    ends = (nodes - 2, nodes - 1)
    expected = None
    for count in range(nodes - 1):
        here = [pair for pair in free_edges if all(node < count or node in ends for node in pair)]
        if _reaches(nodes, here):
            expected = count
            break
    assert milestones_until_connected(_states_of(nodes, edges, free)) == expected


def test_a_start_without_free_edges_ends_the_query_whatever_else_there_is():
    edges = [(i, j) for i in range(30) for j in range(i + 1, 31)] + [(0, 31)]
    free = [True] * (len(edges) - 1) + [False]
    states = _states_of(32, edges, free)
    assert not is_connected(states)
    assert states.motions_checked == 1


@pytest.mark.parametrize("n", [0, 1, 40, 400])
def test_stock_counts_the_milestones_of_a_planner_that_adds_them_one_by_one(n):
    world = Corridor(2, 0.2)
    for seed in range(5):
        q = np.random.default_rng(seed).random((n, 2))
        milestones = q[world.valid(q)]
        expected = _one_by_one(world, milestones)
        configurations = np.concatenate([milestones, [world.start], [world.goal]])
        edges = rule_named("k=10 earlier").edges(configurations, world.space, terminals=2)
        states = EdgeStates(world, configurations, edges)
        states.node_states[:] = FREE
        assert milestones_until_connected(states) == expected


def _one_by_one(world, milestones):
    """OMPL's PRM: each new milestone tries its ten nearest among start, goal and those before; None if never."""
    nodes = [world.start, world.goal]
    piece = [0, 1]
    if world.motion_valid(nodes[0][None], nodes[1][None])[0]:
        return 0
    for count, new in enumerate(milestones, 1):
        near = np.argsort(np.linalg.norm(np.array(nodes) - new, axis=1), kind="stable")[:10]
        nodes.append(new)
        piece.append(len(nodes))
        for other in near:
            if world.motion_valid(nodes[other][None], new[None])[0]:
                old = piece[-1]
                piece = [piece[other] if label == old else label for label in piece]
        if piece[0] == piece[1]:
            return count
    return None


def test_all_searches_agree_on_whether_there_is_a_path_and_the_shortest_ones_on_its_length():
    world = Corridor(3, 0.2)
    answers = set()
    for seed in range(12):
        q = np.random.default_rng(seed).random((80, 3))
        configurations = np.concatenate([q[world.valid(q)], [world.start], [world.goal]])
        edges = rule_named("k=6 symmetrised").edges(configurations, world.space, terminals=2)
        found = {}
        for name in SEARCHES:
            states = EdgeStates(world, configurations, edges)
            states.node_states[:] = FREE
            found[name] = search_named(name)(states)
        assert len({each.solved for each in found.values()}) == 1
        np.testing.assert_equal(found["full"].length, found["lazy"].length)
        assert np.isfinite(found["full"].length) == found["full"].solved
        assert (found["stock"].valid_at_solution is None) != found["stock"].solved
        answers.add(found["connect"].solved)
    assert answers == {True, False}
