"""Worlds for tests of searches: verdicts by chance, and a count of what was asked; and costs by Bellman and Ford."""

import numpy as np

from evenroad.space import Rectangle


def costs_from(source, n, edges, lengths):
    """Return the cost of the cheapest path from a node to each of n nodes, by relaxing all edges n times."""
    cost = np.full(n, np.inf)
    cost[source] = 0.0
    for _ in range(n):
        for (i, j), length in zip(edges, lengths, strict=True):
            cost[i], cost[j] = min(cost[i], cost[j] + length), min(cost[j], cost[i] + length)
    return cost


class ChanceWorld:
    """The unit square, where the verdict on each configuration and motion is drawn by a hash of itself."""

    space = Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))

    def __init__(self, seed, free_configurations=1.0, free_motions=0.7):
        self.seed, self.free_configurations, self.free_motions = seed, free_configurations, free_motions
        self.asked_configurations = self.asked_motions = 0

    def valid(self, q):
        self.asked_configurations += len(q)
        return self._are_valid(q)

    def motion_valid(self, a, b):
        self.asked_motions += len(a)
        # A sum, so that a motion and its reverse have one verdict.
        chances = _mixed(self._keys(a) + self._keys(b)) / 2.0**64
        return self._are_valid(a) & self._are_valid(b) & (chances < self.free_motions)

    def _are_valid(self, q):
        # The corners are where the tests start and end.
        corners = np.isin(q, (0.0, 1.0)).all(axis=1)
        return corners | (self._keys(q) / 2.0**64 < self.free_configurations)

    def _keys(self, q):
        keys = np.full(len(q), self.seed, dtype=np.uint64)
        for bits in (np.asarray(q, dtype=float) + 0.0).T.copy().view(np.uint64):
            keys = _mixed(keys + bits)
        return keys


def _mixed(keys):
    """SplitMix64: 64 bits, each of which depends on all that went in."""
    keys = keys + np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1)):
        keys = (keys ^ (keys >> np.uint64(shift))) * np.uint64(factor)
    return keys
