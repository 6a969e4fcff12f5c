"""The tasks of the fair suite."""

from itertools import pairwise

import pytest

from evenroad_studies.bench.execute import run_task
from evenroad_studies.bench.samplers import why_not
from evenroad_studies.suites import COUNTS, DIMENSIONS, FAIR_RULES, fair_suite


def test_the_suite_reports_on_fresh_problems_of_every_family():
    names = {task.problem for task in fair_suite(3).tasks}
    assert not any(name.startswith("tune-") for name in names)
    for d in DIMENSIONS:
        assert {f"fair-{family}-{d}d-{share}" for family in ("balls", "boxes") for share in (25, 50, 75)} <= names
    assert {"fair-maze-50", "fair-se2-50", "fair-se3-50"} <= names
    assert "fair-balls-4d-50" not in names


def test_every_task_is_there_once():
    tasks = fair_suite(7).tasks
    assert len({task.key for task in tasks}) == len(tasks)


def test_three_runs_share_a_world_in_which_all_samplers_meet_and_the_one_grid_has_one_run():
    tasks = fair_suite(7, only=["fair-balls-5d-50"]).tasks
    assert all(task.instance == task.run // 3 for task in tasks)
    for sampler in ("uniform", "even", "lattice"):
        runs = {task.run for task in tasks if task.sampler == sampler}
        assert runs == set(range(7))
    tasks = fair_suite(7, only=["fair-balls-2d-50"]).tasks
    assert {task.run for task in tasks if task.sampler == "sukharev"} == {0, 3, 6}


def test_n_varies_and_lazy_search_runs_at_the_middle_difficulty_only():
    tasks = fair_suite(3).tasks
    middle = [task for task in tasks if task.problem == "fair-boxes-7d-50"]
    hard = [task for task in tasks if task.problem == "fair-boxes-7d-25"]
    assert {task.n for task in middle} == set(COUNTS)
    assert {task.n for task in hard} == {512}
    assert {task.rule for task in hard} == set(FAIR_RULES)
    assert {(task.n, task.rule) for task in middle if task.search == "lazy"} == {(512, "k=20 symmetrised")}
    assert {task.run for task in middle if task.search == "lazy"} == {0}
    assert {task.search for task in hard} == {"connect"}


def test_what_shares_a_set_stands_together():
    tasks = fair_suite(7, only=["fair-boxes-3d-50"]).tasks
    sets = [(task.instance, task.sampler, task.n, task.run) for task in tasks]
    assert sum(a != b for a, b in pairwise(sets)) + 1 == len(set(sets))


def test_only_samplers_that_have_a_set_are_asked():
    tasks = fair_suite(3, only=["fair-balls-7d-50"]).tasks
    assert "mpmc" not in {task.sampler for task in tasks}
    assert why_not("mpmc", tasks[0].n, 7)
    assert not any(why_not(task.sampler, task.n, 7) for task in tasks)


def test_a_quick_suite_is_a_part_of_the_whole_one():
    quick, whole = fair_suite(400, quick=True).tasks, fair_suite(30).tasks
    assert 0 < len(quick) < len(whole) / 4
    assert {task.key for task in quick} <= {task.key for task in whole}


@pytest.mark.parametrize("name", ["fair-balls-2d-50", "fair-boxes-3d-25", "fair-maze-75", "fair-se2-50"])
def test_tasks_run(name):
    tasks = [task for task in fair_suite(1, only=[name]).tasks if task.sampler == "uniform" and task.n <= 512]
    outcomes = [run_task(task) for task in tasks]
    assert {each.status for each in outcomes} <= {"solved", "not_connected"}
    assert all(each.valid > 0 for each in outcomes)
