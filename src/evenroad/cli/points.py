"""``evenroad points`` and ``evenroad measure``: a point set of any family, n and d as a file; how even a set is."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro

from evenroad._files import require_writable_folder
from evenroad._terminal import print_table, progress_shown
from evenroad.errors import EvenroadError, InvalidValue, UnknownName, shown
from evenroad.points import PointSet, make_sampler, measures
from evenroad.points.bank import TRAINED_FAMILIES, Trained
from evenroad.points.measures.dispersion import EXACT_UP_TO
from evenroad.points.npz import read_points, save_array, save_points


@dataclass(frozen=True, kw_only=True)
class Points:
    """Write a point set: shipped, constructed, from the cache, or annealed on demand."""

    n: Annotated[int, tyro.conf.arg(aliases=["-n"])]
    """How many points."""
    d: Annotated[int, tyro.conf.arg(aliases=["-d"])]
    """How many dimensions."""
    family: str = "even"
    """even, hickernell, mpmc, korobov, lattice, halton, sobol, sukharev or uniform."""
    seed: int = 0
    """Which set of the family's pool, and every other random choice."""
    no_train: bool = False
    """Refuse a set that is neither shipped nor cached, instead of annealing it now."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The file: .npy for the plain array, .npz to keep the origin."""

    def run(self) -> int:
        """Find or make the set, and write it."""
        if self.out.suffix not in (".npy", ".npz"):
            raise UnknownName.among(
                f"kind of file {shown(str(self.out))}: suffix", self.out.suffix, (".npy", ".npz")
            )
        require_writable_folder(self.out)
        points, source = self._find()
        (save_points if self.out.suffix == ".npz" else save_array)(self.out, points)
        print(
            f"{self.out}: {points.n} points in d={points.d}, {points.origin} ({source}), hash {points.hash[:12]}"
        )
        return 0

    def _find(self) -> tuple[PointSet, str]:
        sampler = make_sampler(self.family)
        if self.family not in TRAINED_FAMILIES:
            if self.no_train:
                raise InvalidValue(f"--no-train does not go with {self.family!r}, whose sets are constructed")
            return sampler.draw(self.n, self.d, rng=self.seed), "exact"
        with progress_shown(f"annealing {self.family} n={self.n} d={self.d}") as callback:
            family = Trained(self.family, train=not self.no_train, callback=callback)
            return family.find(self.n, self.d, rng=self.seed)


@dataclass(frozen=True, kw_only=True)
class Measure:
    """Print every measure of a point set: discrepancies, dispersion, separation, energy."""

    file: tyro.conf.Positional[Path]
    """A .npy array of shape (n, d), or a .npz point set."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Measure and print."""
        points = read_points(self.file)
        if points.n == 0:
            raise InvalidValue(f"{self.file} holds no points, there is nothing to measure")
        rows = measure_all(points)
        if self.json:
            record = {"file": str(self.file), "n": points.n, "d": points.d, "hash": points.hash}
            print(json.dumps(record | {name: value for name, value, _ in rows}, indent=2, allow_nan=False))
        else:
            title = f"{self.file}: n={points.n}, d={points.d}, {points.origin}"
            shown = [(name, "-" if value is None else f"{value:.6g}", note) for name, value, note in rows]
            print_table(shown, ("measure", "value", ""), title, right=(1,))
        return 0


def measure_all(points: PointSet) -> list[tuple[str, float | None, str]]:
    """Return (name, value, note) of every measure; a value is None where it cannot be had, and the note says why."""
    rows: list[tuple[str, float | None, str]] = []

    def add(name: str, note: str, compute: Callable[[], float]) -> None:
        try:
            with np.errstate(all="ignore"):
                rows.append((name, compute(), note))
        except EvenroadError as error:
            rows.append((name, None, str(error)))

    for measure in measures.MEASURES.values():
        add(f"{measure.name}_rooted", "L2 discrepancy", partial(measure.rooted, points))
        add(f"{measure.name}_squared", "its square", partial(measure.squared, points))
    add("star_discrepancy", "L-infinity, exact", lambda: measures.star_discrepancy(points))
    for norm in ("l2", "linf"):
        if points.d <= EXACT_UP_TO:
            exact = partial(getattr(measures, f"dispersion_{norm}"), points)
            add(f"dispersion_{norm}", "largest hole, exact", exact)
        else:
            bound = partial(measures.dispersion_lower_bound, points, norm)
            add(f"dispersion_{norm}_lower_bound", "by search", bound)
    add("separation", "smallest distance", lambda: measures.separation(points))
    add("separation_periodic", "on the torus", lambda: measures.separation(points, periodic=True))
    add("riesz_rooted", "periodic, s = 2d", lambda: measures.riesz_rooted(points))
    add("riesz_open_rooted", "not periodic, s = 2d", lambda: measures.riesz_rooted(points, periodic=False))
    return [_finite(*row) for row in rows]


def _finite(name: str, value: float | None, note: str) -> tuple[str, float | None, str]:
    """Leave out a value that a float cannot hold: infinity is neither JSON nor a measure."""
    if value is None or math.isfinite(value):
        return name, None if value is None else float(value), note
    return name, None, f"{note}: beyond the range of a float"
