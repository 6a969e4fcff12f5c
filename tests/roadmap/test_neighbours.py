import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.roadmap import KNearest, Radius
from evenroad.roadmap.kdtree import k_nearest, pairs_within


def nearest_by_sorting(points, k):
    """The definition: all others, by distance, then by index."""
    rows = []
    for i, point in enumerate(points):
        squared = ((points - point) ** 2).sum(axis=1)
        others = [j for j in np.lexsort((np.arange(len(points)), squared)) if j != i]
        rows.append(others[:k])
    return np.array(rows, dtype=np.int32).reshape(len(points), min(k, max(len(points) - 1, 0)))


@st.composite
def clouds(draw_value):
    """Random points, or points of a coarse grid, which are full of ties and duplicates."""
    n, d = draw_value(st.integers(0, 60)), draw_value(st.integers(1, 5))
    random = np.random.default_rng(draw_value(st.integers(0, 10**6)))
    points = random.random((n, d))
    return np.floor(points * 4) if draw_value(st.booleans()) else points


@settings(max_examples=200, deadline=None)
@given(points=clouds(), k=st.integers(1, 12))
def test_k_nearest_equals_sorting_with_ties_to_the_lower_index(points, k):
    np.testing.assert_array_equal(k_nearest(points, k), nearest_by_sorting(points, k))


@pytest.mark.parametrize("n", [1000, 5000])
def test_k_nearest_equals_sorting_on_a_large_set_too(n):
    points = draw("uniform", n, 3, rng=1).points
    some = np.random.default_rng(0).integers(n, size=50)
    found = k_nearest(points, 7)
    for i in some:
        squared = ((points - points[i]) ** 2).sum(axis=1)
        squared[i] = np.inf
        np.testing.assert_array_equal(found[i], np.argsort(squared, kind="stable")[:7])


@settings(max_examples=100, deadline=None)
@given(points=clouds(), radius=st.floats(0.01, 3))
def test_pairs_within_a_radius_are_those_that_a_double_loop_finds(points, radius):
    expected = {
        (i, j)
        for i in range(len(points))
        for j in range(i + 1, len(points))
        if ((points[i] - points[j]) ** 2).sum() <= radius * radius
    }
    found = [tuple(pair) for pair in pairs_within(points, radius).tolist()]
    assert len(found) == len(set(found))
    # Sums of squares may round differently in another order: only pairs at the very radius may differ.
    for i, j in set(found) ^ expected:
        assert np.linalg.norm(points[i] - points[j]) == pytest.approx(radius, rel=1e-12)


@settings(max_examples=100, deadline=None)
@given(points=clouds(), k=st.integers(1, 6))
def test_symmetrised_edges_join_i_and_j_when_either_is_near_the_other(points, k):
    near = nearest_by_sorting(points, k)
    expected = sorted({(min(i, j), max(i, j)) for i, row in enumerate(near.tolist()) for j in row})
    assert [tuple(edge) for edge in KNearest(k).edges(points).tolist()] == expected


@pytest.mark.parametrize("rule", [KNearest(3), Radius(0.3)])
def test_edges_are_sorted_unique_and_smaller_index_first(rule):
    edges = rule.edges(draw("sukharev", 64, 2).points)
    assert (edges[:, 0] < edges[:, 1]).all()
    assert edges.tolist() == np.unique(edges, axis=0).tolist()


@pytest.mark.parametrize("count", [0, 1, 2])
@pytest.mark.parametrize("rule", [KNearest(3), Radius(2.0)])
def test_tiny_sets_have_the_edges_that_they_can_have(rule, count):
    edges = rule.edges(np.linspace(0, 1, 2 * count).reshape(count, 2))
    assert edges.shape == (1 if count == 2 else 0, 2)
    assert edges.dtype == np.int32


@pytest.mark.parametrize("k", [0, -3, 2.5, True])
def test_a_k_below_one_is_refused(k):
    with pytest.raises(InvalidValue, match="k must be"):
        KNearest(k)


@pytest.mark.parametrize("r", [0, -1, np.nan, np.inf, "1"])
def test_a_radius_that_is_not_positive_and_finite_is_refused(r):
    with pytest.raises(InvalidValue, match="radius"):
        Radius(r)


def test_rules_say_their_name():
    assert str(KNearest(10)) == "k=10 symmetrised"
    assert str(Radius(0.5)) == "radius=0.5"
