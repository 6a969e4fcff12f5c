import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.points import draw
from evenroad.roadmap.neighbours import nearest, within
from tests.planning.clouds import clouds, nearest_by_sorting
from tests.planning.spaces import Great, Torus


@settings(max_examples=200, deadline=None)
@given(points=clouds(), k=st.integers(1, 12))
def test_k_nearest_equals_sorting_with_ties_to_the_lower_index(points, k):
    np.testing.assert_array_equal(nearest(points, k), nearest_by_sorting(points, k))


@pytest.mark.parametrize("n", [1000, 5000])
def test_k_nearest_equals_sorting_on_a_large_set_too(n):
    points = draw("uniform", n, 3, rng=1).points
    some = np.random.default_rng(0).integers(n, size=50)
    found = nearest(points, 7)
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
    found = [tuple(pair) for pair in within(points, radius).tolist()]
    assert len(found) == len(set(found))
    # Sums of squares may round differently in another order: only pairs at the very radius may differ.
    for i, j in set(found) ^ expected:
        assert np.linalg.norm(points[i] - points[j]) == pytest.approx(radius, rel=1e-12)


@settings(max_examples=100, deadline=None)
@given(points=clouds(), k=st.integers(1, 12))
def test_earlier_neighbours_are_the_nearest_of_those_before(points, k):
    found = nearest(points, k, earlier=True)
    for i in range(len(points)):
        squared = ((points[:i] - points[i]) ** 2).sum(axis=1)
        expected = np.argsort(squared, kind="stable")[:k].tolist()
        assert found[i].tolist() == expected + [-1] * (found.shape[1] - len(expected))


def _all_distances(space, q):
    return np.stack([space.distance(np.broadcast_to(row, q.shape), q) for row in q])


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 60), d=st.integers(1, 4), earlier=st.booleans())
def test_wrapping_and_scaled_axes_are_searched_as_their_metric_says(seed, n, d, earlier):
    random = np.random.default_rng(seed)
    period = np.where(random.random(d) < 0.6, random.uniform(0.5, 7.0, d), np.inf)
    space = Torus(d, random.uniform(0.2, 3.0, d), period)
    q = random.uniform(-9.0, 9.0, (n, d))
    distance = _all_distances(space, q)
    np.fill_diagonal(distance, np.inf)
    if earlier:
        distance[np.triu_indices(n)] = np.inf
    found = nearest(q, 5, space, earlier=earlier)
    for i in range(n):
        expected = np.sort(distance[i])[: found.shape[1]]
        row = found[i][found[i] >= 0]
        np.testing.assert_allclose(distance[i, row], expected[np.isfinite(expected)], rtol=1e-12)
        assert len(set(row.tolist())) == len(row)
    if not earlier:
        radius = float(np.median(distance))
        if np.isfinite(radius):
            pairs = {tuple(pair) for pair in within(q, radius, space).tolist()}
            sure = {(i, j) for i, j in np.argwhere(distance < radius * (1 - 1e-12)).tolist() if i < j}
            maybe = {(i, j) for i, j in np.argwhere(distance <= radius * (1 + 1e-12)).tolist() if i < j}
            assert sure <= pairs <= maybe


def test_neighbours_across_the_seam_are_found_and_ties_go_to_the_lower_index():
    q = np.array([[1 / 16], [15 / 16], [0.5], [1.0], [-1e-30]])
    space = Torus(1)
    assert nearest(q, 2, space).tolist() == [[3, 4], [3, 4], [0, 1], [4, 0], [3, 0]]
    assert [0, 1] in within(q, 0.125, space).tolist()


@settings(max_examples=50, deadline=None)
@given(points=clouds(), k=st.integers(1, 8), earlier=st.booleans())
def test_any_metric_is_searched_by_all_distances_with_the_same_rule_for_ties(points, k, earlier):
    space = Great()
    found = nearest(points, k, space, earlier=earlier)
    n = len(points)
    assert found.shape == (n, max(min(k, n - 1), 0))
    if n < 2:
        return
    distance = _all_distances(space, points)
    for i in range(n):
        others = [j for j in np.argsort(distance[i], kind="stable") if (j < i if earlier else j != i)][:k]
        assert found[i][found[i] >= 0].tolist() == others
    expected = {(i, j) for i, j in np.argwhere(distance <= 1.0).tolist() if i < j}
    assert {tuple(pair) for pair in within(points, 1.0, space).tolist()} == expected


def test_blocks_of_rows_give_what_one_block_gives(monkeypatch):
    points = np.floor(draw("uniform", 50, 2, rng=4).points * 6)
    whole = nearest(points, 6, Great()), within(points, 2.0, Great())
    monkeypatch.setattr("evenroad.roadmap.neighbours.BLOCK", 120)
    np.testing.assert_array_equal(nearest(points, 6, Great()), whole[0])
    np.testing.assert_array_equal(within(points, 2.0, Great()), whole[1])
