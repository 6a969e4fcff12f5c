"""``evenroad points``: a point set of any family, n and d as a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from evenroad._checks import require_known
from evenroad._files import require_writable_folder
from evenroad._terminal import progress_shown
from evenroad.errors import InvalidValue, shown
from evenroad.points import PointSet, make_sampler
from evenroad.points.bank import TRAINED_FAMILIES, Trained
from evenroad.points.npz import save_array, save_points


@dataclass(frozen=True, kw_only=True)
class Points:
    """Write a point set: shipped, constructed, from the cache, or annealed on demand."""

    n: Annotated[int, tyro.conf.arg(aliases=["-n"])]
    """How many points."""
    d: Annotated[int, tyro.conf.arg(aliases=["-d"])]
    """How many dimensions."""
    family: str = "even"
    """even, growing, sequence, hickernell, mpmc, korobov, lattice, cover, halton, sobol, sukharev or uniform."""
    seed: int = 0
    """Which set of the family's pool, and every other random choice."""
    no_train: bool = False
    """Refuse a set that is neither shipped nor cached, instead of annealing it now."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The file: .npy for the plain array, .npz to keep the origin."""

    def run(self) -> int:
        """Find or make the set, and write it."""
        kind = f"kind of file {shown(str(self.out))}: suffix"
        require_known(kind, self.out.suffix, (".npy", ".npz"))
        require_writable_folder(self.out)
        points, source = self._find()
        (save_points if self.out.suffix == ".npz" else save_array)(self.out, points)
        about = f"{points.n} points in d={points.d}, {points.origin} ({source})"
        print(f"{self.out}: {about}, hash {points.hash[:12]}")
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
