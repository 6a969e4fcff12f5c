"""Streams of random instances: what sets a difficulty, what chooses a default and what is reported never meet."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

ENTROPY = 20_261_121
"""Root of every instance of the fair suite; the seed of a suite draws sets, never worlds."""


class Stream(IntEnum):
    """What instances are for; part of their seed, so that two streams share none."""

    CALIBRATION = 0
    TUNING = 1
    REPORTING = 2


PREFIX = {Stream.TUNING: "tune", Stream.REPORTING: "fair"}
"""Stream -> how the names of its problems begin; the calibration's instances are no problems."""


class Family(IntEnum):
    """Kinds of random worlds; the number is part of the seed."""

    BALLS = 0
    BOXES = 1
    MAZE = 2
    SE2 = 3
    SE3 = 4


def instance_rng(
    stream: Stream, family: Family, d: int, difficulty: int, instance: int
) -> np.random.Generator:
    """Return the generator of one instance: the same numbers in every process, others for every other instance."""
    key = (int(stream), int(family), d, difficulty, instance)
    return np.random.default_rng(np.random.SeedSequence(ENTROPY, spawn_key=key))
