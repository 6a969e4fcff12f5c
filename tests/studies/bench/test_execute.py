"""One task: always the same outcome, and whatever goes wrong is an outcome."""

import contextlib
import time
from dataclasses import replace

import numpy as np
import pytest

from evenroad.space import BoxSpace
from evenroad.world import FunctionWorld
from evenroad_studies.bench import execute
from evenroad_studies.bench.execute import OverTime, run_task, time_limit
from evenroad_studies.bench.samplers import SAMPLERS, draw_set
from evenroad_studies.bench.task import Problem, ProblemSource, Task
from evenroad_studies.problems import PROBLEMS, source_named
from evenroad_studies.rules import rule_named
from evenroad_studies.worlds import Corridor
from tests.plan_on import plan_on

TASK = Task("corridor-2d-0.1", 0, "uniform", 256, "k=10 symmetrised", "full", 3, 7)


def _steady(outcome):
    """Return an outcome without its clock, comparable."""
    return repr(replace(outcome, seconds=0.0))


@pytest.fixture
def problems(monkeypatch):
    """Let a test name problems of its own."""

    def add(name, make, random=False, set_dim=2):
        source = ProblemSource(name, set_dim, make, random)
        monkeypatch.setitem(PROBLEMS, name, source)

    yield add
    for cache in (execute._problem, execute._milestones, execute._warm):
        cache.cache_clear() if hasattr(cache, "cache_clear") else cache.clear()


def test_a_task_gives_what_plan_gives_for_its_set():
    outcome = run_task(TASK)
    problem = source_named(TASK.problem).make(0)
    of_set, _ = np.random.SeedSequence(TASK.seed, spawn_key=(TASK.run,)).spawn(2)
    points, _ = draw_set(TASK.sampler, TASK.n, 2, TASK.run, np.random.default_rng(of_set))
    result = plan_on(
        problem.world, problem.start, problem.goal, points, rule=rule_named(TASK.rule), links=None, smooth=False
    )
    assert outcome.status == str(result.status) == "solved"
    assert outcome.valid == result.counts["valid"]
    assert outcome.edges_checked == result.counts["edges_checked"]
    assert outcome.length == pytest.approx(result.milestone_cost, rel=1e-12)
    assert outcome.seconds > 0


def test_outcomes_do_not_depend_on_what_was_run_before():
    tasks = [
        replace(TASK, sampler=sampler, run=run, rule=rule, search=search)
        for sampler in ("uniform", "hickernell", "halton paper-blocks")
        for run in range(3)
        for rule, search in (("k=10 earlier", "stock"), ("k=4 symmetrised", "lazy"))
    ]
    forwards = {task: _steady(run_task(task)) for task in tasks}
    backwards = {task: _steady(run_task(task)) for task in reversed(tasks)}
    assert forwards == backwards


def test_runs_of_a_block_protocol_are_other_points_of_one_sequence_whatever_the_seed():
    task = replace(TASK, sampler="halton paper-blocks")
    by_seed = [[_steady(run_task(replace(task, run=run, seed=seed))) for run in range(4)] for seed in (1, 2)]
    assert by_seed[0] == by_seed[1]
    assert len(set(by_seed[0])) > 1


@pytest.mark.parametrize(
    ("start", "goal", "status"), [((0.5, 0.5), (1.0, 1.0), "start_invalid"), ((0.0, 0.0), (0.5, 0.5), "goal_invalid")]
)
def test_an_end_in_collision_is_an_answer(problems, start, goal, status):
    problems("blocked", lambda instance: Problem(Corridor(2, 0.1), np.array(start), np.array(goal), 2))
    assert run_task(replace(TASK, problem="blocked")).status == status


def test_coordinates_that_the_set_does_not_give_are_drawn_anew_in_every_run(problems):
    world = FunctionWorld(BoxSpace([0.0] * 3, [1.0] * 3), lambda q: q[:, 2] < 0.5, 0.1)
    problems("partly", lambda instance: Problem(world, np.full(3, 0.1), np.full(3, 0.2), 2))
    task = replace(TASK, problem="partly", sampler="halton paper-blocks", n=64)
    valid = [run_task(replace(task, run=run)).valid for run in range(6)]
    assert len(set(valid)) > 1
    assert all(16 <= each <= 48 for each in valid)


def test_a_random_problem_is_made_once_for_all_tasks_of_its_instance(problems):
    made = []

    def make(instance):
        made.append(instance)
        return Problem(Corridor(2, 0.1 + 0.1 * instance), np.zeros(2), np.ones(2), 2)

    problems("stream", make, random=True)
    for instance in (0, 1):
        for rule in ("k=4 symmetrised", "k=10 symmetrised"):
            run_task(replace(TASK, problem="stream", instance=instance, rule=rule))
    assert made == [0, 1]


def test_rules_share_a_set_and_its_validity(problems, monkeypatch):
    drawn = []
    uniform = SAMPLERS["uniform"]

    def draw(family, n, d, run, rng, use):
        drawn.append(run)
        return uniform.draw(family, n, d, run, rng, use)

    monkeypatch.setitem(SAMPLERS, "uniform", uniform._replace(draw=draw))
    for run in (100, 101):
        for k in (4, 6, 10):
            run_task(replace(TASK, run=run, rule=f"k={k} symmetrised"))
    assert drawn == [100, 101]


def test_an_exception_is_a_row_with_its_traceback(problems):
    def broken(q):
        raise RuntimeError("the checker fell over")

    world = FunctionWorld(BoxSpace([0.0] * 2, [1.0] * 2), broken, 0.1)
    problems("broken", lambda instance: Problem(world, np.zeros(2), np.ones(2), 2))
    outcome = run_task(replace(TASK, problem="broken"))
    assert (outcome.status, outcome.solved, outcome.valid) == ("failed", False, 0)
    assert "Traceback" in outcome.error
    assert "the checker fell over" in outcome.error


@pytest.mark.parametrize(("change", "says"), [
    ({"problem": "nonsense"}, "unknown problem 'nonsense'; known: "),
    ({"sampler": "nonsense"}, "unknown sampler 'nonsense'; known: "),
    ({"rule": "nonsense"}, "unknown connection rule 'nonsense'; known: "),
    ({"search": "nonsense"}, "unknown search 'nonsense'; known: "),
    ({"sampler": "hickernell", "n": 100}, "it has n = 16"),
])  # fmt: skip
def test_a_task_of_something_unknown_fails_with_the_list(change, says):
    outcome = run_task(replace(TASK, **change))
    assert outcome.status == "failed"
    assert says in outcome.error


def test_a_task_that_takes_too_long_is_a_row(problems):
    def slow(q):
        with contextlib.suppress(Exception):
            time.sleep(5.0)
        return np.ones(len(q), dtype=bool)

    world = FunctionWorld(BoxSpace([0.0] * 2, [1.0] * 2), slow, 0.1)
    problems("slow", lambda instance: Problem(world, np.zeros(2), np.ones(2), 2))
    began = time.monotonic()
    outcome = run_task(replace(TASK, problem="slow"), limit=0.2)
    assert time.monotonic() - began < 4.0
    assert (outcome.status, outcome.error) == ("timeout", "took longer than 0.2 s")
    assert run_task(TASK, limit=60.0).solved


def test_no_alarm_is_left_behind():
    with time_limit(0.05):
        pass
    time.sleep(0.1)
    with pytest.raises(OverTime), time_limit(0.05):
        time.sleep(5.0)
