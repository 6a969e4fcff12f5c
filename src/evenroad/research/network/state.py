"""A training between two steps: weights, moments and the best points so far; and one step further."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch

from evenroad.points.measures.l2 import Array
from evenroad.points.optimise.objective import Objective
from evenroad.research.network.config import NetworkConfig
from evenroad.research.network.graph import edges_of_sets
from evenroad.research.network.loss import objective_of_sets
from evenroad.research.network.model import PointNetwork, build_network


@dataclass(frozen=True, eq=False)
class MicroBatch:
    """Sets that go through the network together: ``first``, ``first + 1``, ... of all.

    Attributes
    ----------
    first : int
        Number of its first set.
    starts : Tensor of float32, shape (sets, n, d)
    sender, receiver : Tensor of int64, shape (m,)
    """

    first: int
    starts: torch.Tensor
    sender: torch.Tensor
    receiver: torch.Tensor


@dataclass(eq=False)
class TrainingState:
    """What changes during a training; all of it goes into a checkpoint.

    Attributes
    ----------
    network : PointNetwork
    optimiser : torch.optim.Adam
    best_points, best_values : ndarray, shapes (sets, n, d) and (sets,)
        Best of every set over all steps, and its objective; ``inf`` before the first step.
    best_mean : float
        Smallest mean of the objective over the sets at one step.
    step, last_improved : int
        Steps done, and the one with the best mean.
    """

    network: PointNetwork
    optimiser: torch.optim.Adam
    best_points: Array
    best_values: Array
    best_mean: float = math.inf
    step: int = 0
    last_improved: int = 0


def first_state(config: NetworkConfig, device: torch.device) -> tuple[TrainingState, tuple[MicroBatch, ...]]:
    """Draw the weights and the starts; return the state before the first step, and the starts in micro-batches."""
    for_starts, for_weights = np.random.SeedSequence(config.seed).spawn(2)
    starts = np.random.default_rng(for_starts).random((config.sets, config.n, config.d))
    network = build_network(config, np.random.default_rng(for_weights)).to(device)
    optimiser = torch.optim.Adam(network.parameters(), lr=config.rate, weight_decay=config.weight_decay)
    batches = []
    for first in range(0, config.sets, config.sets_at_once):
        own = starts[first : first + config.sets_at_once]
        edges = edges_of_sets(own, config.k, config.radius)
        tensors = (
            torch.from_numpy(array) for array in (own.astype(np.float32), edges.sender, edges.receiver)
        )
        batches.append(MicroBatch(first, *(tensor.to(device) for tensor in tensors)))
    state = TrainingState(network, optimiser, starts.copy(), np.full(config.sets, math.inf))
    return state, tuple(batches)


def advance(
    state: TrainingState, batches: tuple[MicroBatch, ...], config: NetworkConfig, objective: Objective
) -> None:
    """Do one step of Adam on the mean objective of all sets, taking note of the best points.

    The gradient is added up over the micro-batches, so only one of them is in memory at a time.
    """
    for group in state.optimiser.param_groups:
        group["lr"] = learning_rate(state.step + 1, config)
    state.optimiser.zero_grad()
    total = 0.0
    for batch in batches:
        points = state.network(batch.starts, batch.sender, batch.receiver)
        values = objective_of_sets(points, objective)
        (values.sum() / config.sets).backward()
        _take_note(state, batch.first, points.detach().cpu().numpy(), values.detach().cpu().numpy())
        total += float(values.detach().sum())
    state.optimiser.step()
    state.step += 1
    if total / config.sets < state.best_mean:
        state.best_mean = total / config.sets
        state.last_improved = state.step


def is_finished(state: TrainingState, config: NetworkConfig) -> bool:
    """Return whether all steps are done, or the mean has not improved for as long as the config allows."""
    waited = state.step - state.last_improved
    return state.step >= config.steps or (config.patience is not None and waited >= config.patience)


def learning_rate(step: int, config: NetworkConfig) -> float:
    """Return the rate of step 1 .. `steps`: from the config's rate towards 0 along a half cosine."""
    return config.rate * 0.5 * (1.0 + math.cos(math.pi * (step - 1) / config.steps))


def _take_note(state: TrainingState, first: int, points: Array, values: Array) -> None:
    for index, value in enumerate(values, start=first):
        if value < state.best_values[index]:
            state.best_values[index] = value
            state.best_points[index] = points[index - first]
