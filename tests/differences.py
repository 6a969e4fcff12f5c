"""Slopes by central differences, the oracle of every gradient."""

import numpy as np


def slopes(function, points, step=1e-6, places=None):
    """Return how fast a function of an array changes with each entry, or an array that is nan elsewhere."""
    gradient = np.full_like(points, np.nan)
    for place in np.ndindex(*points.shape) if places is None else places:
        up, down = points.copy(), points.copy()
        up[place] += step
        down[place] -= step
        gradient[place] = (function(up) - function(down)) / (2 * step)
    return gradient
