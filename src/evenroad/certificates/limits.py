"""Limits that a certificate claims of a trajectory: joints are no faster, and change their velocity no faster."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats
from evenroad.trajectory.trajectory import Trajectory


def strays_of(states: Floats) -> float:
    """Return how far the spline of which limits hold is from the straight motions between states at most."""
    return float(np.linalg.norm(np.diff(states, 2, axis=0), axis=1).max(initial=0.0)) / 8.0


def kept_limits(trajectory: Trajectory) -> dict[str, tuple[float, float]]:
    """Return the limits of velocity and acceleration of joints that a checker finds kept, joint -> both.

    They hold of the spline of degree 2 in time whose control points are the states, the first and last ones twice.
    """
    steps = np.diff(trajectory.times)
    # A checker takes steps as equal up to 1e-6 of them.
    if not len(steps) or not steps.max() <= (1.0 + 5e-7) * steps.min():
        return {}
    step = float(steps.min())
    velocity = np.diff(trajectory.positions[[0, *range(len(trajectory.times)), -1]], axis=0) / step
    fastest, hardest = np.abs(velocity).max(axis=0), np.abs(np.diff(velocity, axis=0)).max(axis=0) / step
    limits, found = trajectory.limits, {}
    accelerations = np.maximum(limits.acceleration, limits.stopping)
    for i, name in enumerate(trajectory.names):
        fast, hard = float(limits.velocity[i]), float(accelerations[i])
        if fastest[i] <= fast + 1e-7 and hardest[i] <= hard + 1e-7:
            found[name] = fast, hard
    return found
