"""``evenroad measure``: the measures of a point set."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from evenroad._terminal import print_table
from evenroad.cli.options import Positional
from evenroad.errors import InvalidValue
from evenroad.points.evenness import measure_all
from evenroad.points.npz import load_points


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
