import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, dijkstra

from evenroad.roadmap.search import FixedPoint, components, shortest_path


@st.composite
def roadmaps(draw_value):
    """A random geometric graph: positions, edges, lengths."""
    n = draw_value(st.integers(2, 40))
    random = np.random.default_rng(draw_value(st.integers(0, 10**6)))
    positions = random.random((n, 2))
    if draw_value(st.booleans()):
        positions = np.floor(positions * 5)
    first, second = np.triu_indices(n, k=1)
    kept = random.random(len(first)) < draw_value(st.floats(0, 0.3))
    edges = np.stack([first[kept], second[kept]], axis=1).astype(np.int32)
    lengths = np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1)
    return positions, edges, lengths


def _search(positions, edges, lengths, start, goal):
    bounds = np.linalg.norm(positions - positions[goal], axis=1)
    return shortest_path(len(positions), edges, lengths, bounds, start, goal)


@settings(max_examples=200, deadline=None)
@given(roadmaps())
def test_the_path_is_as_short_as_dijkstras(roadmap):
    positions, edges, lengths = roadmap
    n = len(positions)
    # SciPy's sparse graphs drop zero lengths, which are edges here.
    graph = coo_array((np.maximum(lengths, 1e-300), (edges[:, 0], edges[:, 1])), shape=(n, n)).tocsr()
    expected = dijkstra(graph, directed=False, indices=0)[n - 1]
    path, length = _search(positions, edges, lengths, 0, n - 1)
    if np.isinf(expected):
        assert path.size == 0
        assert np.isinf(length)
        return
    assert length == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert path[0] == 0
    assert path[-1] == n - 1
    known = {frozenset(edge) for edge in edges.tolist()}
    assert all(frozenset(step) in known for step in zip(path[:-1].tolist(), path[1:].tolist(), strict=True))
    assert len(set(path.tolist())) == len(path)
    steps = np.linalg.norm(np.diff(positions[path], axis=0), axis=1)
    assert length == pytest.approx(steps.sum(), abs=1e-12)


@settings(max_examples=100, deadline=None)
@given(roadmap=roadmaps(), seed=st.integers(0, 99))
def test_the_order_of_the_edges_does_not_change_the_length(roadmap, seed):
    positions, edges, lengths = roadmap
    order = np.random.default_rng(seed).permutation(len(edges))
    once = _search(positions, edges, lengths, 0, len(positions) - 1)[1]
    assert once == pytest.approx(_search(positions, edges[order], lengths[order], 0, len(positions) - 1)[1])


def test_start_and_goal_may_be_the_same_node():
    path, length = _search(np.zeros((2, 2)), np.empty((0, 2), dtype=np.int32), np.empty(0), 1, 1)
    assert path.tolist() == [1]
    assert length == 0.0


@settings(max_examples=100, deadline=None)
@given(roadmaps())
def test_components_are_labelled_by_their_lowest_node(roadmap):
    positions, edges, _ = roadmap
    n = len(positions)
    graph = coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(n, n))
    _, expected = connected_components(graph, directed=False)
    label = components(n, edges)
    for component in set(expected.tolist()):
        members = np.flatnonzero(expected == component)
        assert (label[members] == members.min()).all()


@settings(max_examples=200, deadline=None)
@given(
    lengths=st.lists(st.floats(0, 1e9), min_size=1, max_size=50),
    nodes=st.integers(1, 10**7),
    scale=st.sampled_from([1e-310, 1e-200, 1e-9, 1.0, 1e200]),
)
def test_whole_lengths_are_never_shorter_than_lengths_and_bounds_never_longer(lengths, nodes, scale):
    lengths = np.array(lengths) * scale
    fixed_point = FixedPoint.of(float(lengths.max()), nodes)
    weights, bounds = fixed_point.weights(lengths), fixed_point.bounds(lengths)
    assert (weights >= 1).all()
    assert (bounds < weights).all()
    if lengths.max() > 1e-280:
        np.testing.assert_allclose(weights * fixed_point.quantum, lengths, rtol=1e-12, atol=2 * fixed_point.quantum)
    # A path over all nodes, together with any bound, is still a 64-bit integer.
    assert int(weights.max()) * nodes + int(fixed_point.bounds(np.array([np.finfo(float).max]))[0]) < 2**63


def test_grid_paths_that_take_the_same_steps_in_another_order_are_ties():
    # 0.1 + 0.2 + 0.3 and 0.3 + 0.2 + 0.1 differ as floats; the tie goes to the lower node all the same.
    edges = np.array([[0, 1], [1, 2], [2, 5], [0, 3], [3, 4], [4, 5]], dtype=np.int32)
    forth = np.array([0.1, 0.2, 0.3, 0.3, 0.2, 0.1])
    for lengths in (forth, np.roll(forth, 3)):
        path, length = shortest_path(6, edges, lengths, np.zeros(6), 0, 5)
        assert path.tolist() == [0, 1, 2, 5]
        assert length == pytest.approx(0.6)
