"""JointSpace: the joints of an arm, each bounded or wrapping."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evenroad.errors import InvalidValue
from evenroad.space.axes import as_bounds, as_weights
from evenroad.space.flat_space import FlatSpace


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
