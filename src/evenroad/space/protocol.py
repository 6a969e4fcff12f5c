"""Space: the interface to a set of configurations that planners use."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.space.batch import as_batch
from evenroad.space.flat import FlatMetric


class Space(Protocol):
    """A set of configurations with a metric, and a map onto it from the unit cube, batch-first.

    Implementations never write to their arguments and raise InvalidValue for a wrong shape or an entry that is not
    finite.  A class that inherits from Space must only write `dim`, `from_cube`, `distance` and `interpolate`.
    ``evenroad.testing.SpaceContract`` checks an implementation.
    """

    @property
    def dim(self) -> int:
        """Number of coordinates of a configuration."""

    @property
    def cube_dim(self) -> int:
        """Number of coordinates of a point of the cube; less than `dim` if configurations have redundant numbers."""
        return self.dim

    @property
    def flat(self) -> FlatMetric | None:
        """The metric as scales and periods of the coordinates, or None if it is not flat."""
        return None

    @property
    def period(self) -> Floats | None:
        """The period of each coordinate, (dim,), infinite if it does not repeat; None if not known."""
        return None if self.flat is None else self.flat.period

    @property
    def is_directed(self) -> bool:
        """Whether the motion from `b` to `a` may be another one than that from `a` to `b`, reversed."""
        return False

    def from_cube(self, u: Floats) -> Floats:
        """Map points of the unit cube to configurations, preserving measure.

        Parameters
        ----------
        u : array_like, shape (n, cube_dim)
            In [0, 1].

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.from_cube([(0.5, 0.5, 0.5)]).tolist()
        [[0.0, 0.0, 0.0]]
        """

    def contains(self, q: Floats) -> Bools:
        """Return which configurations lie in the space, bounds included.

        Parameters
        ----------
        q : array_like, shape (n, dim)

        Returns
        -------
        bool ndarray, shape (n,)

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.contains([(0, 0, 0), (6, 0, 0)]).tolist()
        [True, False]
        """
        return np.ones(len(as_batch("q", q, self.dim)), dtype=np.bool_)

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the distance of each row of `a` from the same row of `b`.

        Parameters
        ----------
        a, b : array_like, shape (n, dim)

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        InvalidValue
            If a batch has another shape, or a row is no configuration.

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.distance([(0, 0, 0)], [(3, 4, 0)]).tolist()
        [5.0]
        """

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return configurations on the shortest motions from `a` to `b`; exact at both endpoints.

        Parameters
        ----------
        a, b : array_like, shape (n, dim)
        t : float or array_like, shape (n,)
            Fraction of the motion, in [0, 1].

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.interpolate([(0, 0, 0)], [(3, 4, 0)], 0.5).tolist()
        [[1.5, 2.0, 0.0]]
        """

    def wrapped(self, q: Floats) -> Floats:
        """Return configurations with coordinates that repeat brought into their ranges.

        Parameters
        ----------
        q : array_like, shape (n, dim)

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.wrapped([(1, 2, 4)]).round(3).tolist()
        [[1.0, 2.0, -2.283]]
        """
        return as_batch("q", q, self.dim)

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distance of every row of `a` from every row of `b`; some spaces have a fast method.

        Parameters
        ----------
        a, b : ndarrays, shapes (n, dim) and (m, dim)

        Returns
        -------
        ndarray, shape (n, m)

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> space.all_distances(np.zeros((2, 3)), np.ones((4, 3))).shape
        (2, 4)
        """
        pairs = np.repeat(a, len(b), axis=0), np.tile(b, (len(a), 1))
        return self.distance(*pairs).reshape(len(a), len(b))


def all_distances(space: Space, a: Floats, b: Floats) -> Floats:
    """Return the distances of all pairs of rows, also for a space that does not inherit from Space."""
    own = getattr(space, "all_distances", None)
    return Space.all_distances(space, a, b) if own is None else own(a, b)


def period_of(space: Space) -> Floats | None:
    """Return the periods of coordinates, also for a space that does not inherit from Space; None if not known."""
    flat = getattr(space, "flat", None)
    own: Floats | None = getattr(space, "period", None) if flat is None else flat.period
    return own


def is_directed(space: Space) -> bool:
    """Return whether motions of a space differ from their reverse, also of one that does not inherit from Space."""
    return bool(getattr(space, "is_directed", False))


def wrapped(space: Space, q: Floats) -> Floats:
    """Return configurations with coordinates in their ranges, also for a space that does not inherit from Space."""
    own = getattr(space, "wrapped", None)
    return q if own is None else own(q)
