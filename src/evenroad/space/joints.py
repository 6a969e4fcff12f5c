"""Spaces of independent axes: BoxSpace, bounded axes; Circle, an angle that wraps; JointSpace, joints of an arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import counted
from evenroad._native.space import row_distances
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_bounds, as_cube_batch, as_fractions, as_weights
from evenroad.space.flat import FlatMetric
from evenroad.space.protocol import Space

SLACK = 1e-5
"""Largest excess of a joint's value over its limit, as in values with five printed decimals [rad or m]."""


class FlatSpace(Space):
    """Base of the spaces whose axes are ranges, each bounded or wrapping; a subclass calls `_set_axes`.

    A wrapping axis accepts any number, and returns one in its half-open range ``[low, high)``.
    """

    _low: Floats
    _high: Floats
    _flat: FlatMetric

    def _set_axes(
        self, low: Sequence[float], high: Sequence[float], wrapping: Sequence[bool], weights: Sequence[float]
    ) -> None:
        lows, highs = np.array(low), np.array(high)
        period = np.where(wrapping, highs - lows, np.inf)
        set_fields(self, _low=lows, _high=highs, _flat=FlatMetric(np.array(weights), period))

    @property
    def dim(self) -> int:
        """Number of coordinates."""
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
        inside: Bools = np.logical_and.reduce(within | self._flat.wrapping, axis=1)
        return inside

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return ``sqrt(sum_k (weight_k difference_k)^2)``, shorter on wrapping axes: (n, dim) twice -> (n,)."""
        flat = self._flat
        if not flat.wraps and type(a) is type(b) is np.ndarray:
            try:
                return row_distances(a, b, flat.scale, flat.period)
            except InvalidValue:
                # The kernel accepts only sound arrays; `as_batch` reads or refuses all others.
                pass
        first, second = as_batch_pair(a, b, self.dim)
        return self._flat.distance(self._canonical(first), self._canonical(second))

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, dim) and (m, dim), as (n, m)."""
        first, second = as_batch("a", a, self.dim), as_batch("b", b, self.dim)
        return self._flat.all_distances(self._canonical(first), self._canonical(second))

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the points a fraction `t`, scalar or (n,) in [0, 1], of the short motion from `a` to `b`.

        It is exact at both endpoints, and never goes beyond them.  Between opposite values of a wrapping axis the
        motion does not cross the bounds of its range.
        """
        first, second = map(self._canonical, as_batch_pair(a, b, self.dim))
        fraction = as_fractions(t, len(first))
        between = first + fraction * self._flat.difference(first, second)
        bounded = ~self._flat.wrapping
        start, end = first[:, bounded], second[:, bounded]
        # This form, unlike a + t (b - a), is exact at both endpoints. It is clipped, because a = b can still round.
        straight = (1.0 - fraction) * start + fraction * end
        between[:, bounded] = np.clip(straight, np.minimum(start, end), np.maximum(start, end))
        return np.where(fraction == 1.0, second, self._canonical(between))

    def wrapped(self, q: Floats) -> Floats:
        """Return configurations with wrapping axes brought into their ranges.

        Parameters
        ----------
        q : array_like, shape (n, dim)

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> import evenroad as er
        >>> er.spaces.Circle().wrapped([(4.0,)]).round(3).tolist()
        [[-2.283]]
        """
        return self._canonical(as_batch("q", q, self.dim))

    def _canonical(self, q: Floats) -> Floats:
        """Do as `wrapped`, for a sound batch."""
        if not self._flat.wraps:
            return q
        # Values within their range are not rounded.
        outside = ((q < self._low) | (q >= self._high)) & self._flat.wrapping
        if not outside.any():
            return q
        wrapped = self._low + np.mod(q - self._low, self._high - self._low)
        return np.where(outside, np.where(wrapped < self._high, wrapped, self._low), q)


@explains_calls
@dataclass(frozen=True)
class BoxSpace(FlatSpace):
    """The box ``[low_1, high_1] x ... x [low_dim, high_dim]``; straight lines are its shortest paths.

    Parameters
    ----------
    low, high : sequences of dim floats
        ``low < high`` on every axis; stored as tuples.
    weights : sequence of dim floats, optional
        Weight of a unit of each axis in the metric, > 0; default 1.

    Raises
    ------
    InvalidValue
        If they are not such numbers.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.BoxSpace((-1, -1), (1, 1)).dim
    2
    """

    low: Sequence[float]
    high: Sequence[float]
    weights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        low, high = as_bounds(self.low, self.high)
        weights = as_weights(self.weights, len(low))
        set_fields(self, low=low, high=high, weights=weights)
        self._set_axes(low, high, (False,) * len(low), weights)


@explains_calls
@dataclass(frozen=True)
class Circle(FlatSpace):
    """The directions of the plane, SO(2), as (n, 1) angles in radians; the metric is the angle between two.

    Any angle is accepted; returned angles are in [-pi, pi).

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.Circle().distance([(3.0,)], [(-3.0,)]).round(3).tolist()
    [0.283]
    """

    def __post_init__(self) -> None:
        self._set_axes((-math.pi,), (math.pi,), (True,), (1.0,))


@explains_calls
@dataclass(frozen=True, repr=False)
class JointSpace(FlatSpace):
    """Bounded and wrapping joints in one vector, with the weighted Euclidean metric.

    A continuous joint wraps.  A joint with stops does not, even if its range exceeds a full turn: motions between the
    bounds of such a range are long.  A wrapping joint repeats after ``high - low``, so in radians these are 2 pi
    apart.  A value may exceed a bound by 1e-5.

    Parameters
    ----------
    low, high, weights
        As for :class:`BoxSpace`.
    wrapping : bool or sequence of dim bools
        Which joints wrap.

    Raises
    ------
    InvalidValue
        If they are not such values.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.JointSpace((-3, -3.14), (3, 3.14), wrapping=(False, True))
    JointSpace(2 joints, 1 wrapping)
    """

    low: Sequence[float]
    high: Sequence[float]
    wrapping: bool | Sequence[bool] = False
    weights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        low, high = as_bounds(self.low, self.high)
        wrapping = _as_bools(self.wrapping, len(low))
        weights = as_weights(self.weights, len(low))
        set_fields(self, low=low, high=high, wrapping=wrapping, weights=weights)
        self._set_axes(low, high, wrapping, weights)

    def __repr__(self) -> str:
        return f"JointSpace({counted(self.dim, 'joint')}, {int(self.flat.wrapping.sum())} wrapping)"

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, dim), whether bounded joints are within their bounds, up to 1e-5: (n,)."""
        batch = as_batch("q", q, self.dim)
        within = (self._low - SLACK <= batch) & (batch <= self._high + SLACK)
        inside: Bools = np.logical_and.reduce(within | self._flat.wrapping, axis=1)
        return inside


def _as_bools(wrapping: bool | Sequence[bool], length: int) -> tuple[bool, ...]:
    if isinstance(wrapping, bool | np.bool_):
        return (bool(wrapping),) * length
    row = tuple(wrapping) if np.iterable(wrapping) else ()
    if len(row) != length or not all(isinstance(entry, bool | np.bool_) for entry in row):
        raise InvalidValue(f"wrapping must be a bool or {length} of them, got {wrapping!r}")
    return tuple(map(bool, row))
