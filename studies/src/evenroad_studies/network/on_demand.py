"""A set of the network where the bank has none, made in some seconds when it is drawn."""

from __future__ import annotations

import numpy as np

from evenroad.points.anneal import anneal
from evenroad.points.measures import MEASURES
from evenroad.points.pointset import Origin, PointSet
from evenroad_studies.network.config import NetworkConfig
from evenroad_studies.network.train import train

STEPS, FEWEST_STEPS = 5000, 300
"""Most steps of a training, and fewest with which a set is made."""

POINT_STEPS, PAIR_STEPS = 1.2e6, 1.5e10
"""Points, of a network of width 32, and coordinates of pairs that all steps examine: about five seconds."""


def network_set(n: int, d: int, seeds: np.random.SeedSequence) -> PointSet | None:
    """Return a set of n points that a network made from these seeds; None where that takes more than some seconds."""
    if n == 1:
        # Nobody to send a message to.
        points, steps = anneal(1, d, MEASURES["hickernell"], steps=STEPS, rng=seeds).points, STEPS
        return PointSet(points, Origin(family="mpmc", method="annealed", objective="hickernell", steps=steps))
    share = (32 / NetworkConfig(n, d).channels) ** 2
    steps = min(STEPS, int(share * POINT_STEPS / n), int(PAIR_STEPS / (n * n * d)))
    if steps < FEWEST_STEPS:
        return None
    points = train(NetworkConfig(n, d, steps=steps), rng=seeds).points
    return PointSet(points, Origin(family="mpmc", method="network", objective="hickernell", steps=steps))
