"""FlatMetric: Euclidean in scaled coordinates, some of which may wrap."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._native.space import flat_distances, row_distances
from evenroad.errors import InvalidValue


@dataclass(frozen=True, eq=False)
class FlatMetric:
    """The metric ``sqrt(sum_k (scale_k wrap_k(b_k - a_k))^2)``, which neighbour trees use.

    ``wrap_k(x)`` is `x` shifted by the multiple of ``period_k`` that brings it nearest to 0.  `scale`, (dim,), is the
    weight of a unit of each coordinate, finite and > 0.  `period`, (dim,), is the period of each coordinate, > 0,
    ``inf`` if it does not repeat.  Raises InvalidValue if the two are not such arrays of one length >= 1.
    """

    scale: Floats
    period: Floats
    wraps: bool = field(init=False, repr=False)
    """Whether any coordinate wraps."""
    _turning: tuple[int, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("scale", "period"):
            try:
                array = np.array(getattr(self, name), dtype=np.float64)
            except (TypeError, ValueError):
                raise InvalidValue(f"{name} must be numbers, got {getattr(self, name)!r}") from None
            if array.ndim != 1 or array.size == 0 or not (array > 0.0).all():
                raise InvalidValue(f"{name} must be a row of numbers > 0, got {array!r}")
            set_fields(self, **{name: array})
        if not np.isfinite(self.scale).all():
            raise InvalidValue(f"scale must be finite, got {self.scale!r}")
        if len(self.scale) != len(self.period):
            lengths = f"{len(self.scale)} and {len(self.period)}"
            raise InvalidValue(f"scale and period must have one length, got {lengths}")
        set_fields(self, _turning=tuple(np.flatnonzero(self.wrapping).tolist()), wraps=bool(self.wrapping.any()))

    @property
    def dim(self) -> int:
        """Number of coordinates."""
        return len(self.scale)

    @property
    def wrapping(self) -> Bools:
        """Which coordinates wrap, (dim,)."""
        return np.isfinite(self.period)

    def difference(self, a: Floats, b: Floats) -> Floats:
        """Return ``b - a`` in the shorter direction, not scaled, for two (n, dim) arrays as (n, dim).

        Opposite values of a wrapping coordinate keep the sign of ``b - a``.  The motion between them is the same in
        both directions and, within one period, does not cross its bounds.
        """
        difference = b - a
        for k in self._turning:
            # rint rounds one half to zero, so exactly opposite values stay unchanged.
            difference[:, k] -= self.period[k] * np.rint(difference[:, k] / self.period[k])
        return difference

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of the rows of two float64 arrays, (n, dim), as (n,)."""
        return row_distances(np.ascontiguousarray(a), np.ascontiguousarray(b), self.scale, self.period)

    def all_distances(self, a: Floats, b: Floats) -> Floats:
        """Return the distances of all pairs of rows of two float64 arrays, (n, dim) and (m, dim), as (n, m)."""
        return flat_distances(np.ascontiguousarray(a), np.ascontiguousarray(b), self.scale, self.period)
