"""Worlds for tests of searches: verdicts by chance, and a count of what was asked."""

import hashlib

import numpy as np

from evenroad.space import Rectangle


class ChanceWorld:
    """The unit square, where the verdict on each configuration and motion is drawn by a hash of itself."""

    space = Rectangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))

    def __init__(self, seed, free_configurations=1.0, free_motions=0.7):
        self.seed, self.free_configurations, self.free_motions = seed, free_configurations, free_motions
        self.asked_configurations = self.asked_motions = 0

    def _chance(self, *rows):
        text = repr((self.seed, sorted(tuple(row.tolist()) for row in rows))).encode()
        return int.from_bytes(hashlib.blake2b(text, digest_size=4).digest(), "big") / 2**32

    def valid(self, q):
        self.asked_configurations += len(q)
        return np.array([self._is_valid(row) for row in q], dtype=bool)

    def _is_valid(self, row):
        # The corners are where the tests start and end.
        return bool(np.isin(row, (0.0, 1.0)).all()) or self._chance(row) < self.free_configurations

    def motion_valid(self, a, b):
        self.asked_motions += len(a)
        return np.array(
            [
                self._is_valid(x) and self._is_valid(y) and self._chance(x, y) < self.free_motions
                for x, y in zip(a, b, strict=True)
            ],
            dtype=bool,
        )
