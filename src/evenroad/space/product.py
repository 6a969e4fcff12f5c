"""Product: spaces side by side, as one space; among them the poses of rigid bodies, SE2 and SE3."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad._checks import require_known
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions, as_weights
from evenroad.space.flat import FlatMetric
from evenroad.space.joints import Box, Circle
from evenroad.space.protocol import Space, all_distances
from evenroad.space.so3 import SO3

_COMBINATIONS = ("sum", "l2")


@dataclass(frozen=True)
class Product:
    """The space of tuples of one configuration from each part, their coordinates one after the other.

    A shortest path of the product is a shortest path in every part at once, each at its own even speed.

    Parameters
    ----------
    parts : sequence of Space
        At least one; stored as a tuple.
    weights : sequence of floats, one a part, optional
        What a unit of each part's distance counts, > 0; 1 by default.
    combine : {"sum", "l2"}
        The distance: ``sum_i w_i d_i``, or ``sqrt(sum_i (w_i d_i)^2)``.

    Raises
    ------
    InvalidValue
        If there are no parts, or the weights are not such numbers.
    UnknownName
        If `combine` is neither.
    """

    parts: Sequence[Space]
    weights: Sequence[float] | None = None
    combine: Literal["sum", "l2"] = "sum"
    _flat: FlatMetric | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        parts = tuple(self.parts)
        if not parts:
            raise InvalidValue("parts must be one space or more, got none")
        require_known("combination", self.combine, _COMBINATIONS)
        weights = as_weights(self.weights, len(parts))
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "weights", weights)
        object.__setattr__(self, "_flat", _flat_product(parts, weights, self.combine))

    @property
    def dim(self) -> int:
        """Number of coordinates of a configuration: those of all parts."""
        return sum(part.dim for part in self.parts)

    @property
    def cube_dim(self) -> int:
        """Number of coordinates of a point of the cube: those of all parts."""
        return sum(part.cube_dim for part in self.parts)

    @property
    def flat(self) -> FlatMetric | None:
        """The metric as scales and periods, where every part has one and ``combine`` is "l2"; else None."""
        return self._flat

    def from_cube(self, u: Floats) -> Floats:
        """Map `u`, (n, cube_dim), to configurations, (n, dim), each part from its own columns."""
        columns = _split(as_cube_batch(u, self.cube_dim), [part.cube_dim for part in self.parts])
        return np.hstack([part.from_cube(own) for part, own in zip(self.parts, columns, strict=True)])

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, dim), whether every part contains its own coordinates: (n,)."""
        columns = self.split(as_batch("q", q, self.dim))
        return np.all([part.contains(own) for part, own in zip(self.parts, columns, strict=True)], axis=0)

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the combined, weighted distances of the rows of two (n, dim) arrays, (n,)."""
        assert self.weights is not None  # __post_init__ put numbers there
        lengths = [w * own for w, own in zip(self.weights, self.part_distances(a, b), strict=True)]
        total = lengths[0]
        for length in lengths[1:]:
            total = total + length if self.combine == "sum" else np.hypot(total, length)
        return total

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, dim) and (m, dim), as (n, m)."""
        assert self.weights is not None  # __post_init__ put numbers there
        first, second = self.split(as_batch("a", a, self.dim)), self.split(as_batch("b", b, self.dim))
        total = np.zeros((len(a), len(b)))
        for part, weight, own_first, own_second in zip(self.parts, self.weights, first, second, strict=True):
            length = weight * all_distances(part, own_first, own_second)
            total = total + length if self.combine == "sum" else np.hypot(total, length)
        return total

    def part_distances(self, a: Floats, b: Floats) -> list[Floats]:
        """Return for every part the distances in its own metric, without weights, each (n,)."""
        first, second = as_batch_pair(a, b, self.dim)
        return [
            part.distance(own_first, own_second)
            for part, own_first, own_second in zip(
                self.parts, self.split(first), self.split(second), strict=True
            )
        ]

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the points a fraction `t`, scalar or (n,) in [0, 1], of the motion in every part, (n, dim)."""
        first, second = as_batch_pair(a, b, self.dim)
        fraction = as_fractions(t, len(first))[:, 0]
        return np.hstack(
            [
                part.interpolate(own_first, own_second, fraction)
                for part, own_first, own_second in zip(
                    self.parts, self.split(first), self.split(second), strict=True
                )
            ]
        )

    def split(self, q: Floats) -> list[Floats]:
        """Return the columns of `q`, (n, dim), that belong to each part."""
        return _split(q, [part.dim for part in self.parts])


def _split(q: Floats, widths: list[int]) -> list[Floats]:
    return np.split(q, np.cumsum(widths)[:-1], axis=1)


def _flat_product(parts: Sequence[Space], weights: Sequence[float], combine: str) -> FlatMetric | None:
    metrics = [part.flat for part in parts]
    if combine != "l2" and len(metrics) > 1:
        return None
    flat = [metric for metric in metrics if metric is not None]
    if len(flat) < len(metrics):
        return None
    return FlatMetric(
        scale=np.concatenate([weight * metric.scale for weight, metric in zip(weights, flat, strict=True)]),
        period=np.concatenate([metric.period for metric in flat]),
    )


def SE2(
    low: Sequence[float],
    high: Sequence[float],
    *,
    weights: Sequence[float] = (1.0, 1.0),
    combine: Literal["sum", "l2"] = "l2",
) -> Product:
    """Return the poses (x, y, heading) of a body in the plane.

    Parameters
    ----------
    low, high : sequence of two floats
        Bounds of the position.
    weights : sequence of two floats
        What a unit of length and a radian count, > 0.
    combine : {"sum", "l2"}
        How the two distances make one; with "l2" the metric is flat, so that neighbours are found in a tree.

    Raises
    ------
    InvalidValue, UnknownName
        As `Box` and `Product`.
    """
    return Product((_position(low, high, 2), Circle()), weights, combine)


def SE3(
    low: Sequence[float],
    high: Sequence[float],
    *,
    weights: Sequence[float] = (1.0, 1.0),
    combine: Literal["sum", "l2"] = "sum",
) -> Product:
    """Return the poses (x, y, z, qw, qx, qy, qz) of a body in space; points of the cube have 6 coordinates.

    Parameters and errors as :func:`SE2`, with three bounds.  A radian is one of ``arccos |q . q'|``; "sum" is OMPL's.
    """
    return Product((_position(low, high, 3), SO3()), weights, combine)


def _position(low: Sequence[float], high: Sequence[float], dim: int) -> Box:
    box = Box(low, high)
    if box.dim != dim:
        raise InvalidValue(f"low and high must have {dim} numbers, got {low!r} and {high!r}")
    return box
