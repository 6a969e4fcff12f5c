"""FlatSpace: what boxes, circles and joint spaces have in common, a range on each axis and a flat metric."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions
from evenroad.space.flat import FlatMetric


class FlatSpace:
    """Base of the spaces whose axes are ranges, each bounded or wrapping; a subclass calls `_set_axes`.

    A wrapping axis takes any number and gives one in its half-open range ``[low, high)``.
    """

    _low: npt.NDArray[np.float64]
    _high: npt.NDArray[np.float64]
    _flat: FlatMetric

    def _set_axes(
        self,
        low: tuple[float, ...],
        high: tuple[float, ...],
        wrapping: tuple[bool, ...],
        weights: tuple[float, ...],
    ) -> None:
        lows, highs = np.array(low), np.array(high)
        period = np.where(wrapping, highs - lows, np.inf)
        # The subclasses are frozen; this runs while they are made.
        object.__setattr__(self, "_low", lows)
        object.__setattr__(self, "_high", highs)
        object.__setattr__(self, "_flat", FlatMetric(np.array(weights), period))

    @property
    def dim(self) -> int:
        """Number of coordinates of a configuration."""
        return self._flat.dim

    @property
    def cube_dim(self) -> int:
        """Number of coordinates of a point of the cube: that of a configuration."""
        return self._flat.dim

    @property
    def flat(self) -> FlatMetric:
        """The metric as scales and periods of the coordinates."""
        return self._flat

    def from_cube(self, u: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return ``low + u (high - low)`` for `u` of shape (n, dim) in [0, 1]^dim, as (n, dim)."""
        unit = as_cube_batch(u, self.dim)
        # Rounding may carry a point past the upper bound.
        return self._canonical(np.minimum(self._low + unit * (self._high - self._low), self._high))

    def contains(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return for each row of `q`, (n, dim), whether its bounded axes are within their bounds: (n,)."""
        batch = as_batch("q", q, self.dim)
        within = (self._low <= batch) & (batch <= self._high)
        return np.logical_and.reduce(within | self._flat.wrapping, axis=1)

    def distance(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return ``sqrt(sum_k (weight_k difference_k)^2)`` for two (n, dim) arrays as (n,).

        The difference on a wrapping axis is taken the short way round.
        """
        first, second = as_batch_pair(a, b, self.dim)
        return self._flat.distance(self._canonical(first), self._canonical(second))

    def all_distances(
        self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]
    ) -> npt.NDArray[np.float64]:
        """Return the distances of all pairs of rows, (n, dim) and (m, dim), as (n, m)."""
        first, second = as_batch("a", a, self.dim), as_batch("b", b, self.dim)
        return self._flat.all_distances(self._canonical(first), self._canonical(second))

    def interpolate(
        self,
        a: npt.NDArray[np.float64],
        b: npt.NDArray[np.float64],
        t: npt.NDArray[np.float64] | float,
    ) -> npt.NDArray[np.float64]:
        """Return the points a fraction `t`, scalar or (n,) in [0, 1], of the short way from `a` to `b`.

        Exact at both ends and never beyond them.  Of the two ways between opposite places of a wrapping
        axis, the one that does not cross the ends of its range is taken, in either direction.
        """
        first, second = as_batch_pair(a, b, self.dim)
        first, second = self._canonical(first), self._canonical(second)
        fraction = as_fractions(t, len(first))
        between = first + fraction * self._flat.difference(first, second)
        bounded = ~self._flat.wrapping
        # This form, unlike a + t (b - a), is exact at both ends; clipped, since a = b can still round.
        straight = (1.0 - fraction) * first[:, bounded] + fraction * second[:, bounded]
        between[:, bounded] = np.clip(
            straight,
            np.minimum(first[:, bounded], second[:, bounded]),
            np.maximum(first[:, bounded], second[:, bounded]),
        )
        return np.where(fraction == 1.0, second, self._canonical(between))

    def _canonical(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return `q` with wrapping axes brought into their ranges; what is there already is not rounded."""
        outside = ((q < self._low) | (q >= self._high)) & self._flat.wrapping
        if not outside.any():
            return q
        period = self._high - self._low
        wrapped = self._low + np.mod(q - self._low, period)
        return np.where(outside, np.where(wrapped < self._high, wrapped, self._low), q)
