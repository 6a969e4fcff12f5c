"""Running one task in this process: the same task gives the same outcome, in any process and any order."""

from __future__ import annotations

import time
import traceback
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from evenroad.research.bench.outcome import Outcome
from evenroad.research.bench.problem import Problem
from evenroad.research.bench.samplers import draw_set
from evenroad.research.bench.searches import Finding, search_named
from evenroad.research.bench.task import Task
from evenroad.research.bench.time_limit import OverTime, time_limit
from evenroad.research.problems import source_named
from evenroad.roadmap import rule_named
from evenroad.roadmap.search import FREE, EdgeStates

Milestones = tuple[npt.NDArray[np.float64], str, float]
"""The valid configurations of a set, which set it is, and the seconds that their validity took."""


def run_task(task: Task, limit: float | None = None) -> Outcome:
    """Run one task; whatever goes wrong is an outcome, too.

    What the next task is likely to need again is kept for the process: fixed problems, the last random one, and the
    valid milestones of the last set.  So tasks should come with the rules of one set, and the sets of one random
    problem, side by side.

    Parameters
    ----------
    task : Task
        What to run.
    limit : float, optional
        Seconds after which the task is given up, where the platform can (see :func:`time_limit`).

    Returns
    -------
    Outcome
        Of status ``failed``, with a traceback, for any exception; ``timeout`` when it took too long.
    """
    try:
        with time_limit(limit):
            return _run(task)
    except OverTime:
        return Outcome(status="timeout", error=f"took longer than {limit:g} s")
    except Exception:
        return Outcome(status="failed", error=traceback.format_exc())


def _run(task: Task) -> Outcome:
    problem = _problem(task.problem, task.instance)
    _warm_up(task.problem, task.rule, task.search, problem)
    milestones, set_id, validity_seconds = _milestones(
        task.problem, task.instance, task.sampler, task.n, task.run, task.seed
    )
    began = time.perf_counter()
    ends_free = problem.world.valid(np.stack([problem.start, problem.goal]))
    if not ends_free.all():
        status = "goal_invalid" if ends_free[0] else "start_invalid"
        return Outcome(status, valid=len(milestones), set_id=set_id, seconds=validity_seconds)
    finding, ledger = _search(problem, milestones, task.rule, task.search)
    return Outcome(
        status="solved" if finding.solved else "not_connected",
        valid=len(milestones),
        valid_at_solution=finding.valid_at_solution,
        edges_checked=ledger.motions_checked,
        length=finding.length,
        seconds=validity_seconds + time.perf_counter() - began,
        set_id=set_id,
    )


def _search(
    problem: Problem, milestones: npt.NDArray[np.float64], rule: str, search: str
) -> tuple[Finding, EdgeStates]:
    configurations = np.concatenate([milestones, problem.start[np.newaxis], problem.goal[np.newaxis]])
    edges = rule_named(rule).edges(configurations, problem.world.space, ends=2)
    ledger = EdgeStates(problem.world, configurations, edges)
    ledger.node_states[:] = FREE
    return search_named(search)(ledger), ledger


def _problem(name: str, instance: int) -> Problem:
    return _random_problem(name, instance) if source_named(name).random else _fixed_problem(name)


@lru_cache(maxsize=16)
def _fixed_problem(name: str) -> Problem:
    return source_named(name).make(0)


@lru_cache(maxsize=1)
def _random_problem(name: str, instance: int) -> Problem:
    return source_named(name).make(instance)


@lru_cache(maxsize=1)
def _milestones(problem: str, instance: int, sampler: str, n: int, run: int, seed: int) -> Milestones:
    """Return what all rules and searches share: the same arguments are the same set in the same problem."""
    of_set, of_missing = np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2)
    here = _problem(problem, instance)
    points, set_id = draw_set(sampler, n, here.set_dim, run, np.random.default_rng(of_set))
    configurations = here.configurations(points, np.random.default_rng(of_missing))
    began = time.perf_counter()
    valid = configurations[here.world.valid(configurations)]
    seconds = time.perf_counter() - began
    valid.setflags(write=False)
    return valid, set_id, seconds


_warm: set[tuple[str, str, str]] = set()


def _warm_up(name: str, rule: str, search: str, problem: Problem) -> None:
    """Let compiled code be loaded before the clock runs: it takes longer than a task."""
    if (name, rule, search) in _warm:
        return
    cube = np.random.default_rng(0).random((8, problem.world.space.cube_dim))
    configurations = problem.world.space.from_cube(cube)
    problem.world.valid(configurations)
    _search(problem, configurations, rule, search)
    _warm.add((name, rule, search))
