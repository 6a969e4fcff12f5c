"""The layers of Message-Passing Monte Carlo as published: a batch of sets forward, backward, and a step of Adam.

A message is two linear maps, each with a ReLU, of the receiver and the sender; messages are summed; two further maps
with ReLUs take the point and that sum; then each number is normalised over the points of its set (Rusch et al. 2024).
The first map of a message splits into one of the receiver and one of the sender, so it costs points, not edges.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad_studies.network.layers import NORM_FLOOR, Graph

Real = npt.NDArray[np.floating]
"""Single precision, or double where a test compares."""

ADAM_FLOOR = 1e-8
"""Added to the root of the second moment, as in PyTorch."""


class Weights(NamedTuple):
    """The weights, or their slopes; the last row of each matrix is the bias.

    `encoder` is (d + 1, w) and `decoder` (w + 1, d).  Of each layer `hear`, (2 w + 1, w), takes receiver and sender,
    `say`, (w + 1, w), makes the message, `join`, (2 w + 1, w), takes the point and the sum, and `out` is (w + 1, w).
    """

    encoder: Real
    hear: Real
    say: Real
    join: Real
    out: Real
    decoder: Real


def shapes_of(d: int, width: int, layers: int) -> Weights:
    """Return the shapes of the weights, in their order."""
    wide, deep = (layers, 2 * width + 1, width), (layers, width + 1, width)
    return Weights((d + 1, width), wide, deep, wide, deep, (width + 1, d))  # type: ignore[arg-type]


def first_weights(d: int, width: int, layers: int, random: np.random.Generator) -> Weights:
    """Draw the weights as PyTorch's linear maps begin: uniform within 1 / sqrt(inputs), biases too; float32."""
    drawn = []
    for shape in shapes_of(d, width, layers):
        bound = 1.0 / math.sqrt(int(shape[-2]) - 1)
        drawn.append(random.uniform(-bound, bound, tuple(shape)).astype(np.float32))
    return Weights(*drawn)


class Layer(NamedTuple):
    """What `backward` needs of a layer: values of all edges, (e, w), or of all points, (m, w)."""

    points: Real
    heard: Real
    said: Real
    total: Real
    joined: Real
    last: Real
    normal: Real
    scale: Real


def _linear(x: Real, matrix: Real) -> Real:
    return np.asarray(x @ matrix[:-1] + matrix[-1])


def forward(starts: Real, sets: int, graph: Graph, weights: Weights) -> tuple[Real, list[Layer]]:
    """Return what is decoded for every point, (sets * n, d), and the layers; `starts` are stacked, (sets * n, d)."""
    points, layers, width = _linear(starts, weights.encoder), [], weights.encoder.shape[1]
    for hear, say, join, out in zip(weights.hear, weights.say, weights.join, weights.out, strict=True):
        own, theirs = points @ hear[:width] + hear[-1], points @ hear[width:-1]
        heard = np.maximum(own[graph.receiver] + theirs[graph.sender], 0.0)
        said = np.maximum(_linear(heard, say), 0.0)
        total = graph.over_receivers @ said
        joined = np.maximum(points @ join[:width] + total @ join[width:-1] + join[-1], 0.0)
        last = np.maximum(_linear(joined, out), 0.0)
        of_set = last.reshape(sets, -1, width)
        scale = 1.0 / np.sqrt(of_set.var(axis=1, keepdims=True) + starts.dtype.type(NORM_FLOOR))
        normal = ((of_set - of_set.mean(axis=1, keepdims=True)) * scale).reshape(last.shape)
        layers.append(Layer(points, heard, said, total, joined, last, normal, scale))
        points = normal
    return _linear(points, weights.decoder), layers


def backward(
    starts: Real, sets: int, graph: Graph, weights: Weights, layers: list[Layer], slope: Real, slopes: Weights
) -> None:
    """Write the slope of every weight into `slopes`, given that of what is decoded, (sets * n, d)."""
    width = weights.encoder.shape[1]
    out = _back(layers[-1].normal, slope, weights.decoder, slopes.decoder)
    for number, layer in reversed(list(enumerate(layers))):
        of_set, normal = out.reshape(sets, -1, width), layer.normal.reshape(sets, -1, width)
        along = (of_set * normal).mean(axis=1, keepdims=True)
        out = (layer.scale * (of_set - of_set.mean(axis=1, keepdims=True) - along * normal)).reshape(out.shape)
        inner = _back(layer.joined, np.where(layer.last > 0.0, out, 0.0), weights.out[number], slopes.out[number])
        inner = np.where(layer.joined > 0.0, inner, 0.0)
        both = _back(np.hstack([layer.points, layer.total]), inner, weights.join[number], slopes.join[number])
        passed = np.where(layer.said > 0.0, both[:, width:][graph.receiver], 0.0)
        passed = _back(layer.heard, passed, weights.say[number], slopes.say[number])
        passed = np.where(layer.heard > 0.0, passed, 0.0)
        own, theirs, hear = graph.over_receivers @ passed, graph.over_senders @ passed, weights.hear[number]
        slopes.hear[number][:width] = layer.points.T @ own
        slopes.hear[number][width:-1] = layer.points.T @ theirs
        slopes.hear[number][-1] = own.sum(axis=0)
        out = both[:, :width] + own @ hear[:width].T + theirs @ hear[width:-1].T
    slopes.encoder[:-1], slopes.encoder[-1] = starts.T @ out, out.sum(axis=0)


def _back(inputs: Real, slope: Real, matrix: Real, slopes: Real) -> Real:
    """Write the slopes of a linear map's matrix, and return that of its inputs."""
    slopes[:-1], slopes[-1] = inputs.T @ slope, slope.sum(axis=0)
    return np.asarray(slope @ matrix[:-1].T)


class Adam:
    """Adam with weight decay added to the slopes, as in PyTorch (0.9, 0.999; Kingma and Ba 2015)."""

    def __init__(self, weights: Weights, decay: float) -> None:
        self.decay, self._step = decay, 0
        self._first, self._second = ([np.zeros_like(each) for each in weights] for _ in range(2))

    def step(self, weights: Weights, slopes: Weights, rate: float) -> None:
        """Move the weights."""
        self._step += 1
        root = math.sqrt(1.0 - 0.999**self._step)
        moved = rate / (1.0 - 0.9**self._step)
        for weight, slope, first, second in zip(weights, slopes, self._first, self._second, strict=True):
            decayed = slope + self.decay * weight
            first += 0.1 * (decayed - first)
            second += 0.001 * (decayed * decayed - second)
            weight -= moved * first / (np.sqrt(second) / root + ADAM_FLOOR)


def batch_graph(neighbours: list[Ints]) -> Graph:
    """Return the graph of all sets, whose points are stacked: row i of a set's array has the senders to its point i."""
    most = max(each.shape[1] for each in neighbours)
    stacked, begin = [], 0
    for each in neighbours:
        row = np.full((len(each), most), -1, dtype=np.int64)
        row[:, : each.shape[1]] = np.where(each >= 0, each + begin, -1)
        stacked.append(row)
        begin += len(each)
    return Graph.of(np.concatenate(stacked))


def stacked(sets: Floats) -> Floats:
    """Return the points of all sets one after the other, (sets * n, d)."""
    return sets.reshape(-1, sets.shape[-1])
