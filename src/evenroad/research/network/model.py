"""The network: the graph of neighbours, message-passing layers between encoder and decoder, and the loss.

The graph links neighbours among the starting points and stays the same during the training.  The loss is an objective
of the compiled kernels, with its gradient.  They run on the CPU in float64 wherever the network runs: to hand over 16
sets of 1024 points in d = 10 takes 1.3 MB, and no measure has to be written a second time.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import torch
from scipy.spatial import cKDTree
from torch import nn
from torch.autograd.function import once_differentiable
from torch.nn import functional

from evenroad._arrays import Floats, Ints
from evenroad.errors import InvalidValue
from evenroad.points.pointset import BELOW_ONE
from evenroad.research.training.objective import Objective


class Edges(NamedTuple):
    """Messages of a graph, sorted by receiver: number e goes from point ``sender[e]`` to ``receiver[e]``, (m,) each."""

    sender: Ints
    receiver: Ints


def nearest_edges(points: Floats, k: int) -> Edges:
    """Send every point of (n, d) messages from its k nearest others, or from all others if n <= k."""
    n = len(points)
    k = min(k, n - 1)
    _, found = cKDTree(points).query(points, k=k + 1)
    found = found.reshape(n, k + 1)
    other = found != np.arange(n)[:, np.newaxis]
    # If more than k others lie at distance 0, the point itself may not be among the k + 1 nearest.
    other[other.all(axis=1), -1] = False
    return Edges(found[other].astype(np.int64), np.repeat(np.arange(n), k))


def radius_edges(points: Floats, radius: float) -> Edges:
    """Send every point of (n, d) messages from all points at most `radius` away, itself included."""
    lists = cKDTree(points).query_ball_point(points, radius, return_sorted=True)
    found = [np.array(each, dtype=np.int64) for each in lists]
    degrees = [len(each) for each in found]
    return Edges(np.concatenate(found), np.repeat(np.arange(len(points)), degrees))


def edges_of_sets(sets: Floats, k: int, radius: float | None) -> Edges:
    """Return the graphs of several sets, (s, n, d), n >= 2, as one; point i of set t has the number t n + i.

    Points are joined to their `k` nearest; or, where `radius` is given, to all within it.
    """
    n = sets.shape[1]
    graphs = [nearest_edges(each, k) if radius is None else radius_edges(each, radius) for each in sets]
    return Edges(
        np.concatenate([graph.sender + t * n for t, graph in enumerate(graphs)]),
        np.concatenate([graph.receiver + t * n for t, graph in enumerate(graphs)]),
    )


NORM_FLOOR = 1e-5
"""Added to a variance, so that its root can be divided by."""


class MessageLayer(nn.Module):
    """Rewrite the `width` numbers that describe every point from its own and its neighbours' (Rusch et al. 2024).

        m_i  = sum over neighbours j of message(x_i, x_j)
        x_i' = instance_norm(relu(update(x_i, m_i)))

    Both `message` and `update` are linear -> ReLU -> linear on the two arguments side by side.
    """

    def __init__(self, width: int) -> None:
        super().__init__()
        self.message_in = nn.utils.skip_init(nn.Linear, 2 * width, width)
        self.message_out = nn.utils.skip_init(nn.Linear, width, width)
        self.update_in = nn.utils.skip_init(nn.Linear, 2 * width, width)
        self.update_out = nn.utils.skip_init(nn.Linear, width, width)

    def forward(
        self, points: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor, n: int
    ) -> torch.Tensor:
        """Return the new descriptions of the points of several sets of n, shape (sets * n, width)."""
        update = functional.relu(
            self.update_in(torch.cat([points, self.heard(points, sender, receiver)], dim=1))
        )
        return instance_norm(functional.relu(self.update_out(update)), n)

    def heard(self, points: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor) -> torch.Tensor:
        """Return the sum of the messages that every point gets, shape (sets * n, width).

        Matrices are multiplied once a point, not once an edge: the first linear map of a message is a map of x_i
        plus a map of x_j, and the second is applied to the sum over j.  Only the ReLU between them is done edge by
        edge.
        """
        width = points.shape[1]
        own = functional.linear(points, self.message_in.weight[:, :width], self.message_in.bias)
        theirs = functional.linear(points, self.message_in.weight[:, width:])
        # In place: with a row for each edge these are the largest tensors of a training.
        hidden = own.index_select(0, receiver).add_(theirs.index_select(0, sender)).relu_()
        summed = torch.zeros_like(own).index_add(0, receiver, hidden)
        messages = torch.bincount(receiver, minlength=len(points)).to(points.dtype)
        return functional.linear(summed, self.message_out.weight) + messages[:, None] * self.message_out.bias


def instance_norm(points: torch.Tensor, n: int) -> torch.Tensor:
    """Give every number of the descriptions mean 0 and variance 1 over the n points of its set."""
    sets = points.view(-1, n, points.shape[1])
    centred = sets - sets.mean(dim=1, keepdim=True)
    scale = torch.rsqrt(centred.square().mean(dim=1, keepdim=True) + NORM_FLOOR)
    return (centred * scale).view(points.shape)


class PointNetwork(nn.Module):
    """Turn random points into even ones (Rusch, Kirk, Bronstein, Lemieux, Rus 2024).

    `width` and `layers` are those of :class:`~evenroad.research.network.NetworkConfig`.  Weights and biases of every
    linear map are uniform within 1 / sqrt(its inputs), as in torch, but drawn by NumPy: torch would use its global
    generator.
    """

    def __init__(self, d: int, width: int, layers: int, draws: np.random.Generator) -> None:
        super().__init__()
        self.encoder = nn.utils.skip_init(nn.Linear, d, width)
        self.layers = nn.ModuleList(MessageLayer(width) for _ in range(layers))
        self.decoder = nn.utils.skip_init(nn.Linear, width, d)
        with torch.no_grad():
            for module in self.modules():
                if isinstance(module, nn.Linear):
                    bound = 1.0 / math.sqrt(module.in_features)
                    for parameter in (module.weight, module.bias):
                        parameter.copy_(
                            torch.from_numpy(draws.uniform(-bound, bound, tuple(parameter.shape)))
                        )

    def forward(self, starts: torch.Tensor, sender: torch.Tensor, receiver: torch.Tensor) -> torch.Tensor:
        """Return the points that the network makes of random `starts`, (sets, n, d) float32, as (sets, n, d) float64.

        They lie in the open unit cube, and below 1 as float32 too.  `sender` and `receiver`, (m,), are the graph of
        :func:`edges_of_sets`.
        """
        sets, n, d = starts.shape
        points = self.encoder(starts.reshape(sets * n, d))
        for layer in self.layers:
            points = layer(points, sender, receiver, n)
        # In float64, where the sigmoid keeps points near a face apart that float32 would put onto it.
        inside = torch.sigmoid(self.decoder(points).double())
        return inside.clamp(1.0 - BELOW_ONE, BELOW_ONE).view(sets, n, d)


def objective_of_sets(points: torch.Tensor, objective: Objective) -> torch.Tensor:
    """Return the objective of every set of points, (sets, n, d) float64 in [0, 1), as (sets,), differentiable once.

    Raises InvalidValue if a point, a value or a gradient is not finite: the training has diverged.
    """
    return _ObjectiveOfSets.apply(points, objective)


class _ObjectiveOfSets(torch.autograd.Function):
    """An objective in torch: the kernels give value and gradient together, so `forward` keeps it for `backward`."""

    @staticmethod
    def forward(ctx: Any, points: torch.Tensor, objective: Objective) -> torch.Tensor:
        given = points.detach().cpu().numpy()
        _require_finite("the network's points", given)  # before the kernels: their fastmath knows no NaN
        values, gradient = np.empty(len(given)), np.empty_like(given)
        for index, each in enumerate(given):
            values[index], by_columns = objective.of_columns(np.ascontiguousarray(each.T))
            gradient[index] = by_columns.T
        _require_finite(f"the objective '{objective}'", values)
        _require_finite(f"the gradient of '{objective}'", gradient)
        ctx.save_for_backward(torch.from_numpy(gradient).to(points.device))
        return torch.from_numpy(values).to(points.device)

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, slope: torch.Tensor) -> tuple[torch.Tensor, None]:
        (gradient,) = ctx.saved_tensors
        return slope[:, None, None] * gradient, None


def _require_finite(what: str, values: np.ndarray) -> None:
    if not np.isfinite(values).all():
        raise InvalidValue(f"{what} became infinite or NaN: the training diverged; use a smaller rate")
