"""Space: what a planner needs to know about the configurations of a robot."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.space.batch import as_batch
from evenroad.space.flat import FlatMetric


class Space(Protocol):
    """A set of configurations with a metric, and a map onto it from the unit cube, batch-first.

    Implementations never write to their arguments and raise InvalidValue for a wrong shape or an entry that is not
    finite.  A class that inherits from Space needs to write `dim`, `from_cube`, `distance` and `interpolate` only;
    ``evenroad.testing.SpaceContract`` checks the rest.
    """

    @property
    def dim(self) -> int:
        """Number of coordinates of a configuration."""

    @property
    def cube_dim(self) -> int:
        """Number of coordinates of a point of the cube; not `dim` where that has redundant numbers."""
        return self.dim

    @property
    def flat(self) -> FlatMetric | None:
        """The metric as scales and periods of the coordinates, or None where it is not of that kind."""
        return None

    def from_cube(self, u: Floats) -> Floats:
        """Map points of the unit cube, (n, cube_dim), to configurations, (n, dim), preserving measure."""

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, dim), whether it lies in the space, bounds included: (n,)."""
        return np.ones(len(as_batch("q", q, self.dim)), dtype=np.bool_)

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the distance of each row of `a` from the same row of `b`: two (n, dim) arrays -> (n,)."""

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the points a fraction `t` (scalar or (n,), in [0, 1]) from `a` to `b`, (n, dim)."""


def all_distances(space: Space, a: Floats, b: Floats) -> Floats:
    """Return the distance of every row of `a`, (n, dim), from every row of `b`, (m, dim), as (n, m).

    Faster where the space has an ``all_distances(a, b)`` of its own; the same up to rounding.
    """
    own = getattr(space, "all_distances", None)
    if own is not None:
        return own(a, b)
    pairs = np.repeat(a, len(b), axis=0), np.tile(b, (len(a), 1))
    return space.distance(*pairs).reshape(len(a), len(b))
