"""Training the network on one set of points, and annealing what it made."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from evenroad._arrays import Floats, Ints
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.points.anneal import LOWEST, Annealed, Callback, anneal, first_rate, noise_over_rate
from evenroad.points.measures import star_discrepancy
from evenroad.points.pointset import BELOW_ONE, Origin, PointSet
from evenroad.points.samplers import draw
from evenroad_studies.network.config import NetworkConfig
from evenroad_studies.network.layers import Graph, Parts, Weights, adam_step, backward, forward
from evenroad_studies.training.objective import Objective, parse_objective

STEEPEST = 1e30
"""Largest slope of an objective in a coordinate that a network is trained with: its squares are summed in float32."""

INSET = 1e-4
"""Starts lie so far inside the faces of the cube, where the logit would be infinite."""


class Network:
    """The weights of a network and what it remembers of its last pass: all float32, the weights in one flat array."""

    def __init__(self, config: NetworkConfig, draws: np.random.Generator) -> None:
        d, width, layers = config.d, config.channels, config.layers
        shapes = ((d + 1, width), (layers, 5, width, width), (layers, 3, width), (width + 1, d))
        self.weights = np.zeros(sum(map(math.prod, shapes)), np.float32)
        self.slopes = np.zeros_like(self.weights)
        self._first, self._second = np.zeros_like(self.weights), np.zeros_like(self.weights)
        self._parts, self._slope_parts = _split(self.weights, shapes), _split(self.slopes, shapes)
        encoder, maps, biases, decoder = self._parts
        # Uniform within 1 / sqrt(inputs), as is usual; less in the decoder: the points begin near their starts.
        for part, bound in ((encoder, 1.7 / math.sqrt(d + 1)), (maps, 1.0), (biases, 1.0), (decoder, 0.1)):
            scale = bound if part is encoder else bound / math.sqrt(width)
            part[:] = draws.uniform(-scale, scale, part.shape)
        self._step = 0

    def moves(self, starts: Floats, graph: Graph) -> Floats:
        """Return by how much to move each start, (n, d), in the logit of its coordinates."""
        inputs = np.ones((len(starts), starts.shape[1] + 1), np.float32)
        inputs[:, :-1] = 2.0 * starts - 1.0
        moves, layers = forward(inputs, graph, self._parts)
        self._last = inputs, graph, layers
        return moves.astype(np.float64)

    def learn(self, slope: Floats, rate: float) -> None:
        """Do a step of Adam, given the slope of the objective in the last moves."""
        self.step(self.slope_of(slope), rate)

    def slope_of(self, slope: Floats) -> Weights:
        """Return the slope of every weight, given that of the objective in the last moves; the next call changes it."""
        inputs, graph, layers = self._last
        backward(inputs, graph, self._parts, layers, slope.astype(np.float32), self._slope_parts)
        return self.slopes

    def step(self, slope: Weights, rate: float) -> None:
        """Do a step of Adam, given the slope of every weight."""
        self._step += 1
        adam_step(self.weights, slope, self._first, self._second, self._step, rate)

    def begin_anywhere(self, draws: np.random.Generator) -> None:
        """Draw the decoder as the other maps are: what it says first has nothing to do with the starts."""
        decoder = self._parts[3]
        bound = 1.0 / math.sqrt(len(decoder) - 1)
        decoder[:] = draws.uniform(-bound, bound, decoder.shape)


def _split(flat: Weights, shapes: Sequence[tuple[int, ...]]) -> Parts:
    """Return views of a flat array, one after the other, in these shapes."""
    ends = np.cumsum([math.prod(shape) for shape in shapes])[:-1]
    return Parts(*(part.reshape(shape) for part, shape in zip(np.split(flat, ends), shapes, strict=True)))


def nearest(points: Floats, k: int) -> Ints:
    """Return the k nearest others of every point, or all others if n <= k, shape (n, k); equal points in any order."""
    n = len(points)
    k = min(k, n - 1)
    _, found = cKDTree(points).query(points, k=k + 1)
    other = found != np.arange(n)[:, np.newaxis]
    # If more than k others lie at distance 0, the point itself may not be among the k + 1 nearest.
    other[other.all(axis=1), -1] = False
    return found[other].reshape(n, k).astype(np.int64)


def train(config: NetworkConfig, *, rng: RngLike = 0, callback: Callback | None = None) -> Annealed:
    """Train a network to move the points of a start, and return the best points that it made with what judged them.

    The method of Message-Passing Monte Carlo (Rusch, Kirk, Bronstein, Lemieux, Rus 2024) with three changes: every set
    has a network of its own; the network says by how much to move a start, not where a point is; and the start is good:
    in the plane Kronecker points, else a scrambled Sobol set, which drifts by a noise that cools.  Graph, layers and
    loss are the paper's.

    Parameters
    ----------
    config : NetworkConfig
        Everything else that decides the result.
    rng : int, SeedSequence or Generator
        Draws the start, the first weights and the noise.
    callback : callable, optional
        Called as ``callback(step, steps, best)`` after every step; what it raises stops the training.

    Raises
    ------
    InvalidValue
        If the training diverges.
    """
    draws = generator(rng)
    objective = parse_objective(config.objective)
    starts = np.clip(_first_points(config, draws), INSET, 1.0 - INSET)
    network, graph = Network(config, draws), Graph.of(nearest(starts, config.k))
    spread = config.drift * noise_over_rate(objective, config.n, config.d) * first_rate(config.n, config.d)
    best_value, best_points = math.inf, starts
    for step in range(1, config.steps + 1):
        cooling = 0.5 * (1.0 + math.cos(math.pi * (step - 1) / config.steps))
        points = moved(starts, network.moves(starts, graph))
        value, columns = objective.of_columns(np.ascontiguousarray(points.T))
        if not (math.isfinite(value) and np.isfinite(columns).all()):
            raise InvalidValue(f"the objective '{objective}' is {value} at step {step}: the training has diverged")
        if np.abs(columns).max() > STEEPEST:
            raise InvalidValue(
                f"the network trains in single precision, and for n={config.n}, d={config.d} the slopes of"
                f" '{objective}' are beyond it: take fewer dimensions, or another sampler"
            )
        judged = star_discrepancy(points) if config.judge == "star" else value
        if judged < best_value:
            best_value, best_points = judged, points
        network.learn(columns.T * points * (1.0 - points), config.rate * cooling)
        if spread:
            drift = spread * cooling * draws.standard_normal(starts.shape)
            starts = np.clip(starts + drift, INSET, 1.0 - INSET)
        if callback is not None:
            callback(step, config.steps, best_value)
    best_points.setflags(write=False)
    return Annealed(best_points, best_value)


def _first_points(config: NetworkConfig, draws: np.random.Generator) -> Floats:
    if config.start == "kronecker":
        return kronecker(config.n, draws.random(config.d))
    assert config.start is not None  # the config has chosen
    return draw(config.start, config.n, config.d, rng=draws).points


def kronecker(n: int, shift: Floats) -> Floats:
    """Return the points ((i + s_0) / n, i g^-1 + s_1, ..., i g^-(d-1) + s_(d-1)) modulo 1, (n, d), s the `shift`.

    g^d = g + 1, in the plane the golden ratio (Roberts 2018).
    """
    d = shift.size
    g = 2.0
    for _ in range(60):
        g = (1.0 + g) ** (1.0 / d)
    i = np.arange(n)[:, np.newaxis]
    return np.hstack([(i + shift[0]) / n, (i * g ** -np.arange(1.0, d) + shift[1:]) % 1.0])


def moved(starts: Floats, moves: Floats) -> Floats:
    """Return the starts moved in the logit of their coordinates: they stay in the open cube, below 1 as float32 too."""
    odds = starts / (1.0 - starts) * np.exp(np.clip(moves, -40.0, 40.0))
    return np.clip(odds / (1.0 + odds), LOWEST, BELOW_ONE)


def refine(
    sets: Sequence[PointSet],
    objective: str | Objective | None = None,
    *,
    steps: int = 5000,
    callback: Callback | None = None,
) -> tuple[PointSet, ...]:
    """Anneal every set from where it is; none gets worse, since the best points seen are kept.

    It starts as hot as any annealing: a gentler start stays in the basin that the network found, and ends 20 %
    higher (d = 2, n = 64).

    Parameters
    ----------
    sets : sequence of PointSet
        With their origin: its seed and replica seed the noise, so that the same sets give the same result.  The method
        gets ``+annealed``.
    objective : str or Objective, optional
        What to make small; by default what each set was made for (InvalidValue if its origin does not say).
    steps, callback
        As for :func:`~evenroad.points.anneal.anneal`, the steps counted over all sets.
    """
    require_count("steps", steps)
    total = steps * len(sets)
    refined = []
    for index, points in enumerate(sets):
        origin = points.origin
        if objective is None and not origin.objective:
            raise InvalidValue(f"{points!r} was not made for an objective: say which one to refine for")
        target = parse_objective(origin.objective if objective is None else objective)
        report = None if callback is None else _counted(callback, index * steps, total)
        seeds = np.random.SeedSequence(origin.seed or 0, spawn_key=(origin.replica or 0, 0))
        annealed = anneal(points.n, points.d, target, steps=steps, rng=seeds, start=points.points, callback=report)
        made = Origin(family=origin.family, method=f"{origin.method}+annealed", objective=str(target))
        refined.append(PointSet(annealed.points, replace(made, seed=origin.seed, replica=origin.replica)))
    return tuple(refined)


def _counted(callback: Callback, before: int, total: int) -> Callback:
    return lambda step, steps, best: callback(before + step, total, best)
