"""Flat metrics, Euclidean in scaled coordinates some of which may wrap, and the base of the spaces that have one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from evenroad._arrays import Bools, Floats
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions


@dataclass(frozen=True, eq=False)
class FlatMetric:
    """The metric ``sqrt(sum_k (scale_k wrap_k(b_k - a_k))^2)``: what a neighbour tree needs to know of a space.

    ``wrap_k(x)`` is `x` shifted by the multiple of ``period_k`` that brings it nearest to 0.

    Parameters
    ----------
    scale : array_like, shape (dim,)
        What a unit of each coordinate counts, finite and > 0.
    period : array_like, shape (dim,)
        After how much each coordinate repeats, > 0; ``inf`` where it does not.

    Raises
    ------
    InvalidValue
        If the two are not such arrays of one length >= 1.
    """

    scale: Floats
    period: Floats

    def __post_init__(self) -> None:
        for name in ("scale", "period"):
            try:
                array = np.array(getattr(self, name), dtype=np.float64)
            except (TypeError, ValueError):
                raise InvalidValue(f"{name} must be numbers, got {getattr(self, name)!r}") from None
            if array.ndim != 1 or array.size == 0 or not (array > 0.0).all():
                raise InvalidValue(f"{name} must be a row of numbers > 0, got {array!r}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not np.isfinite(self.scale).all():
            raise InvalidValue(f"scale must be finite, got {self.scale!r}")
        if len(self.scale) != len(self.period):
            raise InvalidValue(
                f"scale and period must have one length, got {len(self.scale)} and {len(self.period)}"
            )

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return len(self.scale)

    @property
    def wrapping(self) -> Bools:
        """Which coordinates wrap, (dim,)."""
        return np.isfinite(self.period)

    def difference(self, a: Floats, b: Floats) -> Floats:
        """Return ``b - a`` the short way round, not scaled, for two (n, dim) arrays as (n, dim).

        Opposite places of a wrapping coordinate keep the sign of ``b - a``, so that the motion between two of
        them is one and the same in both directions and, within one period, does not cross its ends.
        """
        difference = b - a
        for k in np.flatnonzero(self.wrapping):
            # rint takes one half to zero: exactly opposite places are left as they are.
            difference[:, k] -= self.period[k] * np.rint(difference[:, k] / self.period[k])
        return difference

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of the rows of two float64 arrays, (n, dim), as (n,)."""
        scaled = self.difference(a, b) * self.scale
        # Column by column: the sum of a row then never depends on how long the batch is, nor does it overflow.
        total = np.abs(scaled[:, 0])
        for k in range(1, self.dim):
            total = np.hypot(total, scaled[:, k])
        return total

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows of two float64 arrays, (n, dim) and (m, dim), as (n, m)."""
        return _all_distances(np.ascontiguousarray(a), np.ascontiguousarray(b), self.scale, self.period)


@njit(cache=True, nogil=True)
def _all_distances(a, b, scale, period):  # type: ignore[no-untyped-def]
    distances = np.empty((len(a), len(b)))
    for i in range(len(a)):
        for j in range(len(b)):
            squares = 0.0
            for k in range(len(scale)):
                difference = b[j, k] - a[i, k]
                if period[k] != np.inf:
                    difference -= period[k] * np.rint(difference / period[k])
                squares += (scale[k] * difference) ** 2
            distances[i, j] = np.sqrt(squares)
    return distances


class FlatSpace:
    """Base of the spaces whose axes are ranges, each bounded or wrapping; a subclass calls `_set_axes`.

    A wrapping axis takes any number and gives one in its half-open range ``[low, high)``.
    """

    _low: Floats
    _high: Floats
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

    def from_cube(self, u: Floats) -> Floats:
        """Return ``low + u (high - low)`` for `u` of shape (n, dim) in [0, 1]^dim, as (n, dim)."""
        unit = as_cube_batch(u, self.dim)
        # Rounding may carry a point past the upper bound.
        return self._canonical(np.minimum(self._low + unit * (self._high - self._low), self._high))

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, dim), whether its bounded axes are within their bounds: (n,)."""
        batch = as_batch("q", q, self.dim)
        within = (self._low <= batch) & (batch <= self._high)
        return np.logical_and.reduce(within | self._flat.wrapping, axis=1)

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return ``sqrt(sum_k (weight_k difference_k)^2)`` for two (n, dim) arrays as (n,).

        The difference on a wrapping axis is taken the short way round.
        """
        first, second = as_batch_pair(a, b, self.dim)
        return self._flat.distance(self._canonical(first), self._canonical(second))

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, dim) and (m, dim), as (n, m)."""
        first, second = as_batch("a", a, self.dim), as_batch("b", b, self.dim)
        return self._flat.all_distances(self._canonical(first), self._canonical(second))

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the points a fraction `t`, scalar or (n,) in [0, 1], of the short motion from `a` to `b`.

        Exact at both ends and never beyond them.  Of the two motions between opposite places of a wrapping
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

    def _canonical(self, q: Floats) -> Floats:
        """Return `q` with wrapping axes brought into their ranges; what is there already is not rounded."""
        outside = ((q < self._low) | (q >= self._high)) & self._flat.wrapping
        if not outside.any():
            return q
        period = self._high - self._low
        wrapped = self._low + np.mod(q - self._low, period)
        return np.where(outside, np.where(wrapped < self._high, wrapped, self._low), q)
