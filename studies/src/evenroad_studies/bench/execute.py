"""Running one task in this process, within a limit on its time.

The same task gives the same outcome, in any process and in any order, on one kind of processor: elsewhere the last bits
of computed sets may differ.  Roadmap and search are those of :func:`evenroad.roadmap.plan`, without what a benchmark
does not measure: a shorter path afterwards, and the strict check of that path.
"""

from __future__ import annotations

import signal
import threading
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.roadmap.search import FREE, EdgeStates
from evenroad_studies.bench.samplers import draw_set
from evenroad_studies.bench.searches import Finding, search_named
from evenroad_studies.bench.task import Outcome, Problem, Task
from evenroad_studies.problems import source_named
from evenroad_studies.rules import rule_named


def run_task(task: Task, limit: float | None = None) -> Outcome:
    """Run one task; whatever goes wrong is an outcome, too: ``failed``, or ``timeout`` after `limit` seconds.

    What the next task is likely to need again is kept for the process: the last problems, and the valid milestones of
    the last set.  So tasks should come with the rules of one set, and the sets of one random problem, side by side.
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
    _warm_up(task, problem)
    milestones, set_id, validity_seconds = _milestones(
        task.problem,
        task.instance,
        task.sampler,
        task.n,
        task.run,
        task.seed,
        task.rule if task.sampler == "even" else "",
    )
    began = time.perf_counter()
    ends_free = problem.world.valid(np.stack([problem.start, problem.goal]))
    if not ends_free.all():
        status = "goal_invalid" if ends_free[0] else "start_invalid"
        return Outcome(status, valid=len(milestones), set_id=set_id, seconds=validity_seconds)
    finding, states = _search(problem, milestones, task.rule, task.search)
    return Outcome(
        status="solved" if finding.solved else "not_connected",
        valid=len(milestones),
        valid_at_solution=finding.valid_at_solution,
        edges_checked=states.motions_checked,
        length=finding.length,
        seconds=validity_seconds + time.perf_counter() - began,
        set_id=set_id,
    )


def _search(problem: Problem, milestones: Floats, rule: str, search: str) -> tuple[Finding, EdgeStates]:
    configurations = np.concatenate([milestones, problem.start[np.newaxis], problem.goal[np.newaxis]])
    edges = rule_named(rule).edges(configurations, problem.world.space, terminals=2)
    states = EdgeStates(problem.world, configurations, edges)
    states.node_states[:] = FREE
    return search_named(search)(states), states


@lru_cache(maxsize=16)
def _problem(name: str, instance: int) -> Problem:
    return source_named(name).make(instance)


@lru_cache(maxsize=1)
def _milestones(
    problem: str, instance: int, sampler: str, n: int, run: int, seed: int, rule: str
) -> tuple[Floats, str, float]:
    """Return what searches share: a set's valid configurations, its id, and the seconds of validity.

    All rules do, too, but where the set depends on the `rule`; "" if it does not.
    """
    of_set, of_missing = np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2)
    here = _problem(problem, instance)
    space = here.world.space
    use = (space, rule_named(rule)) if rule and here.set_dim == space.cube_dim else None
    points, set_id = draw_set(sampler, n, here.set_dim, run, np.random.default_rng(of_set), use)
    configurations = here.configurations(points, np.random.default_rng(of_missing))
    began = time.perf_counter()
    valid = configurations[here.world.valid(configurations)]
    seconds = time.perf_counter() - began
    valid.setflags(write=False)
    return valid, set_id, seconds


_warm: set[tuple[str, str, str]] = set()


def _warm_up(task: Task, problem: Problem) -> None:
    """Let compiled code be loaded before the clock runs: it takes longer than a task."""
    kind = task.problem, task.rule, task.search
    if kind not in _warm:
        cube = np.random.default_rng(0).random((8, problem.world.space.cube_dim))
        configurations = problem.world.space.from_cube(cube)
        problem.world.valid(configurations)
        _search(problem, configurations, task.rule, task.search)
        _warm.add(kind)


DEFAULT_LIMIT = 600.0
"""Seconds for a task; the slowest of the suites take less than one."""
LONGEST_LIMIT = 1e6
"""Seconds; the clocks of some platforms take no much larger number."""


class OverTime(BaseException):
    """The time is over.  No Exception, so that code in the block that catches those does not swallow it."""


def require_limit(seconds: float | None) -> None:
    """Raise InvalidValue unless this is a limit in (0, 10^6] s, or None for no limit."""
    if seconds is not None and require_positive("limit", seconds) > LONGEST_LIMIT:
        raise InvalidValue(f"limit must be at most {LONGEST_LIMIT:g} s, got {seconds!r}")


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Raise OverTime in the block after so many seconds, by a SIGALRM: where there is none nothing is limited.

    Nor is it outside of the main thread, and compiled code is not interrupted: the error comes when it returns.
    """
    here = threading.current_thread() is threading.main_thread()
    if seconds is None or not here or not hasattr(signal, "SIGALRM"):
        yield
        return

    def ring(number: int, frame: object) -> None:
        raise OverTime

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
