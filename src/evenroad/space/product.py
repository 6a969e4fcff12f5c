"""Product: several spaces as one space, such as the poses of rigid bodies, SE2 and SE3."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Literal

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_known
from evenroad.errors import InvalidValue, shown
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions, as_weights
from evenroad.space.flat import FlatMetric
from evenroad.space.joints import BoxSpace, Circle
from evenroad.space.protocol import Space, all_distances, period_of, wrapped
from evenroad.space.so3 import SO3


@explains_calls
@dataclass(frozen=True)
class Product(Space):
    """The space of tuples of one configuration from each part, with their coordinates in sequence.

    A shortest path of the product is a shortest path in every part at once, each at constant speed.

    Parameters
    ----------
    parts : sequence of Space
        At least one; stored as a tuple.
    weights : sequence of floats, one a part, optional
        Weight of each part's distance, > 0; default 1.
    combine : {"sum", "l2"}
        The distance: ``sum_i w_i d_i``, or ``sqrt(sum_i (w_i d_i)^2)``.

    Raises
    ------
    UnknownName
        For another `combine`.
    InvalidValue
        If parts are no spaces, or weights no such numbers.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.Product([er.spaces.BoxSpace((0,), (1,)), er.spaces.Circle()]).dim
    2
    """

    parts: Sequence[Space]
    weights: Sequence[float] = None  # type: ignore[assignment]
    combine: Literal["sum", "l2"] = "sum"
    _flat: FlatMetric | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        parts = tuple(self.parts) if isinstance(self.parts, Iterable) else ()
        if not parts or not all(hasattr(part, "from_cube") for part in parts):
            raise InvalidValue(f"parts must be a list of one space or more, got {shown(self.parts)}")
        require_known("combination", self.combine, ("sum", "l2"))
        weights = as_weights(self.weights, len(parts))
        metric = _flat_product(parts, weights, self.combine)
        set_fields(self, parts=parts, weights=weights, _flat=metric)

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
        """The metric as scales and periods, if every part has one and ``combine`` is "l2"; else None."""
        return self._flat

    @property
    def period(self) -> Floats:
        """The periods of all parts; a part without the attribute has none."""
        own = (np.full(part.dim, np.inf) if period_of(part) is None else period_of(part) for part in self.parts)
        return np.concatenate([*own])

    def from_cube(self, u: Floats) -> Floats:
        """Map `u`, (n, cube_dim), to configurations, (n, dim), each part from its own columns."""
        columns = _split(as_cube_batch(u, self.cube_dim), [part.cube_dim for part in self.parts])
        return np.hstack([part.from_cube(own) for part, own in zip(self.parts, columns, strict=True)])

    def contains(self, q: Floats) -> Bools:
        """Return for each row of `q`, (n, dim), whether every part contains its own coordinates: (n,)."""
        columns = self.split(as_batch("q", q, self.dim))
        inside: Bools = np.all([part.contains(own) for part, own in zip(self.parts, columns, strict=True)], axis=0)
        return inside

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the combined, weighted distances of the rows of two (n, dim) arrays, (n,)."""
        return self._combined(self.part_distances(a, b))

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows, (n, dim) and (m, dim), as (n, m)."""
        first, second = as_batch("a", a, self.dim), as_batch("b", b, self.dim)
        return self._combined(all_distances(*own) for own in self._part_by_part(first, second))

    def part_distances(self, a: Floats, b: Floats) -> list[Floats]:
        """Return for every part the distances in its own metric, without weights.

        Parameters
        ----------
        a, b : array_like, shape (n, dim)

        Returns
        -------
        list of ndarrays, shape (n,)

        Examples
        --------
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> [float(row[0]) for row in space.part_distances([(0, 0, 0)], [(3, 4, 1)])]
        [5.0, 1.0]
        """
        pairs = self._part_by_part(*as_batch_pair(a, b, self.dim))
        return [part.distance(first, second) for part, first, second in pairs]

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the points a fraction `t`, scalar or (n,) in [0, 1], of the motion in every part, (n, dim)."""
        first, second = as_batch_pair(a, b, self.dim)
        fraction = as_fractions(t, len(first))[:, 0]
        pairs = self._part_by_part(first, second)
        return np.hstack([part.interpolate(start, end, fraction) for part, start, end in pairs])

    def wrapped(self, q: Floats) -> Floats:
        """Return configurations, (n, dim), with coordinates that repeat brought into the ranges of their parts."""
        batch = as_batch("q", q, self.dim)
        return np.hstack([wrapped(part, own) for part, own in zip(self.parts, self.split(batch), strict=True)])

    def split(self, q: Floats) -> list[Floats]:
        """Return the columns of `q` that belong to each part.

        Parameters
        ----------
        q : ndarray, shape (n, dim)

        Returns
        -------
        list of ndarrays, shape (n, dim of the part)

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> space = er.spaces.SE2((-5, -5), (5, 5))
        >>> [each.shape for each in space.split(np.zeros((7, 3)))]
        [(7, 2), (7, 1)]
        """
        return _split(q, [part.dim for part in self.parts])

    def _part_by_part(self, a: Floats, b: Floats) -> Iterator[tuple[Space, Floats, Floats]]:
        return zip(self.parts, self.split(a), self.split(b), strict=True)

    def _combined(self, lengths: Iterable[Floats]) -> Floats:
        """Return the combined distance from those of the parts."""
        weighted = (weight * length for weight, length in zip(self.weights, lengths, strict=True))
        return reduce(np.add if self.combine == "sum" else np.hypot, weighted)


def _split(q: Floats, widths: list[int]) -> list[Floats]:
    return np.split(q, np.cumsum(widths)[:-1], axis=1)


def _flat_product(parts: Sequence[Space], weights: Sequence[float], combine: str) -> FlatMetric | None:
    flat = [part.flat for part in parts if part.flat is not None]
    if len(flat) < len(parts) or (combine != "l2" and len(parts) > 1):
        return None
    return FlatMetric(
        scale=np.concatenate([weight * metric.scale for weight, metric in zip(weights, flat, strict=True)]),
        period=np.concatenate([metric.period for metric in flat]),
    )


@explains_calls
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
    low, high : pairs of floats
        Bounds of the position.
    weights : pair of floats
        Weights of a unit of length and of a radian, > 0.
    combine : {"l2", "sum"}
        How the two distances are combined. With "l2" the metric is flat, and a tree finds neighbours.

    Returns
    -------
    Product

    Raises
    ------
    InvalidValue, UnknownName
        As :class:`BoxSpace` and :class:`Product`.

    Examples
    --------
    >>> import evenroad as er
    >>> space = er.spaces.SE2((-5, -5), (5, 5))
    >>> space.dim
    3
    """
    return Product((_position(low, high, 2), Circle()), weights, combine)


@explains_calls
def SE3(
    low: Sequence[float],
    high: Sequence[float],
    *,
    weights: Sequence[float] = (1.0, 1.0),
    combine: Literal["sum", "l2"] = "sum",
) -> Product:
    """Return the poses (x, y, z, qw, qx, qy, qz) of a body in space; points of the cube have 6 coordinates.

    Parameters
    ----------
    low, high : sequences of 3 floats
        Bounds of the position.
    weights : pair of floats
        Weights of a unit of length and of a radian of ``arccos |q . q'|``, > 0.
    combine : {"sum", "l2"}
        As for :func:`SE2`; "sum" is OMPL's.

    Returns
    -------
    Product

    Raises
    ------
    InvalidValue, UnknownName
        As :class:`BoxSpace` and :class:`Product`.

    Examples
    --------
    >>> import evenroad as er
    >>> er.spaces.SE3((0, 0, 0), (1, 1, 1)).dim
    7
    """
    return Product((_position(low, high, 3), SO3()), weights, combine)


def _position(low: Sequence[float], high: Sequence[float], dim: int) -> BoxSpace:
    box = BoxSpace(low, high)
    if box.dim != dim:
        raise InvalidValue(f"low and high must have {dim} numbers, got {low!r} and {high!r}")
    return box
