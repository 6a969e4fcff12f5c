"""Rectangle: a rectangle in the plane, possibly rotated, with the Euclidean metric."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import as_row
from evenroad.errors import InvalidValue
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions
from evenroad.space.flat import FlatMetric
from evenroad.space.protocol import Space

_LARGEST_COSINE = 1e-9
"""Largest cosine between perpendicular edges. It allows for the rounding of a yaw, not for a slanted frame."""
_ROUNDING = 1e-9
"""Share of an edge by which a point may be outside. It allows for rounding in a frame far from the origin."""


_EUCLIDEAN = FlatMetric(scale=np.ones(2), period=np.full(2, np.inf))


@dataclass(frozen=True)
class Rectangle(Space):
    """The rectangle ``corner + s * edge_u + t * edge_v`` for s, t in [0, 1]; the cube's origin goes to `corner`.

    Parameters
    ----------
    corner, edge_u, edge_v : pairs of floats
        The edges are perpendicular.

    Raises
    ------
    InvalidValue
        If an entry is not a finite number, an edge has length zero, or the edges are not perpendicular.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.Rectangle((0, 0), (3, 0), (0, 2)).area
    6.0
    """

    corner: tuple[float, float]
    edge_u: tuple[float, float]
    edge_v: tuple[float, float]

    def __post_init__(self) -> None:
        for name in ("corner", "edge_u", "edge_v"):
            set_fields(self, **{name: as_row(name, getattr(self, name), 2)})
        lengths = math.hypot(*self.edge_u), math.hypot(*self.edge_v)
        got = f"got {self.edge_u} and {self.edge_v}"
        if min(lengths) == 0.0 or not math.isfinite(lengths[0] * lengths[1]):
            raise InvalidValue(f"edge_u and edge_v must have a finite length > 0, {got}")
        cosine = sum(u / lengths[0] * (v / lengths[1]) for u, v in zip(self.edge_u, self.edge_v, strict=True))
        if abs(cosine) > _LARGEST_COSINE:
            raise InvalidValue(f"edge_u and edge_v must be perpendicular, {got}")

    @property
    def dim(self) -> int:
        """Number of coordinates: 2."""
        return 2

    @property
    def flat(self) -> FlatMetric:
        """The Euclidean metric: scales of 1, nothing wraps."""
        return _EUCLIDEAN

    @property
    def area(self) -> float:
        """Area, in squared units of `corner`."""
        return math.hypot(*self.edge_u) * math.hypot(*self.edge_v)

    def from_cube(self, u: Floats) -> Floats:
        """Return ``corner + u[:, 0] edge_u + u[:, 1] edge_v`` for `u` of shape (n, 2), as (n, 2)."""
        unit = as_cube_batch(u, 2)
        # Not a matrix product, because BLAS may round a row differently in a longer batch.
        return np.column_stack(
            [self.corner[k] + unit[:, 0] * self.edge_u[k] + unit[:, 1] * self.edge_v[k] for k in (0, 1)]
        )

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, 2), whether it lies in the rectangle, up to rounding: (n,)."""
        offset = as_batch("q", q, 2) - np.array(self.corner)
        inside = np.ones(len(offset), dtype=np.bool_)
        for edge in (self.edge_u, self.edge_v):
            along = (offset[:, 0] * edge[0] + offset[:, 1] * edge[1]) / math.hypot(*edge) ** 2
            inside &= (along >= -_ROUNDING) & (along <= 1.0 + _ROUNDING)
        return inside

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the Euclidean distances of the rows of `a` and `b`, both (n, 2), as (n,)."""
        first, second = as_batch_pair(a, b, 2)
        return np.hypot(second[:, 0] - first[:, 0], second[:, 1] - first[:, 1])

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return ``(1 - t) a + t b`` for `a`, `b` of shape (n, 2) and `t` in [0, 1], scalar or (n,)."""
        first, second = as_batch_pair(a, b, 2)
        column = as_fractions(t, len(first))
        # This form, unlike a + t (b - a), is exact at both endpoints.
        return (1.0 - column) * first + column * second
