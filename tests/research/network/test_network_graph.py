import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.research.network.model import edges_of_sets, nearest_edges, radius_edges


def heard_by(edges, i):
    return [int(j) for j in edges.sender[edges.receiver == i]]


@settings(max_examples=30, deadline=None)
@given(st.integers(2, 30), st.integers(1, 6), st.integers(1, 12), st.integers(0, 1000))
def test_every_point_hears_of_its_k_nearest_others(n, d, k, seed):
    points = np.random.default_rng(seed).random((n, d))
    edges = nearest_edges(points, k)
    assert len(edges.sender) == n * min(k, n - 1)
    for i in range(n):
        distances = {j: np.linalg.norm(points[i] - points[j]) for j in range(n) if j != i}
        assert heard_by(edges, i) == sorted(distances, key=distances.get)[:k]


def test_points_on_one_spot_hear_of_each_other_and_never_of_themselves():
    edges = nearest_edges(np.zeros((6, 2)), 3)
    for i in range(6):
        heard = heard_by(edges, i)
        assert i not in heard
        assert len(set(heard)) == 3


@settings(max_examples=30, deadline=None)
@given(st.integers(2, 30), st.integers(1, 4), st.floats(0.01, 1.5), st.integers(0, 1000))
def test_within_a_radius_every_point_hears_of_all_and_of_itself(n, d, radius, seed):
    points = np.random.default_rng(seed).random((n, d))
    edges = radius_edges(points, radius)
    for i in range(n):
        assert heard_by(edges, i) == [j for j in range(n) if np.linalg.norm(points[i] - points[j]) <= radius]


def test_a_tiny_radius_leaves_only_the_loops():
    edges = radius_edges(np.random.default_rng(0).random((20, 10)), 1e-6)
    assert edges.sender.tolist() == edges.receiver.tolist() == list(range(20))


@pytest.mark.parametrize("radius", [None, 0.3])
def test_sets_do_not_hear_of_each_other(radius):
    sets = np.random.default_rng(1).random((3, 10, 2))
    edges = edges_of_sets(sets, 4, radius)
    assert (edges.sender // 10 == edges.receiver // 10).all()
    assert (np.diff(edges.receiver) >= 0).all()
    alone = edges_of_sets(sets[2:], 4, radius)
    in_third = edges.receiver >= 20
    assert (edges.sender[in_third] - 20).tolist() == alone.sender.tolist()
