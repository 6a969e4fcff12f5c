"""The network in float32 arrays: forward and backward of one set, and a step of Adam.

Matrices are multiplied once a point, not once an edge: the first linear map of a message is a map of x_i plus a map of
x_j, and its second, applied to the sum over j, is one map with the update's first.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from evenroad._arrays import Ints

Weights: TypeAlias = npt.NDArray[np.float32]

NORM_FLOOR = 1e-5
"""Added to a variance, so that its root can be divided by."""


class Graph(NamedTuple):
    """Who hears whom: receiver and sender of each edge, (e,), and matrices, (n, e), that sum edges over each."""

    receiver: Ints
    sender: Ints
    over_receivers: csr_array
    over_senders: csr_array

    @classmethod
    def of(cls, neighbours: Ints) -> Graph:
        """Return the graph in which point i hears of the points of row i, (n, k), that are no -1."""
        receiver, column = np.nonzero(neighbours >= 0)
        sender = neighbours[receiver, column]
        ones, edge, shape = (
            np.ones(len(receiver), np.float32),
            np.arange(len(receiver)),
            (len(neighbours), len(receiver)),
        )
        sums = [csr_array((ones, (point, edge)), shape=shape) for point in (receiver, sender)]
        return cls(receiver, sender, *sums)


class Parts(NamedTuple):
    """The weights of a network, or their slopes.

    `encoder` is (f, w); `decoder`, (w + 1, d), has the bias as its last row.  The five matrices of a layer in `maps`,
    (layers, 5, w, w), are the message's for x_i and x_j, the update's for what is heard and for x_i, and its second;
    `biases` is (layers, 3, w).
    """

    encoder: Weights
    maps: Weights
    biases: Weights
    decoder: Weights


class Layer(NamedTuple):
    """What `backward` needs of a layer: (n, w) each, but its messages, (e, w), and 1 / deviation, (w,)."""

    points: Weights
    messages: Weights
    heard: Weights
    update: Weights
    last: Weights
    normal: Weights
    scale: Weights


def forward(inputs: Weights, graph: Graph, parts: Parts) -> tuple[Weights, list[Layer]]:
    """Return what the decoder says of every point, (n, d), and the layers; `inputs` is (n, f), its last column 1."""
    points, layers = inputs @ parts.encoder, []
    for (own, theirs, of_heard, of_points, out), bias in zip(parts.maps, parts.biases, strict=True):
        said = (points @ own + bias[0])[graph.receiver] + (points @ theirs)[graph.sender]
        messages = np.maximum(said, 0.0)
        heard = graph.over_receivers @ messages
        update = np.maximum(heard @ of_heard + points @ of_points + bias[1], 0.0)
        last = np.maximum(update @ out + bias[2], 0.0)
        # Every number gets mean 0 and variance 1 over the points.
        scale = 1.0 / np.sqrt(last.var(axis=0) + inputs.dtype.type(NORM_FLOOR))
        normal = (last - last.mean(axis=0)) * scale
        layers.append(Layer(points, messages, heard, update, last, normal, scale))
        points = normal
    return points @ parts.decoder[:-1] + parts.decoder[-1], layers


def backward(inputs: Weights, graph: Graph, parts: Parts, layers: list[Layer], slope: Weights, slopes: Parts) -> None:
    """Write the slope of every weight into `slopes`, given that of the moves, (n, d)."""
    slopes.decoder[:-1] = layers[-1].normal.T @ slope
    slopes.decoder[-1] = slope.sum(axis=0)
    out = slope @ parts.decoder[:-1].T
    for number, layer in reversed(list(enumerate(layers))):
        own, theirs, of_heard, of_points, last = parts.maps[number]
        along = (out * layer.normal).mean(axis=0)
        out = np.where(layer.last > 0.0, layer.scale * (out - out.mean(axis=0) - along * layer.normal), 0.0)
        inner = np.where(layer.update > 0.0, out @ last.T, 0.0)
        # Each message passes the slope of what is heard on where it was not cut.
        passed = np.where(layer.messages > 0.0, (inner @ of_heard.T)[graph.receiver], 0.0)
        to_own, to_theirs = graph.over_receivers @ passed, graph.over_senders @ passed
        points = layer.points.T
        of_maps = (points @ to_own, points @ to_theirs, layer.heard.T @ inner, points @ inner, layer.update.T @ out)
        slopes.maps[number] = np.stack(of_maps)
        slopes.biases[number] = to_own.sum(axis=0), inner.sum(axis=0), out.sum(axis=0)
        out = inner @ of_points.T + to_own @ own.T + to_theirs @ theirs.T
    slopes.encoder[:] = inputs.T @ out


def adam_step(weights: Weights, slope: Weights, first: Weights, second: Weights, step: int, rate: float) -> None:
    """Move flat `weights` by Adam (0.9, 0.999; Kingma and Ba 2015) and update both moments; `step` counts from 1."""
    fast, slow, tiny = np.float32(0.9), np.float32(0.999), np.float32(1e-15)
    first += (1 - fast) * (slope - first)
    second += (1 - slow) * (slope * slope - second)
    spread = np.sqrt(second * np.float32(1.0 / (1.0 - 0.999**step))) + tiny
    weights -= np.float32(rate / (1.0 - 0.9**step)) * first / spread
