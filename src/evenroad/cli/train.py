"""``evenroad train``: make sets of any objective, by annealing or by the network; the same line resumes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

if TYPE_CHECKING:
    from evenroad.points import PointSet
    from evenroad.points.optimise.anneal import Callback


@dataclass(frozen=True, kw_only=True)
class Train:
    """Train point sets and write them as OUT/set-0000.npz, ...; the same command goes on where it stopped."""

    n: Annotated[int, tyro.conf.arg(aliases=["-n"])]
    """How many points."""
    d: Annotated[int, tyro.conf.arg(aliases=["-d"])]
    """How many dimensions."""
    method: Literal["anneal", "mpmc"] = "anneal"
    """anneal: noisy Adam on the coordinates. mpmc: the message-passing network (needs the extra [train])."""
    objective: str = "hickernell"
    """What is made small: a sum of measures, energies or their logs, e.g. "hickernell+10*riesz"."""
    sets: int = 8
    """How many sets."""
    steps: int = 5000
    """Steps of the optimiser (mpmc: at most; it stops after 1000 steps without a better mean)."""
    refine: int = 0
    """mpmc: anneal the network's sets for so many more steps, and write them as OUT/refined-0000.npz, ..."""
    device: str = "auto"
    """mpmc: auto, cpu or cuda."""
    seed: int = 0
    """Set i depends on this seed and i alone, whatever the number of processes."""
    jobs: int | None = None
    """Processes for anneal (default: one a processor)."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """The folder for the sets; made if its parent exists."""

    def run(self) -> int:
        """Train, write, report."""
        import numpy as np

        from evenroad.cli.progress import progress_bar
        from evenroad.points.optimise import parse_objective

        objective = parse_objective(self.objective)
        self._make_folder()
        with progress_bar(f"{self.method} n={self.n} d={self.d} x {self.sets}") as callback:
            sets = self._anneal(callback) if self.method == "anneal" else self._network(callback)
        values = np.array([objective.value(each) for each in sets])
        print(f"{self.out}: {len(sets)} sets, {objective}: mean {values.mean():.6g}, best {values.min():.6g}")
        return 0

    def _make_folder(self) -> None:
        from evenroad._files import require_writable_folder
        from evenroad.errors import BrokenFile

        if self.out.exists() and not self.out.is_dir():
            raise BrokenFile(f"cannot write sets into {self.out}: it is not a folder")
        if not self.out.exists():
            require_writable_folder(self.out)
            self.out.mkdir()
        require_writable_folder(self.out / "set-0000.npz")

    def _anneal(self, callback: Callback) -> tuple[PointSet, ...]:
        from evenroad.points.optimise import anneal_many

        return anneal_many(
            self.n,
            self.d,
            self.objective,
            self.sets,
            steps=self.steps,
            rng=self.seed,
            workers=self.jobs,
            folder=self.out,
            callback=callback,
        )

    def _network(self, callback: Callback) -> tuple[PointSet, ...]:
        from evenroad.points import save_points
        from evenroad.points.network import NetworkConfig, refine, train

        config = NetworkConfig(
            n=self.n, d=self.d, objective=self.objective, sets=self.sets, steps=self.steps, seed=self.seed
        )
        sets = train(config, folder=self.out, callback=callback, device=self.device)
        if not self.refine:
            return sets
        refined = refine(sets, steps=self.refine, callback=callback)
        for i, points in enumerate(refined):
            save_points(self.out / f"refined-{i:04d}.npz", points)
        return refined
