"""Spaces of numbers side by side: Box, bounded axes; Circle, one angle that wraps; JointSpace, the joints of an arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.space.batch import as_bounds, as_weights
from evenroad.space.flat import FlatSpace


@dataclass(frozen=True)
class Box(FlatSpace):
    """The box ``[low_1, high_1] x ... x [low_dim, high_dim]``; straight lines are its shortest paths.

    Parameters
    ----------
    low, high : sequence of floats, length dim
        The bounds, ``low < high`` on every axis; stored as tuples.
    weights : sequence of floats, length dim, optional
        What a unit of each axis counts in the metric, > 0; 1 by default.

    Raises
    ------
    InvalidValue
        If the bounds or weights are not such numbers.
    """

    low: Sequence[float]
    high: Sequence[float]
    weights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        low, high = as_bounds(self.low, self.high)
        weights = as_weights(self.weights, len(low))
        for name, value in (("low", low), ("high", high), ("weights", weights)):
            object.__setattr__(self, name, value)
        self._set_axes(low, high, (False,) * len(low), weights)


@dataclass(frozen=True)
class Circle(FlatSpace):
    """The directions of the plane, SO(2), as (n, 1) angles in radians; the metric is the angle between two.

    Any angle is taken; given back are angles in [-pi, pi).
    """

    def __post_init__(self) -> None:
        self._set_axes((-math.pi,), (math.pi,), (True,), (1.0,))


@dataclass(frozen=True)
class JointSpace(FlatSpace):
    """Bounded and wrapping joints in one vector, with the weighted Euclidean metric.

    A revolute joint that can turn on and on wraps; one with stops does not, even where its range exceeds a
    full turn: the two ends of such a range are far apart.

    Parameters
    ----------
    low, high : sequence of floats, length dim
        The ranges, ``low < high``; a wrapping joint repeats after ``high - low``, so in radians they are
        2 pi apart.  Stored as tuples.
    wrapping : bool or sequence of bools, length dim
        Which joints wrap; one bool stands for all.
    weights : sequence of floats, length dim, optional
        What a unit of each joint counts in the metric, > 0; 1 by default.

    Raises
    ------
    InvalidValue
        If the ranges, `wrapping` or `weights` are not such values.
    """

    low: Sequence[float]
    high: Sequence[float]
    wrapping: bool | Sequence[bool] = False
    weights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        low, high = as_bounds(self.low, self.high)
        wrapping = _as_bools(self.wrapping, len(low))
        weights = as_weights(self.weights, len(low))
        for name, value in (("low", low), ("high", high), ("wrapping", wrapping), ("weights", weights)):
            object.__setattr__(self, name, value)
        self._set_axes(low, high, wrapping, weights)


def _as_bools(wrapping: bool | Sequence[bool], length: int) -> tuple[bool, ...]:
    if isinstance(wrapping, bool | np.bool_):
        return (bool(wrapping),) * length
    try:
        row = tuple(wrapping)
    except TypeError:
        row = ()
    if len(row) != length or not all(isinstance(entry, bool | np.bool_) for entry in row):
        raise InvalidValue(f"wrapping must be a bool or {length} of them, got {wrapping!r}")
    return tuple(map(bool, row))
