"""``evenroad measure``: the measures of a point set."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.points import PointSet
from evenroad.points.measures import (
    MEASURES,
    dispersion_bounds,
    rank_one,
    riesz_rooted,
    separation,
    star_discrepancy,
)
from evenroad.points.measures.short_vectors import MOST_AXES
from evenroad.points.npz import load_points

WORK = 3e8
"""Limit on the coordinates examined to bound the dispersion: about a second."""


@dataclass(frozen=True, kw_only=True)
class Measure:
    """Print how evenly points fill the unit cube: discrepancies, dispersion, separation, energy.

    Dispersion is the radius of the largest hole between the points, separation the distance of the nearest two.  Small
    discrepancies and energies mean even points.

    Example: evenroad measure set.npy
    """

    set: Positional[Path]
    """A .npy array of shape (n, d), or a .npz point set."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Measure and print."""
        points = load_points(self.set)
        if points.n == 0:
            raise InvalidValue(f"{self.set} holds no points, there is nothing to measure")
        rows = measure_all(points)
        if self.json:
            record = {"file": str(self.set), "n": points.n, "d": points.d, "hash": points.hash}
            print(json.dumps(record | {name: value for name, value, _ in rows}, indent=2, allow_nan=False))
        else:
            title = f"{self.set}: n={points.n}, d={points.d}, {points.origin}"
            shown = [(name, "-" if value is None else f"{value:.6g}", note) for name, value, note in rows]
            print_table(shown, ("measure", "value", ""), title, right=(1,))
        return 0


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
