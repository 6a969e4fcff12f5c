"""Build the bank, or finish it: ``python -m evenroad_studies.training.bank``.

A set is written to a work folder as soon as it is made, and a cell enters the index in one atomic step when all its
sets are there.  A build that is stopped loses at most the sets that were being made, and the bank stays whole.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evenroad._files import atomic_write
from evenroad._terminal import LineProgress
from evenroad.points.bank.bank import DATA, INDEX, MOST_IN_THE_CORE, SEED, Bank, cell_name
from evenroad.points.pointset import BELOW_ONE, PointSet
from evenroad_studies.training import anneal_many, train_many
from evenroad_studies.training.folder import one_at_a_time

COUNTS = (16, 32, 64, 128, 256, 512, 1024, 2048)
"""Numbers of points."""
HICKERNELL_DIMENSIONS = tuple(range(1, 15))
MPMC_CELLS = tuple((2, n) for n in COUNTS[1:-1]) + tuple((d, n) for n in (128, 256, 512, 1024) for d in (3, 5, 6, 10))

LARGE_SETS = Path(__file__).parents[1] / "sets"
"""Folder of the shipped sets that are too large for evenroad's own wheel."""

LOCK = ".lock"
"""Lock file for changes of the index: several builds may work on one bank, on different cells."""


@dataclass(frozen=True)
class Recipe:
    """One cell of the bank: how the `sets` sets of n points in d dimensions are made.

    `objective` is made small in so many `steps`, by the method ``annealed`` (noisy Adam on the coordinates) or
    ``network``.
    """

    family: str
    d: int
    n: int
    sets: int
    objective: str
    steps: int
    method: str = "annealed"


def recipes() -> list[Recipe]:
    """Return every cell of the bank, in the order in which they are built: most wanted first."""
    first = (2, 10, 3, 5)
    order = [*first, *(d for d in HICKERNELL_DIMENSIONS if d not in first)]
    annealed = [Recipe("hickernell", d, n, _sets(d, n), "hickernell", _steps(d, n)) for d in order for n in COUNTS]
    return annealed + [Recipe("mpmc", d, n, 8, "hickernell", _network_steps(n, d), "network") for d, n in MPMC_CELLS]


def _network_steps(n: int, d: int) -> int:
    """Return the steps of a network: fewer where one takes long."""
    if d <= 3:
        return 10_000 if n <= 512 else 6_000
    if n <= 256:
        return 10_000
    if n == 512:
        return 6_000 if d == 10 else 8_000
    return 5_000 if d == 10 else 4_000


def _sets(d: int, n: int) -> int:
    """Return the size of a pool: large in low dimensions, where success depends most on the set; small if slow."""
    if n == 2048:
        return 4 if d <= 3 else 2
    return {1: 32, 2: 64, 3: 32}.get(d, 8)


def _steps(d: int, n: int) -> int:
    """Return the number of steps: 5000, more where a step is quick and for the paper's d = 2 and 10 (gain: 2 %)."""
    if d == 10 and n <= 1024:
        return 20_000 if n <= 512 else 10_000
    if d == 2 and n <= 512:
        return 20_000 if n <= 128 else 10_000
    if n <= 256:
        return 10_000
    return 5_000 if n <= 1024 else 3_000


def build(recipe: Recipe, folder: Path, work: Path, jobs: int, report: Callable[[str], object]) -> None:
    """Make the sets of a cell that are missing in the work folder, then put the cell into the bank."""
    own_work = work / f"{recipe.family}-d{recipe.d:02d}-n{recipe.n:04d}"
    own_work.mkdir(parents=True, exist_ok=True)
    progress = LineProgress(f"{recipe.family} d={recipe.d} n={recipe.n}, {recipe.sets} sets", report)
    make = _train if recipe.method == "network" else _anneal
    store(recipe, make(recipe, own_work, jobs, progress), folder)


def _anneal(recipe: Recipe, work: Path, jobs: int, progress: LineProgress) -> tuple[PointSet, ...]:
    return anneal_many(
        recipe.n,
        recipe.d,
        recipe.objective,
        recipe.sets,
        steps=recipe.steps,
        rng=SEED,
        workers=jobs,
        folder=work,
        family=recipe.family,
        callback=progress,
    )


def _train(recipe: Recipe, work: Path, jobs: int, progress: LineProgress) -> tuple[PointSet, ...]:
    # Here, because only these cells need it.
    from evenroad_studies.network import NetworkConfig

    config = NetworkConfig(recipe.n, recipe.d, recipe.objective, steps=recipe.steps)
    return train_many(config, recipe.sets, rng=SEED, workers=jobs, folder=work, callback=progress)


def store(recipe: Recipe, sets: Sequence[PointSet], folder: Path) -> None:
    """Write the sets of a cell as float32, then its record in the index."""
    rounded = np.minimum(np.stack(sets).astype(np.float32), np.float32(BELOW_ONE))
    large = folder == DATA and recipe.n > MOST_IN_THE_CORE
    path = (LARGE_SETS if large else folder) / recipe.family / cell_name(recipe.n, recipe.d)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as file:
        np.save(file, rounded)
    record = {
        "method": sets[0].origin.method,
        "objective": recipe.objective,
        "steps": recipe.steps,
        "seed": SEED,
        "version": sets[0].origin.version,
        "hashes": [PointSet(each).hash for each in rounded],
    }
    with one_at_a_time(folder / LOCK):
        index_path = folder / INDEX
        index = json.loads(index_path.read_text(encoding="utf-8")) if index_path.exists() else {}
        index.setdefault(recipe.family, {}).setdefault(str(recipe.d), {})[str(recipe.n)] = record
        with atomic_write(index_path) as file:
            file.write((json.dumps(index, indent=1, sort_keys=True) + "\n").encode())


def main() -> None:
    """Build every cell that the bank does not hold yet."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=DATA, help="the bank")
    parser.add_argument("--work", type=Path, default=Path("out/bank"), help="where finished sets wait for their cell")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--family", help="only the cells of this family")
    parser.add_argument("-d", type=int, nargs="+", help="only these dimensions")
    parser.add_argument("--list", action="store_true", help="only name the cells that are not built yet")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    bank = Bank(options.folder)
    families = {options.family} if options.family else {"hickernell", "mpmc"}
    wanted = [each for each in recipes() if each.family in families and each.d in (options.d or [each.d])]
    missing = [each for each in wanted if not bank.has(each.family, each.n, each.d)]
    print(f"{len(wanted) - len(missing)} of {len(wanted)} cells are in the bank", flush=True)
    for recipe in missing:
        if options.list:
            print(f"missing: {recipe.family} d={recipe.d} n={recipe.n}")
        else:
            build(recipe, options.folder, options.work, options.jobs, lambda line: print(line, flush=True))


if __name__ == "__main__":
    main()
