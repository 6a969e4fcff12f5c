"""The published layers: slopes against differences, and trainings against PyTorch where it is installed."""

import math

import numpy as np
import pytest

from evenroad.points.anneal import LOWEST
from evenroad.points.measures import MEASURES
from evenroad.points.pointset import BELOW_ONE
from evenroad_studies.network.printed import Printed, Training, losses_of, neighbours_of
from evenroad_studies.network.printed_layers import Weights, backward, batch_graph, first_weights, forward
from evenroad_studies.training.objective import parse_objective


def _case(sets=2, n=9, d=3, width=5, layers=2):
    random = np.random.default_rng(7)
    weights = Weights(*(each.astype(np.float64) for each in first_weights(d, width, layers, random)))
    starts = random.random((sets, n, d))
    graph = batch_graph([neighbours_of(each, Printed(n, d, radius=0.6)) for each in starts])
    return starts.reshape(-1, d), sets, graph, weights


def test_slopes_are_those_of_small_differences():
    starts, sets, graph, weights = _case()
    slope = np.random.default_rng(2).standard_normal((len(starts), 3))
    slopes = Weights(*map(np.zeros_like, weights))
    backward(starts, sets, graph, weights, forward(starts, sets, graph, weights)[1], slope, slopes)
    for part, of_part in zip(weights, slopes, strict=True):
        for at in np.random.default_rng(3).integers(part.size, size=12):
            sides = []
            for move in (1e-6, -1e-6):
                part.flat[at] += move
                sides.append((forward(starts, sets, graph, weights)[0] * slope).sum())
                part.flat[at] -= move
            assert (sides[0] - sides[1]) / 2e-6 == pytest.approx(of_part.flat[at], rel=1e-4, abs=1e-6)


def test_sets_of_a_batch_do_not_hear_each_other():
    starts, _, _, weights = _case()
    graphs = [[neighbours_of(each, Printed(9, 3, radius=0.6))] for each in starts.reshape(2, 9, 3)]
    alone = [
        forward(each, 1, batch_graph(g), weights)[0] for each, g in zip(starts.reshape(2, 9, 3), graphs, strict=True)
    ]
    together = forward(starts, 2, batch_graph(graphs[0] + graphs[1]), weights)[0]
    np.testing.assert_allclose(together, np.concatenate(alone), rtol=1e-12)


def test_every_step_is_that_of_pytorch_from_the_same_weights():
    """Training is chaotic: two orders of a sum differ by 1 % after 30 steps, so each step begins with our weights."""
    torch = pytest.importorskip("torch")
    torch.set_num_threads(1)
    config = Printed(24, 2, sets=3, width=16, steps=1000)
    ours = Training(config, 5, np.float64)
    parts = [torch.tensor(each, requires_grad=True) for each in ours.weights]
    senders = torch.tensor(np.concatenate([(each + 24 * i)[each >= 0] for i, each in enumerate(ours.neighbours)]))
    receivers = torch.tensor(np.concatenate([np.nonzero(e >= 0)[0] + 24 * i for i, e in enumerate(ours.neighbours)]))
    optimiser = torch.optim.Adam(parts, lr=config.rate, weight_decay=config.decay)
    for step in range(config.steps):
        with torch.no_grad():
            for part, own in zip(parts, ours.weights, strict=True):
                np.testing.assert_allclose(part.numpy(), own, rtol=1e-3, atol=1e-5, err_msg=f"after {step} steps")
                part.copy_(torch.tensor(own))
        loss = _loss(torch, config, parts, torch.tensor(ours.starts.reshape(-1, 2)), senders, receivers)
        assert loss.item() == pytest.approx(ours.step(), rel=1e-9)
        optimiser.param_groups[0]["lr"] = config.rate * 0.5 * (1.0 + math.cos(math.pi * step / config.steps))
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()


def _loss(torch, config, parts, inputs, senders, receivers):
    """The published network once more, in PyTorch: the mean loss of the batch."""
    encoder, hear, say, join, out, decoder = parts
    x = inputs @ encoder[:-1] + encoder[-1]
    for i in range(config.layers):
        both = torch.cat([x[receivers], x[senders]], dim=1)
        message = torch.relu(both @ hear[i][:-1] + hear[i][-1])
        message = torch.relu(message @ say[i][:-1] + say[i][-1])
        total = torch.zeros_like(x).index_add(0, receivers, message)
        x = torch.relu(torch.cat([x, total], dim=1) @ join[i][:-1] + join[i][-1])
        x = torch.relu(x @ out[i][:-1] + out[i][-1]).reshape(config.sets, config.n, -1)
        x = (x - x.mean(dim=1, keepdim=True)) / torch.sqrt(x.var(dim=1, keepdim=True, unbiased=False) + 1e-5)
        x = x.reshape(len(inputs), -1)
    points = torch.clamp(x @ decoder[:-1] + decoder[-1] + 0.5, LOWEST, BELOW_ONE)
    return _hickernell(torch, points.reshape(config.sets, config.n, -1)).mean()


def _hickernell(torch, x):
    """Hickernell's L2 discrepancy of sets (s, n, d), written down again: averaged over all projections."""
    n, d = x.shape[1:]
    first = torch.prod((3.0 - x**2) / 2.0, dim=2).sum(dim=1)
    pairs = torch.prod(2.0 - torch.maximum(x[:, :, None], x[:, None]), dim=3).sum(dim=(1, 2))
    return torch.sqrt((4.0 / 3.0) ** d - 2.0 / n * first + pairs / n**2)


def test_losses_are_those_of_the_measure():
    sets = np.random.default_rng(1).random((3, 10, 2))
    values, _ = losses_of(sets, parse_objective("hickernell"))
    np.testing.assert_allclose(values, [MEASURES["hickernell"].rooted(each) for each in sets], rtol=1e-12)
