"""Suites: which tasks a benchmark has.

``paper``: the experiments of Chahine et al. 2025, section 4, with more samplers and more runs.  ``fair``: every world
is new, obstacles favour no place, and the difficulty was set by uniform points alone.  Run i plans in world i // 3 with
set i, the same worlds for every sampler, N and rule: samplers are compared world by world.  ``apart``: the same for
worlds where nothing repeats, start and goal at opposite faces.  ``arms``: the same for five robots among obstacles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

from evenroad._checks import require_count, require_known
from evenroad_studies.arms.problems import ARM_PROBLEMS, stream_of
from evenroad_studies.bench.samplers import SAMPLERS, why_not
from evenroad_studies.bench.task import Task
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.problems.apart import COUNTS as APART_COUNTS
from evenroad_studies.problems.apart import DIMENSION as APART_DIMENSION
from evenroad_studies.problems.fair import FAIR_PROBLEMS, FairProblem, Stream

SEED = 1
"""Of the published results: it draws sets.  Widths and mazes were designed with other seeds, random worlds have one."""
COUNTS = (128, 256, 512, 1024)


class Suite(NamedTuple):
    """What to run: tasks in an order that suits caches, by problem and then by set; `name` labels their rows."""

    name: str
    tasks: tuple[Task, ...]


def chosen_names(only: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """Return those of the `known` problem names that `only` asks for, in the order of `known`; all if it is empty."""
    known, wanted = tuple(known), tuple(only)
    for name in wanted:
        require_known("problem of this suite", name, known)
    return tuple(name for name in known if not wanted or name in wanted)


# The paper's experiments.

PAPER_QUICK_RUNS = 40
PAPER_QUICK_COUNT = 256
"""Most runs and points of a quick suite, which is a part of the whole one: its rows serve both."""
STOCK = "k=10 earlier"
"""The connection that the paper's table was made with: OMPL's PRM, start and goal first."""
SYMMETRISED = "k=10 symmetrised"
MAZE_COUNTS = (32, 64, 128, 256, 512, 1024)


class Experiment(NamedTuple):
    """One row of figures: a problem with numbers of points N, and connection rules, each on the same sets.

    `whole_sets` says that sets give all coordinates, so that one set is one outcome; `search` is as in
    :class:`~evenroad_studies.bench.task.Task`.
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

    `runs` are those of every cell; a sampler that has only one outcome there gets one.  `seed` is the root of all
    random numbers; `only` names the problems to keep, all if empty.  `quick` is a taste: at most 40 runs, of at most
    256 points.
    """
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, PAPER_QUICK_RUNS) if quick else runs
    experiments = {each.problem: each for each in EXPERIMENTS if each.problem in PROBLEMS}
    tasks: list[Task] = []
    for name in chosen_names(only, experiments):
        experiment = experiments[name]
        counts = [n for n in experiment.counts if not quick or n <= PAPER_QUICK_COUNT]
        for sampler, n in _cells(name, counts):
            here = 1 if sampler == "sukharev" and experiment.whole_sets else runs
            tasks += [
                Task(name, 0, sampler, n, rule, experiment.search, run, seed)
                for run in range(here)
                for rule in experiment.rules
            ]
    return Suite("paper", tuple(tasks))


def _cells(problem: str, counts: Iterable[int]) -> list[tuple[str, int]]:
    """Return every sampler with every number of points that it has sets of for a problem."""
    set_dim = PROBLEMS[problem].set_dim
    return [(sampler, n) for n in counts for sampler in SAMPLERS if not why_not(sampler, n, set_dim)]


# The fair suite.

DRAWS = 3
"""Sets a world."""
FAIR_RULES = tuple(f"k={k} symmetrised" for k in (4, 6, 10, 20))
LAZY_RULE = "k=20 symmetrised"
"""With this one the lazy search is run, too, on the first set of each world, for the checks that it takes."""
MAIN_DIFFICULTY = 50
"""Where N varies and the lazy search runs; the other difficulties have the N of the calibration."""
DIMENSIONS = (2, 3, 5, 7, 10)
"""Of balls and boxes; others are there for tuning."""
FAIR_QUICK_RUNS = 30


def fair_suite(runs: int = 400, seed: int = SEED, only: Iterable[str] = (), quick: bool = False) -> Suite:
    """Return the tasks of the fair suite with every sampler; parameters as :func:`paper_suite`.

    A quick suite has at most 30 runs, of the middle difficulty and the calibration's N only.
    """
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, FAIR_QUICK_RUNS) if quick else runs
    problems = {name: each for name, each in FAIR_PROBLEMS.items() if _is_reported(each)}
    tasks: list[Task] = []
    for name in chosen_names(only, problems):
        problem = problems[name]
        main = problem.difficulty == MAIN_DIFFICULTY
        if quick and not main:
            continue
        cells = _cells(name, sorted({*COUNTS, problem.n}) if main and not quick else (problem.n,))
        for instance in range(-(-runs // DRAWS)):
            for sampler, n in cells:
                lazy = main and n == problem.n
                tasks += _in_one_world(name, instance, sampler, n, runs, seed, lazy)
    return Suite("fair", tuple(tasks))


def _is_reported(problem: FairProblem) -> bool:
    return problem.stream is Stream.REPORTING and (problem.d in DIMENSIONS or not problem.tuned_on)


def _in_one_world(
    problem: str, instance: int, sampler: str, n: int, runs: int, seed: int, lazy: bool
) -> Iterator[Task]:
    # A second run of the same grid in the same world would be the same outcome.
    draws = 1 if sampler == "sukharev" else DRAWS
    for run in range(DRAWS * instance, min(DRAWS * instance + draws, runs)):
        for rule in FAIR_RULES:
            yield Task(problem, instance, sampler, n, rule, "connect", run, seed)
        if lazy and run % DRAWS == 0:
            yield Task(problem, instance, sampler, n, LAZY_RULE, "lazy", run, seed)


def apart_suite(runs: int = 400, seed: int = SEED, only: Iterable[str] = (), quick: bool = False) -> Suite:
    """Return the tasks of worlds with start and goal apart, every sampler; parameters as :func:`paper_suite`."""
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, FAIR_QUICK_RUNS) if quick else runs
    tasks: list[Task] = []
    for name in chosen_names(only, APART_DIMENSION):
        cells = _cells(name, (APART_COUNTS[APART_DIMENSION[name]],))
        for instance in range(-(-runs // DRAWS)):
            for sampler, n in cells:
                tasks += _in_one_world(name, instance, sampler, n, runs, seed, lazy=False)
    return Suite("apart", tuple(tasks))


ARM_COUNTS = (64, 256)
"""Points in the box of the joints; even the second number leaves half of the problems unsolved."""
ARM_RUNS = 40


def arms_suite(runs: int = ARM_RUNS, seed: int = SEED, only: Iterable[str] = (), quick: bool = False) -> Suite:
    """Return the tasks of the arms with every sampler, each in a new scene; parameters as :func:`paper_suite`."""
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, FAIR_QUICK_RUNS) if quick else runs
    tasks: list[Task] = []
    for name in chosen_names(only, (each.name for each in ARM_PROBLEMS if stream_of(each.name) == "report")):
        cells = _cells(name, ARM_COUNTS)
        tasks += [
            Task(name, run, sampler, n, SYMMETRISED, "connect", run, seed)
            for run in range(runs)
            for sampler, n in cells
        ]
    return Suite("arms", tuple(tasks))


SUITES: dict[str, Callable[..., Suite]] = {
    "paper": paper_suite,
    "fair": fair_suite,
    "apart": apart_suite,
    "arms": arms_suite,
}
"""Name -> how to make it from ``runs``, ``seed``, ``only`` and ``quick``."""
