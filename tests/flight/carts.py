"""Upright cylinders that drive about between a start and a goal of a flight."""

import numpy as np

import evenroad as er
from evenroad.flight import FlightWorld

START, GOAL = er.State((0, 0, 2)), er.State((12, 0, 2))


def crossing(seed, n=25, radius=0.25):
    """Upright cylinders that drive about between start and goal, and their middles and velocities, (n, 2)."""
    rng = np.random.default_rng(seed)
    at, to = rng.uniform((2, -4), (10, 4), (n, 2)), rng.uniform(-2, 2, (n, 2))
    to[::3] = 0.0
    trunks = [er.Cylinder(0.2, 6.0, xyz=(x, y, 2), name=f"cart {k}") for k, (x, y) in enumerate(at.tolist())]
    velocities = {f"cart {k}": (*each, 0.0) for k, each in enumerate(to.tolist())}
    world = FlightWorld(
        er.Scene(trunks), radius, speed=6.0, acceleration=8.0, bounds=[(-1, 13), (-5, 5), (1, 3)], velocities=velocities
    )
    return world, at, to
