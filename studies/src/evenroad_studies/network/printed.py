"""Message-Passing Monte Carlo as the paper prints it: random points in, a batch of sets trained together.

Random points are encoded, pass messages along a graph of the initial points, and are decoded to positions in the cube
(Rusch, Kirk, Bronstein, Lemieux and Rus 2024; Chahine et al. 2025, figure 2).  The graph joins the nearest ones, as
printed, or all within a radius, as in the public code.  One network serves all sets of a batch, whose mean loss is made
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
from evenroad_studies.network.config import NetworkConfig
from evenroad_studies.network.layers import Graph
from evenroad_studies.network.train import Network, nearest
from evenroad_studies.training.objective import parse_objective

ENDS = ("clamp", "sigmoid")
"""How a decoded number becomes a coordinate: cut off at 0 and 1, as printed, or the logistic function of it."""


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
        The k nearest initial points send a point messages; with a radius all within it do.
    end : str
        One of ``ENDS``.
    width, layers, steps, rate : int, int, int, float
        As in :class:`NetworkConfig`.
    """

    n: int
    d: int
    sets: int = 8
    objective: str = "hickernell"
    k: int = 8
    radius: float | None = None
    end: str = "clamp"
    width: int = 64
    layers: int = 3
    steps: int = 5000
    rate: float = 1e-3

    def __post_init__(self) -> None:
        for name, least in {"n": 2, "d": 1, "sets": 1, "k": 1, "width": 1, "layers": 1, "steps": 1}.items():
            set_fields(self, **{name: require_count(name, getattr(self, name), at_least=least)})
        require_known("end", self.end, ENDS)
        set_fields(self, rate=require_positive("rate", self.rate), objective=str(parse_objective(self.objective)))
        if self.radius is not None:
            set_fields(self, radius=require_positive("radius", self.radius))


Seen = Callable[[int, float, Floats], object]
"""``seen(step, loss, points)`` after every step from 1 on: the batch's mean loss, and its best points, (sets, n, d)."""


def train_printed(
    config: Printed, *, rng: RngLike = 0, seen: Seen | None = None
) -> tuple[tuple[PointSet, ...], Floats]:
    """Train one network on a batch; return the sets, best first, and the mean loss before each step, (steps,).

    Of every set the best points that training saw are kept.  Raises InvalidValue if the training diverges.
    """
    draws = generator(rng)
    objective = parse_objective(config.objective)
    network = Network(NetworkConfig(config.n, config.d, width=config.width, layers=config.layers), draws)
    network.begin_anywhere(draws)
    starts = draws.random((config.sets, config.n, config.d))
    graphs = [Graph.of(neighbours_of(each, config)) for each in starts]
    best, points, curve = np.full(config.sets, np.inf), starts.copy(), np.empty(config.steps)
    for step in range(config.steps):
        total, loss = np.zeros_like(network.slopes), 0.0
        for i, (start, graph) in enumerate(zip(starts, graphs, strict=True)):
            decoded = network.moves(start, graph)
            placed, steepness = _end(decoded, config.end)
            value, columns = objective.of_columns(np.ascontiguousarray(placed.T))
            if not math.isfinite(value):
                raise InvalidValue(f"the objective '{objective}' is {value} at step {step}: the training has diverged")
            if value < best[i]:
                best[i], points[i] = value, placed
            loss += value / config.sets
            total += network.slope_of(columns.T * steepness / config.sets)
        curve[step] = loss
        network.step(total, config.rate * 0.5 * (1.0 + math.cos(math.pi * step / config.steps)))
        if seen is not None:
            seen(step + 1, loss, points)
    origin = Origin(family="mpmc", method="network as printed", objective=str(objective), steps=config.steps)
    sets = (PointSet(points[i], origin).with_origin(seed=seed_of(rng), replica=int(i)) for i in np.argsort(best))
    return tuple(sets), curve


def neighbours_of(points: Floats, config: Printed) -> Ints:
    """Return the points that send each point messages, (n, most), filled up with -1 where a radius has fewer."""
    if config.radius is None:
        return nearest(points, config.k)
    found = cKDTree(points).query_ball_point(points, config.radius)
    others = [[j for j in row if j != i] for i, row in enumerate(found)]
    neighbours = np.full((len(points), max(1, *map(len, others))), -1, dtype=np.int64)
    for row, each in zip(neighbours, others, strict=True):
        row[: len(each)] = each
    return neighbours


def _end(decoded: Floats, end: str) -> tuple[Floats, Floats]:
    """Return the positions of decoded numbers, inside the open cube, and their slopes in these."""
    if end == "clamp":
        placed = np.clip(decoded + 0.5, LOWEST, BELOW_ONE)
        return placed, (placed == decoded + 0.5).astype(np.float64)
    placed = 1.0 / (1.0 + np.exp(-np.clip(decoded, -40.0, 40.0)))
    return np.clip(placed, LOWEST, BELOW_ONE), placed * (1.0 - placed)
