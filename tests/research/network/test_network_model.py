import numpy as np
import pytest
import torch

from evenroad.research.network.model import PointNetwork, edges_of_sets, instance_norm


def network_for(d=2, width=8, layers=2, seed=0):
    return PointNetwork(d, width, layers, np.random.default_rng(seed))


def run(network, sets, k=3, radius=None):
    edges = edges_of_sets(sets, k, radius)
    with torch.no_grad():
        return network(
            torch.from_numpy(sets.astype(np.float32)),
            torch.from_numpy(edges.sender),
            torch.from_numpy(edges.receiver),
        ).numpy()


def slow_layer(layer, points, edges, n):
    """Follow the definition edge by edge and point by point."""
    rows = []
    for i in range(len(points)):
        heard = torch.zeros_like(points[i])
        for j in edges.sender[edges.receiver == i]:
            both = torch.cat([points[i], points[j]])
            heard += layer.message_out(torch.relu(layer.message_in(both)))
        both = torch.cat([points[i], heard])
        rows.append(torch.relu(layer.update_out(torch.relu(layer.update_in(both)))))
    result = torch.stack(rows)
    for first in range(0, len(points), n):
        own = result[first : first + n]
        spread = own.var(dim=0, correction=0)
        result[first : first + n] = (own - own.mean(dim=0)) / torch.sqrt(spread + 1e-5)
    return result


@pytest.mark.parametrize(("k", "radius"), [(1, None), (4, None), (4, 0.4), (4, 0.01)])
def test_a_layer_is_the_sum_over_its_edges(k, radius):
    draws = np.random.default_rng(3)
    network = PointNetwork(2, 6, 1, draws).double()
    layer = network.layers[0]
    edges = edges_of_sets(draws.random((2, 9, 2)), k, radius)
    points = torch.from_numpy(draws.standard_normal((18, 6)))
    with torch.no_grad():
        fast = layer(points, torch.from_numpy(edges.sender), torch.from_numpy(edges.receiver), 9)
        slow = slow_layer(layer, points, edges, 9)
    np.testing.assert_allclose(fast.numpy(), slow.numpy(), atol=1e-12)


def test_the_norm_is_over_each_set_alone():
    points = torch.from_numpy(np.random.default_rng(4).random((20, 3)) * 5 + 7)
    normed = instance_norm(points, 10).view(2, 10, 3)
    np.testing.assert_allclose(normed.mean(dim=1).numpy(), 0.0, atol=1e-12)
    np.testing.assert_allclose(normed.var(dim=1, correction=0).numpy(), 1.0, atol=1e-4)


def test_the_norm_of_equal_points_is_zero_not_nan():
    assert instance_norm(torch.full((5, 2), 3.0), 5).tolist() == [[0.0, 0.0]] * 5


@pytest.mark.parametrize("radius", [None, 0.3])
@pytest.mark.parametrize("d", [1, 3])
def test_permuting_the_starts_permutes_the_points(d, radius):
    draws = np.random.default_rng(5)
    starts = draws.random((1, 16, d)).astype(np.float32).astype(np.float64)
    order = draws.permutation(16)
    network = network_for(d)
    np.testing.assert_allclose(
        run(network, starts[:, order], radius=radius),
        run(network, starts, radius=radius)[:, order],
        atol=1e-5,
    )


def test_sets_of_one_batch_do_not_influence_each_other():
    starts = np.random.default_rng(6).random((3, 16, 2))
    network = network_for()
    np.testing.assert_allclose(run(network, starts)[1:2], run(network, starts[1:2]), atol=1e-6)


def test_points_stay_below_one_even_as_float32_when_the_decoder_saturates():
    network = network_for()
    with torch.no_grad():
        network.decoder.bias.copy_(torch.tensor([1e4, -1e4]))
    points = run(network, np.random.default_rng(7).random((1, 16, 2)))
    assert points.dtype == np.float64
    assert (points.astype(np.float32) < 1.0).all()
    assert (points > 0.0).all()


def test_first_weights_are_those_of_the_generator_and_within_their_bound():
    one, again, other = network_for(seed=1), network_for(seed=1), network_for(seed=2)
    for mine, same, different in zip(one.parameters(), again.parameters(), other.parameters(), strict=True):
        assert torch.equal(mine, same)
        assert not torch.equal(mine, different)
    # 16 inputs: two descriptions side by side.
    weight = one.layers[0].message_in.weight
    assert weight.shape == (8, 16)
    assert 0.2 < weight.abs().max() <= 0.25


def test_building_a_network_leaves_the_global_generator_of_torch_alone():
    before = torch.get_rng_state()
    network_for()
    assert torch.equal(torch.get_rng_state(), before)
