"""Random paths, rounded, and limits: what the tests of times along a path begin with."""

import numpy as np

from evenroad._native.trajectory import rounded
from evenroad.trajectory import Limits


def curve(seed, dim=4, points=6):
    rng = np.random.default_rng(seed)
    # Every other seed stops at some corners, and one corner is straight.
    deviation = np.where(rng.random(points) < 0.3 * (seed % 2), 0.0, 0.08)
    path = rng.uniform(-2.0, 2.0, (points, dim))
    path[2] = 0.5 * (path[1] + path[3])
    return path, rounded(path, deviation)


def limits_from(seed, dim=4):
    rng = np.random.default_rng(seed)
    along_path = 1.0 if seed % 3 == 0 else None
    return Limits(tuple(rng.uniform(0.5, 3.0, dim)), tuple(rng.uniform(1.0, 9.0, dim)), along_path=along_path)
