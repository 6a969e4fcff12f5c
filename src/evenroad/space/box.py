"""Box: a range on each axis, with the (weighted) Euclidean metric."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from evenroad.space.axes import as_bounds, as_weights
from evenroad.space.flat_space import FlatSpace


@dataclass(frozen=True)
class Box(FlatSpace):
    """The box ``[low_1, high_1] x ... x [low_dim, high_dim]``; straight lines are its shortest ways.

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
