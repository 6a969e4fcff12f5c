"""The paper's experiments (Chahine et al. 2025, section 4), with more samplers and more runs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from evenroad._checks import require_count
from evenroad.research.bench.samplers import SAMPLERS, why_not
from evenroad.research.bench.task import Task
from evenroad.research.problems import PROBLEMS
from evenroad.research.suites.suite import Suite, chosen_names

SEED = 1
"""Of the published results.  Widths and mazes were designed with other seeds."""

QUICK_RUNS = 40
QUICK_COUNT = 256
"""Most runs and points of a quick suite, which is a part of the whole one: its rows serve both."""

STOCK = "k=10 earlier"
"""The connection that the paper's table was made with: OMPL's PRM, start and goal first."""

SYMMETRISED = "k=10 symmetrised"

MAZE_COUNTS = (32, 64, 128, 256, 512, 1024)
COUNTS = (128, 256, 512, 1024)


@dataclass(frozen=True)
class Experiment:
    """One row of figures.

    Attributes
    ----------
    problem : str
        Name in :data:`~evenroad.research.problems.PROBLEMS`.
    counts : tuple of int
        N.
    rules : tuple of str
        Connection rules, each on the same sets.
    search : str
        As in :class:`~evenroad.research.bench.task.Task`.
    whole_sets : bool
        Whether sets give all coordinates, so that one set is one outcome.
    """

    problem: str
    counts: tuple[int, ...] = COUNTS
    rules: tuple[str, ...] = (STOCK,)
    search: str = "stock"
    whole_sets: bool = True


MAZE_RADII = {1: "radius* gamma=638", 2: "radius* gamma=644", 3: "radius* gamma=582"}
"""Of PRM*, just above the gamma for the free area of each map (Karaman and Frazzoli 2011); reported beside k = 10."""

EXPERIMENTS = (
    *(
        Experiment(f"maze-{level}", MAZE_COUNTS, (SYMMETRISED, radius), search="connect")
        for level, radius in MAZE_RADII.items()
    ),
    Experiment("corridor-2d-0.1"),
    Experiment("corridor-2d-0.0225"),
    Experiment("corridor-3d-0.2"),
    Experiment("corridor-3d-0.1"),
    Experiment("corridor-10d-0.37"),
    Experiment("corridor-10d-0.495", (*COUNTS, 2048)),
    Experiment("hypercube-legacy6"),
    Experiment("chain-10d"),
    Experiment("cubicles", whole_sets=False),
    Experiment("twistycool", whole_sets=False),
    Experiment("cubicles-6d"),
    Experiment("twistycool-6d"),
    Experiment("ur5-c", rules=(SYMMETRISED,), search="connect"),
    Experiment("ur5-a", rules=(SYMMETRISED,), search="connect"),
)


def paper_suite(runs: int = 400, seed: int = SEED, only: Iterable[str] = (), quick: bool = False) -> Suite:
    """Return the tasks of the paper's experiments with every sampler.

    Parameters
    ----------
    runs : int
        Runs of every cell; a sampler that has only one outcome there gets one.
    seed : int
        Root of all random numbers, >= 0.
    only : iterable of str
        Problems to keep; all if empty.
    quick : bool
        A taste: at most 40 runs, of at most 256 points.

    Raises
    ------
    InvalidValue
        If `runs` or `seed` is no such integer.
    UnknownName
        If `only` names a problem that the suite does not have; the text lists those that it has.
    """
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, QUICK_RUNS) if quick else runs
    experiments = {each.problem: each for each in EXPERIMENTS if each.problem in PROBLEMS}
    tasks: list[Task] = []
    for name in chosen_names(only, experiments):
        experiment = experiments[name]
        for n in experiment.counts:
            if quick and n > QUICK_COUNT:
                continue
            for sampler in SAMPLERS:
                if why_not(sampler, n, PROBLEMS[name].set_dim):
                    continue
                here = 1 if sampler == "sukharev" and experiment.whole_sets else runs
                tasks += [
                    Task(name, 0, sampler, n, rule, experiment.search, run, seed)
                    for run in range(here)
                    for rule in experiment.rules
                ]
    return Suite("paper", tuple(tasks))
