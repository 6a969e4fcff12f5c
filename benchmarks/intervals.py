"""Intervals for success rates."""

from math import sqrt


def wilson(successes: float, runs: float, z: float = 1.959964) -> tuple[float, float]:
    """Return the 95 % interval of a success rate (Wilson 1927, equation 4 with his z = lambda)."""
    rate = successes / runs
    centre = (rate + z * z / (2 * runs)) / (1 + z * z / runs)
    half = z / (1 + z * z / runs) * sqrt(rate * (1 - rate) / runs + z * z / (4 * runs * runs))
    return max(0.0, centre - half), min(1.0, centre + half)
