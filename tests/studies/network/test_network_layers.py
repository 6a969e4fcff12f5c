"""The passes beside a plain network with a message for every edge, and beside finite differences."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad_studies.network.layers import NORM_FLOOR, Graph, Parts, adam_step, backward, forward
from evenroad_studies.network.train import nearest
from tests.differences import slopes

N, D, K, WIDTH, LAYERS = 13, 3, 4, 6, 2


def random_network(seed=0, dtype=np.float64):
    draws = np.random.default_rng(seed)
    starts = draws.random((N, D))
    shapes = [(D + 1, WIDTH), (LAYERS, 5, WIDTH, WIDTH), (LAYERS, 3, WIDTH), (WIDTH + 1, D)]
    weights = [draws.normal(size=shape).astype(dtype) for shape in shapes]
    return np.hstack([starts, np.ones((N, 1))]).astype(dtype), nearest(starts, K), weights


def moves_of(inputs, neighbours, weights):
    return forward(inputs, Graph.of(neighbours), Parts(*weights))[0]


def plain_moves(inputs, neighbours, weights):
    encoder, maps, biases, decoder = weights
    points = inputs @ encoder
    for (mine, theirs, heard, kept, out), (message, update, last) in zip(maps, biases, strict=True):
        after = []
        for i, own in enumerate(points):
            told = sum(np.maximum(own @ mine + points[j] @ theirs + message, 0.0) for j in neighbours[i])
            inner = np.maximum(told @ heard + own @ kept + update, 0.0)
            after.append(np.maximum(inner @ out + last, 0.0))
        points = (after - np.mean(after, axis=0)) / np.sqrt(np.var(after, axis=0) + NORM_FLOOR)
    return points @ decoder[:-1] + decoder[-1]


def test_the_forward_pass_is_the_network_written_plainly_in_float32_to_six_digits():
    exact = plain_moves(*random_network())
    np.testing.assert_allclose(moves_of(*random_network()), exact, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(moves_of(*random_network(dtype=np.float32)), exact, rtol=2e-4, atol=2e-5)


@pytest.mark.parametrize("part", range(4))
def test_the_slopes_are_those_of_finite_differences(part):
    inputs, neighbours, weights = random_network(3)
    wanted = np.random.default_rng(1).random((N, D))
    graph, parts = Graph.of(neighbours), Parts(*weights)
    found = Parts(*(np.full_like(each, np.nan) for each in weights))
    backward(inputs, graph, parts, forward(inputs, graph, parts)[1], wanted, found)
    some = np.random.default_rng(2).choice(weights[part].size, min(25, weights[part].size), replace=False)

    def moved(flat):
        others = [*weights[:part], flat.reshape(weights[part].shape), *weights[part + 1 :]]
        return float((moves_of(inputs, neighbours, others) * wanted).sum())

    slow = slopes(moved, weights[part].ravel(), places=some)
    np.testing.assert_allclose(found[part].ravel()[some], slow[some], rtol=1e-4, atol=1e-6)


def test_a_neighbour_of_minus_one_says_nothing():
    inputs, neighbours, weights = random_network(1)
    fewer = neighbours.copy()
    fewer[::2, 2:] = -1
    listed = [row[row >= 0] for row in fewer]
    np.testing.assert_allclose(moves_of(inputs, fewer, weights), plain_moves(inputs, listed, weights), rtol=1e-9)


def test_a_step_of_adam_is_that_of_its_formulas():
    slopes = np.random.default_rng(0).normal(size=(3, 5)).astype(np.float32)
    weights, first, second = np.ones(5, np.float32), np.zeros(5, np.float32), np.zeros(5, np.float32)
    expected, m, v = np.ones(5), np.zeros(5), np.zeros(5)
    for step, slope in enumerate(slopes, start=1):
        adam_step(weights, slope, first, second, step, 0.01)
        m, v = 0.9 * m + 0.1 * slope, 0.999 * v + 0.001 * slope.astype(float) ** 2
        expected -= 0.01 * (m / (1 - 0.9**step)) / np.sqrt(v / (1 - 0.999**step))
    np.testing.assert_allclose(weights, expected, rtol=1e-5)


@settings(max_examples=30)
@given(st.integers(2, 30), st.integers(1, 6), st.integers(1, 12), st.integers(0, 1000))
def test_every_point_hears_of_its_k_nearest_others(n, d, k, seed):
    points = np.random.default_rng(seed).random((n, d))
    found = nearest(points, k)
    assert found.shape == (n, min(k, n - 1))
    for i in range(n):
        distances = {j: np.linalg.norm(points[i] - points[j]) for j in range(n) if j != i}
        assert found[i].tolist() == sorted(distances, key=distances.get)[:k]


def test_points_on_one_spot_hear_of_each_other_and_never_of_themselves():
    for i, heard in enumerate(nearest(np.zeros((6, 2)), 3)):
        assert i not in heard
        assert len(set(heard.tolist())) == 3
