"""The fair suite: every world new, obstacles that favour no place, difficulty set by uniform points alone.

Run i plans in world i // 3 with set i: three sets a world, the same worlds for every sampler, N and rule.  So outcomes
come in clusters of three, and comparisons are paired by world.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from evenroad._checks import require_count
from evenroad.research.bench.samplers import SAMPLERS, why_not
from evenroad.research.bench.task import Task
from evenroad.research.problems import PROBLEMS
from evenroad.research.problems.fair import FAIR_PROBLEMS, FairProblem
from evenroad.research.problems.fair.streams import Stream
from evenroad.research.suites.suite import Suite, chosen_names

SEED = 1
"""Of the published results: it draws sets; worlds have a root of their own."""

DRAWS = 3
"""Sets a world."""

RULES = tuple(f"k={k} symmetrised" for k in (4, 6, 10, 20))

LAZY_RULE = "k=20 symmetrised"
"""With this one the lazy search is run, too, on the first set of each world, for the checks that it takes."""

MAIN_DIFFICULTY = 50
"""Where N varies and the lazy search runs; the other difficulties have the N of the calibration."""

COUNTS = (128, 256, 512, 1024)

DIMENSIONS = (2, 3, 5, 7, 10)
"""Of balls and boxes; others are there for tuning."""

QUICK_RUNS = 30


def fair_suite(runs: int = 400, seed: int = SEED, only: Iterable[str] = (), quick: bool = False) -> Suite:
    """Return the tasks of the fair suite with every sampler.

    Parameters
    ----------
    runs : int
        Runs of every cell, three in each world; the one Sukharev grid that there may be has one run a world.
    seed : int
        Root of the random numbers that draw the sets, >= 0.
    only : iterable of str
        Problems to keep; all if empty.
    quick : bool
        A taste: at most 30 runs, the middle difficulty and the calibration's N only.

    Raises
    ------
    InvalidValue
        If `runs` or `seed` is no such integer.
    UnknownName
        If `only` names a problem that the suite does not have; the text lists those that it has.
    """
    runs, seed = require_count("runs", runs), require_count("seed", seed, at_least=0)
    runs = min(runs, QUICK_RUNS) if quick else runs
    problems = {name: each for name, each in FAIR_PROBLEMS.items() if _is_reported(each)}
    tasks: list[Task] = []
    for name in chosen_names(only, problems):
        problem = problems[name]
        main = problem.difficulty == MAIN_DIFFICULTY
        if quick and not main:
            continue
        counts = tuple(sorted({*COUNTS, problem.n})) if main and not quick else (problem.n,)
        cells = [
            (sampler, n)
            for n in counts
            for sampler in SAMPLERS
            if not why_not(sampler, n, PROBLEMS[name].set_dim)
        ]
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
        for rule in RULES:
            yield Task(problem, instance, sampler, n, rule, "connect", run, seed)
        if lazy and run % DRAWS == 0:
            yield Task(problem, instance, sampler, n, LAZY_RULE, "lazy", run, seed)
