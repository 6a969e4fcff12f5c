"""Spaces for tests: one that wraps, and one whose metric is not flat."""

import numpy as np

from evenroad.space import Space
from evenroad.space.flat import FlatMetric


class Torus(Space):
    """The unit cube with all faces glued, or with sides and periods of other lengths."""

    def __init__(self, d, scale=None, period=None):
        self.d = d
        self.metric = FlatMetric(np.ones(d) if scale is None else scale, np.ones(d) if period is None else period)

    @property
    def dim(self):
        return self.d

    @property
    def flat(self):
        return self.metric

    def from_cube(self, u):
        return u * np.where(np.isfinite(self.metric.period), self.metric.period, 1.0)

    def distance(self, a, b):
        return self.metric.distance(a, b)

    def interpolate(self, a, b, t):
        return a + np.reshape(t, (-1, 1)) * self.metric.difference(a, b)


class Great(Space):
    """The plane with a metric that is not flat, and nothing but what a space must have."""

    @property
    def dim(self):
        return 2

    def from_cube(self, u):
        return np.array(u)

    def distance(self, a, b):
        return np.sqrt(np.abs(a - b)).sum(axis=1)

    def interpolate(self, a, b, t):
        return a + np.reshape(t, (-1, 1)) * (b - a)
