"""Message-Passing Monte Carlo as printed: random points in, a batch of sets trained together.

Random points are encoded, pass messages along a graph of the initial points, and are decoded to positions in the cube
(Rusch, Kirk, Bronstein, Lemieux and Rus 2024; Chahine et al. 2025, figure 2).  The layers are those of the public code
(:mod:`evenroad_studies.network.printed_layers`).  The graph joins the points within a radius, at most 32, or the
nearest ones; each point sends messages to itself, too.  One network serves all sets of a batch, whose mean loss is made
small.  What :mod:`evenroad_studies.network.train` does instead, and what it gains, is in ``which-optimiser.md``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from evenroad._arrays import Floats, Ints, set_fields
from evenroad._checks import require_count, require_known, require_positive
from evenroad._rng import RngLike, generator, seed_of
from evenroad.errors import InvalidValue
from evenroad.points.anneal import LOWEST
from evenroad.points.pointset import BELOW_ONE, Origin, PointSet
from evenroad_studies.network.printed_layers import (
    Adam,
    Weights,
    backward,
    batch_graph,
    first_weights,
    forward,
    stacked,
)
from evenroad_studies.network.train import nearest
from evenroad_studies.training.objective import Objective, parse_objective

ENDS = ("clamp", "sigmoid")
"""How a decoded number becomes a coordinate: moved by 1/2 and cut off at 0 and 1, as printed, or its logistic function,
as in the public code.
"""

MOST = 32
"""Largest number of points within a radius that send a point messages, as in the public code."""


@dataclass(frozen=True)
class Printed:
    """All that decides the result of a training, apart from the seed.

    Attributes
    ----------
    n, d, sets : int
        Number of points, >= 2, dimension, and sets that are trained together: 8, 16 or 32 in the paper.
    objective : str
        What is made small: ``hickernell``, or ``star`` for the L2 star discrepancy.
    k, radius : int, float or None
        The k nearest initial points send a point messages; with a radius the first 32 within it do.
    end : str
        One of ``ENDS``.
    width, layers, steps, rate : int, int, int, float
        Numbers that describe a point inside, layers, and steps of Adam, whose rate falls to zero along half a cosine.
    decay : float
        What each weight adds of itself to its slope.
    """

    n: int
    d: int
    sets: int = 8
    objective: str = "hickernell"
    k: int = 8
    radius: float | None = 0.35
    end: str = "clamp"
    width: int = 64
    layers: int = 3
    steps: int = 5000
    rate: float = 1e-3
    decay: float = 1e-6

    def __post_init__(self) -> None:
        for name, least in {"n": 2, "d": 1, "sets": 1, "k": 1, "width": 1, "layers": 1, "steps": 1}.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least=least)})
        require_known("end", self.end, ENDS)
        set_fields(self, decay=require_positive("decay", self.decay, or_zero=True))
        set_fields(self, rate=require_positive("rate", self.rate), objective=str(parse_objective(self.objective)))
        if self.radius is not None:
            set_fields(self, radius=require_positive("radius", self.radius))


Seen = Callable[[int, float, Floats], object]
"""``seen(step, loss, points)`` after every step from 1 on: the batch's mean loss, and its best points, (sets, n, d)."""


class Training:
    """A network, the random points that it starts from, and the best points of every set so far.

    `precision` is that of the network: single, or double where a test compares.
    """

    def __init__(self, config: Printed, rng: RngLike, precision: type[np.floating] = np.float32) -> None:
        draws = generator(rng)
        self.config, self._objective = config, parse_objective(config.objective)
        drawn = first_weights(config.d, config.width, config.layers, draws)
        self.weights = Weights(*(each.astype(precision) for each in drawn))
        self._slopes, self._adam = Weights(*map(np.zeros_like, self.weights)), Adam(self.weights, config.decay)
        self.starts = draws.random((config.sets, config.n, config.d))
        self.neighbours = [neighbours_of(each, config) for each in self.starts]
        self._graph, self._inputs = batch_graph(self.neighbours), stacked(self.starts).astype(precision)
        self.best, self.points, self._step = np.full(config.sets, np.inf), self.starts.copy(), 0

    def step(self) -> float:
        """Do a step of Adam, and return the mean loss before it; raises InvalidValue if it is not finite."""
        config, sets = self.config, self.config.sets
        decoded, layers = forward(self._inputs, sets, self._graph, self.weights)
        placed, steepness = _end(decoded.astype(np.float64).reshape(self.starts.shape), config.end)
        values, gradients = losses_of(placed, self._objective)
        if not np.isfinite(values).all():
            raise InvalidValue(
                f"the objective '{self._objective}' is not finite at step {self._step}: the training has diverged"
            )
        better = values < self.best
        self.best[better], self.points[better] = values[better], placed[better]
        slope = stacked(gradients * steepness / sets).astype(self._inputs.dtype)
        backward(self._inputs, sets, self._graph, self.weights, layers, slope, self._slopes)
        rate = config.rate * 0.5 * (1.0 + math.cos(math.pi * self._step / config.steps))
        self._adam.step(self.weights, self._slopes, rate)
        self._step += 1
        return float(values.mean())


def train_printed(
    config: Printed, *, rng: RngLike = 0, seen: Seen | None = None
) -> tuple[tuple[PointSet, ...], Floats]:
    """Train one network on a batch; return the sets, best first, and the mean loss before each step, (steps,).

    Of every set the best points that training saw are kept.  Raises InvalidValue if the training diverges.
    """
    training, curve = Training(config, rng), np.empty(config.steps)
    for step in range(config.steps):
        curve[step] = training.step()
        if seen is not None:
            seen(step + 1, float(curve[step]), training.points)
    objective, points = str(parse_objective(config.objective)), training.points
    origin = Origin(family="mpmc", method="network as printed", objective=objective, steps=config.steps)
    sets = (
        PointSet(points[i], origin).with_origin(seed=seed_of(rng), replica=int(i)) for i in np.argsort(training.best)
    )
    return tuple(sets), curve


def losses_of(sets: Floats, objective: Objective) -> tuple[Floats, Floats]:
    """Return the loss of each set, (sets,), and its slopes in the points, (sets, n, d)."""
    values, gradients = np.empty(len(sets)), np.empty_like(sets)
    for i, points in enumerate(sets):
        values[i], columns = objective.of_columns(np.ascontiguousarray(points.T))
        gradients[i] = columns.T
    return values, gradients


def neighbours_of(points: Floats, config: Printed) -> Ints:
    """Return the points that send each point messages, itself first, (n, most), filled up with -1 for a radius."""
    own = np.arange(len(points))[:, np.newaxis]
    if config.radius is None:
        return np.hstack([own, nearest(points, config.k)])
    found = cKDTree(points).query_ball_point(points, config.radius, return_sorted=True)
    others = [[j for j in row if j != i][: MOST - 1] for i, row in enumerate(found)]
    neighbours = np.full((len(points), max(map(len, others))), -1, dtype=np.int64)
    for row, each in zip(neighbours, others, strict=True):
        row[: len(each)] = each
    return np.hstack([own, neighbours])


def _end(decoded: Floats, end: str) -> tuple[Floats, Floats]:
    """Return the positions of decoded numbers, inside the open cube, and their slopes in these."""
    if end == "clamp":
        placed = np.clip(decoded + 0.5, LOWEST, BELOW_ONE)
        return placed, (placed == decoded + 0.5).astype(np.float64)
    placed = 1.0 / (1.0 + np.exp(-np.clip(decoded, -40.0, 40.0)))
    return np.clip(placed, LOWEST, BELOW_ONE), placed * (1.0 - placed)
