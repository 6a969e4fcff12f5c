"""The tasks of the suite whose starts and goals are at opposite faces."""

from evenroad_studies.bench.execute import run_task
from evenroad_studies.problems.apart import COUNTS, Kind
from evenroad_studies.suites import FAIR_RULES, apart_suite


def test_every_kind_of_world_is_asked_in_every_dimension_and_each_task_is_there_once():
    tasks = apart_suite(4).tasks
    assert {task.problem for task in tasks} == {f"apart-{kind.name.lower()}-{d}d" for kind in Kind for d in COUNTS}
    assert len({task.key for task in tasks}) == len(tasks)
    assert {task.rule for task in tasks} == set(FAIR_RULES)
    assert all(task.instance == task.run // 3 for task in tasks)
    assert {task.key for task in apart_suite(quick=True).tasks} <= {task.key for task in apart_suite(30).tasks}


def test_tasks_run_in_the_same_world_for_every_sampler():
    tasks = [task for task in apart_suite(1, only=["apart-slots-3d"]).tasks if task.rule == "k=20 symmetrised"]
    statuses = {task.sampler: run_task(task).status for task in tasks if task.sampler in ("uniform", "even")}
    assert set(statuses.values()) <= {"solved", "not_connected"}
    assert len(statuses) == 2
