"""``evenroad train``: make sets of any objective, by annealing or by the network; the same line resumes."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from evenroad._checks import require_count
from evenroad._files import require_writable_folder
from evenroad._terminal import progress_shown
from evenroad.datasets.folder import claim_folder
from evenroad.datasets.workers import interrupt_between_steps
from evenroad.errors import BrokenFile, InvalidValue, shown
from evenroad.points import PointSet, load_points, save_points
from evenroad.points.anneal import SCHEDULE, Callback, require_points_for
from evenroad.points.measures import star_discrepancy
from evenroad_studies.training import anneal_many, order_many, train_many
from evenroad_studies.training.folder import REQUEST_FILE, set_name
from evenroad_studies.training.objective import parse_objective

if TYPE_CHECKING:
    from evenroad_studies.network import NetworkConfig
    from evenroad_studies.network.printed import Printed


@dataclass(frozen=True, kw_only=True)
class Train:
    """Train point sets and write them as OUT/set-0000.npz, ...; the same command goes on where it stopped.

    Example: evenroad train -n 32 -d 2 --sets 2 -o trained
    """

    n: Annotated[int, "-n"]
    """How many points a set has."""
    d: Annotated[int, "-d"]
    """How many coordinates a point has."""
    method: Literal["anneal", "mpmc", "printed", "order"] | None = None
    """anneal: noisy Adam on the coordinates. mpmc: the message-passing network, which moves good points. printed: the
    published network, which makes a batch of sets of random points. order: d = 2, --objective star alone,
    and this the exact star discrepancy: orders of the points are tried, each with its best places.  Default: order for
    --objective star in d = 2, else anneal."""
    objective: str = "hickernell"
    """What is made small: a sum of measures, energies or their logs, e.g. "hickernell+10*riesz"."""
    sets: int = 8
    """How many sets."""
    batch: int | None = None
    """printed: number of sets that the network makes together (default: 8), in place of --sets."""
    steps: int = 5000
    """Steps of the optimiser."""
    refine: int = 0
    """mpmc, printed: anneal the network's sets for so many more steps, and write them as OUT/refined-0000.npz, ..."""
    start: str | None = None
    """mpmc: what the network moves: sobol, kronecker, halton, korobov or uniform (default: kronecker in d = 2, but for
    prefixes; else sobol)."""
    judge: Literal["objective", "star"] = "objective"
    """mpmc: what decides which points of a training are its best; star: their exact star discrepancy, d = 2."""
    seed: int = 0
    """Set i depends on this seed and i alone, whatever the number of processes."""
    jobs: int | None = None
    """Number of processes (default: one a processor)."""
    out: Annotated[Path, "-o"]
    """The folder for the sets; made if its parent exists."""

    def run(self) -> int:
        """Train, write, report."""
        self._check()
        self._make_folder()
        title = f"{self._chosen} n={self.n} d={self.d} x {self.sets}"
        with interrupt_between_steps() as check, progress_shown(title) as report:

            def callback(step: int, steps: int, best: float) -> None:
                check()
                report(step, steps, best)

            make = {
                "anneal": self._anneal,
                "mpmc": self._network,
                "printed": self._printed,
                "order": self._order,
            }
            sets = make[self._chosen](callback)
        objective = parse_objective(self.objective)
        name, value = str(objective), objective.value
        if self._chosen == "order" or self.judge == "star":
            name, value = "star discrepancy", star_discrepancy
        values = np.array([value(each) for each in sets])
        print(f"{self.out}: {len(sets)} sets, {name}: mean {values.mean():.6g}, best {values.min():.6g}")
        return 0

    @property
    def _chosen(self) -> str:
        return self.method or ("order" if self._of_stars else "anneal")

    @property
    def _of_stars(self) -> bool:
        """Whether what is made small is the star discrepancy of the plane, however it is written."""
        return self.d == 2 and str(parse_objective(self.objective)) == "star"

    def _check(self) -> None:
        """Refuse bad options before anything is written, and those that the method would silently ignore."""
        least = {"n": 1, "d": 1, "sets": 1, "steps": 1, "refine": 0, "seed": 0}
        for name, at_least in least.items():
            require_count(name, getattr(self, name), at_least)
        require_points_for(parse_objective(self.objective), self.n)
        of_network = {"refine": self.refine, "start": self.start, "judge": self.judge != "objective"}
        for name, given in of_network.items():
            if given and self._chosen != "mpmc" and (name, self._chosen) != ("refine", "printed"):
                raise InvalidValue(f"--{name} does not go with the method {self._chosen!r}")
        if self.batch is not None and self._chosen != "printed":
            raise InvalidValue(f"--batch does not go with the method {self._chosen!r}")
        if self._chosen == "printed" and self.sets != 8:
            raise InvalidValue("--sets does not go with the method 'printed': --batch is the number of sets")
        if self._chosen == "order" and not self._of_stars:
            raise InvalidValue(
                f"the method 'order' makes sets in d = 2 for --objective star,"
                f" not in d = {self.d} for {shown(self.objective)}"
            )
        if self.jobs is not None:
            require_count("jobs", self.jobs)
        if self._chosen == "mpmc":
            self._config()
        if self._chosen == "printed":
            self._printed_config()

    def _make_folder(self) -> None:
        if self.out.exists() and not self.out.is_dir():
            raise BrokenFile(f"cannot write sets into {self.out}: it is not a folder")
        if not self.out.exists():
            require_writable_folder(self.out)
            self.out.mkdir()
        require_writable_folder(self.out / "set-0000.npz")

    def _told(self, callback: Callback) -> dict[str, Any]:
        """Return what every method is told alike."""
        return {"rng": self.seed, "workers": self.jobs, "folder": self.out, "callback": callback}

    def _anneal(self, callback: Callback) -> tuple[PointSet, ...]:
        told = self._told(callback)
        return anneal_many(self.n, self.d, self.objective, self.sets, steps=self.steps, **told)

    def _order(self, callback: Callback) -> tuple[PointSet, ...]:
        return order_many(self.n, self.sets, steps=self.steps, **self._told(callback))

    def _config(self) -> NetworkConfig:
        from evenroad_studies.network import NetworkConfig

        steps, start, judge = self.steps, self.start, self.judge
        return NetworkConfig(self.n, self.d, self.objective, steps=steps, start=start, judge=judge)

    def _network(self, callback: Callback) -> tuple[PointSet, ...]:
        return self._annealed_on(train_many(self._config(), self.sets, **self._told(callback)), callback)

    def _annealed_on(self, sets: tuple[PointSet, ...], callback: Callback) -> tuple[PointSet, ...]:
        """Return the sets of a network, refined if that is asked for."""
        if not self.refine:
            return sets
        claim_folder(self.out, {"steps": self.refine, "schedule": SCHEDULE}, "refined.json")
        return tuple(self._refined(i, points, callback) for i, points in enumerate(sets))

    def _printed_config(self) -> Printed:
        from evenroad_studies.network.printed import Printed

        batch = 8 if self.batch is None else require_count("batch", self.batch)
        return Printed(self.n, self.d, batch, self.objective, steps=self.steps)

    def _printed(self, callback: Callback) -> tuple[PointSet, ...]:
        """Train the network and save its sets, or read them if they are all there."""
        from evenroad_studies.network.printed import train_printed

        config = self._printed_config()

        def seen(step: int, loss: float, _: object) -> None:
            callback(step, config.steps, loss)

        claim_folder(self.out, {"method": "printed", **asdict(config), "seed": self.seed}, REQUEST_FILE)
        paths = [self.out / set_name(i) for i in range(config.sets)]
        try:
            sets = tuple(map(load_points, paths))
        except BrokenFile:
            # Missing or damaged: made (again).
            sets, _ = train_printed(config, rng=self.seed, seen=seen)
            for path, points in zip(paths, sets, strict=True):
                save_points(path, points)
        return self._annealed_on(sets, callback)

    def _refined(self, i: int, points: PointSet, callback: Callback) -> PointSet:
        """Refine set i and save it at once, or read it where an earlier run did."""
        from evenroad_studies.network import refine

        path, number = self.out / f"refined-{i:04d}.npz", self.batch or self.sets
        try:
            return load_points(path)
        except BrokenFile:
            pass  # missing or damaged: made (again)

        def counted(step: int, steps: int, best: float) -> None:
            callback(i * steps + step, number * steps, best)

        (refined,) = refine((points,), steps=self.refine, callback=counted)
        save_points(path, refined)
        return refined
