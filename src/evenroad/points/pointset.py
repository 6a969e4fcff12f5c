"""PointSet: a read-only array of points in the unit cube, and its origin."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass, field, replace
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from evenroad import __version__
from evenroad._arrays import Array, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_known
from evenroad._hints import KnowsElsewhere
from evenroad._rows import Rows
from evenroad.errors import InvalidValue, shown

if TYPE_CHECKING:
    from PIL.Image import Image

BELOW_ONE = float(np.nextafter(np.float32(1.0), np.float32(0.0)))
"""Largest float32 below 1. It replaces coordinates that would round up to 1."""


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Origin of a point set, from which it can be made again.

    `family` is the sampler or family (``halton``, ``hickernell``).  `method` is the construction (``plain``,
    ``annealed``, ``given``), and `objective` the minimised expression, or "".  `seed` is None for a Generator, or if
    nothing was drawn.  `replica` is the index of a trained set in its pool, `steps` the number of optimiser steps,
    `start` the index of a sequence's first point, and `version` that of evenroad.
    """

    family: str
    method: str = "plain"
    objective: str = ""
    seed: int | None = None
    replica: int | None = None
    steps: int | None = None
    start: int = 0
    version: str = __version__

    def __str__(self) -> str:
        # One word is enough for given points.
        parts = [*dict.fromkeys((self.family, self.method))]
        if self.replica is not None:
            parts.append(f"set {self.replica}")
        if self.start:
            parts.append(f"from index {self.start}")
        return " ".join(parts)


@explains_calls
@dataclass(frozen=True, eq=False)
class PointSet(Rows, metaclass=KnowsElsewhere):
    """Points of the unit cube, frozen, with their origin.

    Parameters
    ----------
    points : array_like, shape (n, d)
        Real numbers in [0, 1), d >= 1; copied to a read-only float64 array.
    origin : Origin
        Default: the points were given.

    Raises
    ------
    InvalidValue
        If a coordinate is not in [0, 1), or the array has another shape.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> er.PointSet(np.random.default_rng(0).random((32, 3))).shape
    (32, 3)
    """

    points: Floats
    origin: Origin = field(default_factory=lambda: Origin(family="given", method="given"))

    def __post_init__(self) -> None:
        points = as_unit_points(self.points)
        # Samplers return read-only arrays that are no views.  These are not copied: a large set fits in memory once.
        set_fields(self, points=points.copy() if points.flags.writeable or points.base is not None else points)

    @property
    def n(self) -> int:
        """Number of points."""
        return len(self.points)

    @property
    def d(self) -> int:
        """Dimension of the cube."""
        return int(self.points.shape[1])

    @property
    def dim(self) -> int:
        """Dimension of the cube, as worlds and spaces call it."""
        return self.d

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points and dimension."""
        return self.n, self.d

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the points to a file, atomically.

        Parameters
        ----------
        path : str or path-like
            ``.npz`` with their origin, or ``.npy`` or ``.csv`` without.

        Raises
        ------
        UnknownName
            For another suffix.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> import evenroad as er
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     er.draw("even", 512, 6).save(f"{folder}/set.npz")
        ...     er.load_points(f"{folder}/set.npz").shape
        (512, 6)
        """
        from evenroad.points.npz import write_points

        write_points(self, path)

    def plot(self, path: str | os.PathLike[str] | None = None, *, axes: tuple[int, int] = (0, 1)) -> Image:
        """Return a picture of the points in two of their axes, which a notebook shows; save it if a file is named.

        Parameters
        ----------
        path : str or path-like, optional
            A ``.png``.
        axes : tuple of int
            Two axes, from 0 to d - 1.

        Returns
        -------
        PIL.Image.Image

        Raises
        ------
        InvalidValue
            If there are no such axes.
        BrokenFile
            If the file cannot be written.

        Examples
        --------
        >>> import evenroad as er
        >>> er.draw("even", 64, 2).plot().mode
        'RGB'
        """
        from evenroad.viz.points import plot_points

        return plot_points(self, path, axes)

    def discrepancy(self, method: str = "CD") -> float:
        """Return the squared L2 discrepancy of the points; 0 is perfectly even.

        Parameters
        ----------
        method : {"CD", "WD", "MD", "L2-star"}
            Centered (Hickernell's), wrap-around, mixture or star, as of :func:`scipy.stats.qmc.discrepancy`.

        Returns
        -------
        float
            SciPy's number, >= 0.

        Raises
        ------
        UnknownName
            For another method; :mod:`evenroad.points.measures` has more measures.

        Examples
        --------
        >>> import evenroad as er
        >>> er.draw("even", 64, 2).discrepancy() < er.draw("uniform", 64, 2).discrepancy()
        True
        """
        require_known("discrepancy", method, ("CD", "WD", "MD", "L2-star"))
        # Imported late: SciPy's statistics take a fifth of a second.
        from scipy.stats.qmc import discrepancy

        return float(discrepancy(self.points, method=method))

    @property
    def hash(self) -> str:
        """SHA-256 (hex) of shape and coordinates as little-endian float64: the identity of the set."""
        digest = hashlib.sha256(f"{self.n}x{self.d}:".encode())
        digest.update(self.points.astype("<f8", copy=False).tobytes())
        return digest.hexdigest()

    def with_origin(self, **changes: Any) -> PointSet:
        """Return the same points with some fields of the origin replaced.

        Parameters
        ----------
        **changes
            Fields of :class:`evenroad.points.Origin`.

        Returns
        -------
        PointSet

        Examples
        --------
        >>> import evenroad as er
        >>> er.draw("uniform", 8, 2).with_origin(family="mine").origin.family
        'mine'
        """
        return PointSet(self.points, replace(self.origin, **changes))

    @property
    def _rows(self) -> Floats:  # type: ignore[override]
        return self.points

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> Array:
        points = self.points if dtype is None else below_one(self.points, dtype)
        return np.array(points, dtype=dtype, copy=True) if copy else np.asarray(points, dtype=dtype)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PointSet):
            return NotImplemented
        return self.origin == other.origin and np.array_equal(self.points, other.points)

    def __hash__(self) -> int:
        return hash(self.hash)

    def __repr__(self) -> str:
        return f"PointSet(n={self.n}, d={self.d}, origin={str(self.origin)!r}, hash={self.hash[:12]})"


def below_one(points: Floats, dtype: npt.DTypeLike = np.float32) -> Floats:
    """Return coordinates in [0, 1) that stay below 1 as floats of this kind; the same array if they already do."""
    kind = np.dtype(dtype)
    if kind.kind != "f" or kind.itemsize >= 8 or not points.size:
        return points
    largest = 1.0 - float(np.finfo(kind).epsneg)
    if points.max() < 0.5 * (1.0 + largest):
        return points
    return np.where(points.astype(kind) < 1.0, points, largest)


def as_unit_points(points: object) -> Floats:
    """Return `points` as a C-contiguous float64 array of shape (n, d) in [0, 1); InvalidValue names what is wrong."""
    if isinstance(points, str | os.PathLike):
        raise InvalidValue(f"points must be an (n, d) array, got {shown(points)}; a file is read by load_points")
    try:
        given = np.asarray(points)
        # NumPy would drop imaginary parts, parse text, and turn durations into integers.
        if given.dtype.kind == "O":
            # Imported late: hardly any points are such.
            from decimal import Decimal

            for each in given.flat:
                if not isinstance(each, Real | Decimal) or isinstance(each, np.timedelta64):
                    raise TypeError(f"one is {shown(each)}")
        elif given.dtype.kind not in "biuf":
            raise TypeError(f"got dtype {given.dtype}")
        array = np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidValue(f"points must be an (n, d) array of numbers: {error}") from None
    if array.ndim != 2 or array.shape[1] < 1:
        raise InvalidValue(f"points must have shape (n, d) with d >= 1, got {array.shape}")
    # The extremes need no further array; NaN fails the comparison.
    if array.size and not (array.min() >= 0.0 and array.max() < 1.0):
        bad = ~((array >= 0.0) & (array < 1.0))
        i, k = np.argwhere(bad)[0]
        raise InvalidValue(f"points must lie in [0, 1): coordinate [{i}, {k}] is {float(array[i, k])!r}")
    return array
