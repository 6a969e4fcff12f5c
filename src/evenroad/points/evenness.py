"""All measures of a point set at once."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from evenroad._call import explains_calls
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.points.measures import (
    MEASURES,
    dispersion_bounds,
    rank_one,
    star_discrepancy,
)
from evenroad.points.measures.separation import riesz_rooted, separation
from evenroad.points.measures.short_vectors import MOST_AXES
from evenroad.points.npz import load_points
from evenroad.points.pointset import PointSet

WORK = 3e8
"""Limit on the coordinates examined to bound the dispersion: about a second."""


@explains_calls
def measure(points: PointSet | npt.ArrayLike | str | os.PathLike[str]) -> dict[str, float | None]:
    """Return how evenly points fill the unit cube: discrepancies, dispersion, separation, energy.

    Small discrepancies and energies mean even points.  Dispersion is the radius of the largest hole between the
    points, separation the distance of the nearest two.

    Parameters
    ----------
    points : PointSet, array_like of shape (n, d), or a file
        At least one point in [0, 1)^d.

    Returns
    -------
    dict of str to float or None
        Measures by name, as ``evenroad measure`` prints them; None for one that takes too long or does not exist.

    Raises
    ------
    InvalidValue
        If these are no such points.
    BrokenFile
        If the file cannot be read.

    Examples
    --------
    >>> import evenroad as er
    >>> round(er.measure(er.draw("even", 64, 2))["separation"], 3)
    0.119
    """
    read = load_points(points) if isinstance(points, str | os.PathLike) else points
    chosen = read if isinstance(read, PointSet) else PointSet(np.asarray(read))
    if chosen.n == 0:
        raise InvalidValue("there must be a point to measure, got none")
    return {name: value for name, value, _ in measure_all(chosen)}


def measure_all(points: PointSet) -> list[tuple[str, float | None, str]]:
    """Return (name, value, note) of every measure; where a value is None the note says why."""
    rows: list[tuple[str, float | None, str]] = []

    def add(name: str, note: str, compute: Callable[[], float]) -> None:
        try:
            with np.errstate(all="ignore"):
                rows.append((name, compute(), note))
        except EvenroadError as error:
            rows.append((name, None, str(error)))

    for measure in MEASURES.values():
        add(f"{measure.name}_rooted", "L2 discrepancy", partial(measure.rooted, points))
        add(f"{measure.name}_squared", "its square", partial(measure.squared, points))
    add("star_discrepancy", "L-infinity, exact", lambda: star_discrepancy(points))
    for side, bound in dispersion_bounds(points, work=WORK)._asdict().items():
        add(f"dispersion_{side}", f"largest hole, {side} bound", partial(float, bound))
    add("separation", "smallest distance", lambda: separation(points))
    add("separation_periodic", "on the torus", lambda: separation(points, periodic=True))
    add("riesz_rooted", "periodic, s = 2d", lambda: riesz_rooted(points))
    add("riesz_open_rooted", "not periodic, s = 2d", lambda: riesz_rooted(points, periodic=False))
    z = rank_one.generating_vector(points)
    if z is not None and points.d <= MOST_AXES:
        n = points.n
        add("lattice_minima_ratio", "last successive minimum / first", partial(rank_one.minima_ratio, n, z))
        add("lattice_neighbours", "least k that leads everywhere", lambda: rank_one.least_neighbours(n, z))
    return [_finite(*row) for row in rows]


def _finite(name: str, value: float | None, note: str) -> tuple[str, float | None, str]:
    """Return a row without a value that is not finite, which JSON cannot have."""
    if value is None or math.isfinite(value):
        return name, None if value is None else float(value), note
    return name, None, f"{note}: beyond the range of a float"
