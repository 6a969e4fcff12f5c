"""The suite of arms: its tasks, its rows and what they say."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue, UnknownName
from evenroad_studies.arms.results import ALL, arm_lines
from evenroad_studies.arms.suite import METHODS, arm_tasks
from evenroad_studies.bench.execute import run_task
from evenroad_studies.bench.runner import run_tasks
from evenroad_studies.bench.store import open_store, read_rows
from evenroad_studies.bench.task import Outcome, Task
from evenroad_studies.report.arms import draw_costs, summary_tables
from evenroad_studies.workers import in_process
from tests.refused import refused

SMALL = dict(runs=2, only=["scara", "shelf"], draws=1, counts=[16], samplers=["sobol scrambled", "roadmap", "trees"])


def test_every_task_is_there_once_and_what_shares_a_roadmap_stands_together():
    tasks = arm_tasks(2, only=["ur5-5", "scara"], draws=2, counts=[64, 128], neighbours=[4, 10])
    assert len({task.key for task in tasks}) == len(tasks)
    made = [(t.problem.split("-")[1], t.sampler, t.n, t.rule, t.run) for t in tasks if t.search == "kept"]
    assert sum(a != b for a, b in itertools.pairwise(made)) + 1 == len(set(made))


def test_samplers_without_sets_of_that_size_are_left_out():
    tasks = arm_tasks(1, only=["arm7"], counts=[100], draws=1)
    assert {"mpmc"} & {task.sampler for task in tasks} == set()
    assert {"uniform", "roadmap", "trees"} <= {task.sampler for task in tasks} <= {*METHODS, "trees"}


def test_names_choose_problems_robots_and_generators():
    def chosen(*only):
        return {task.problem for task in arm_tasks(1, only=only, samplers=["trees"])}

    assert chosen("arm-ur5-cage") == {"arm-ur5-cage"}
    assert chosen("scara", "shelf") == {"arm-scara-shelf"}
    assert len(chosen("shelf")) == 5
    assert len(chosen()) == 25
    refused(UnknownName, "robot", chosen, "arm-ur6-cage")
    refused(InvalidValue, "counts", arm_tasks, 1, counts=[4])


def test_a_run_gives_answers_that_are_the_same_again(tmp_path):
    tasks = arm_tasks(**SMALL)
    with open_store(tmp_path / "a.db") as store:
        report = run_tasks("arms", tasks, store, in_process())
    assert (report.finished, report.failures) == (len(tasks), 0)
    rows = read_rows(tmp_path / "a.db")
    assert rows.solved[rows.sampler.is_in(["trees"])].all()
    one = next(task for task in tasks if task.sampler == "roadmap")
    again = run_task(one)
    row = next(
        i
        for i in range(len(rows))
        if (rows.problem[i], rows.instance[i], rows.sampler[i]) == (one.problem, one.instance, "roadmap")
    )
    assert (again.status, again.edges_checked) == (rows.status[row], rows.edges_checked[row])


def test_a_rule_that_is_none_of_kept_roadmaps_is_a_failure_that_says_so():
    outcome = run_task(Task("arm-scara-shelf", 0, "roadmap", 16, "k=10 symmetrised", "kept", 0, 1))
    assert outcome.status == "failed"
    assert "ends=100" in outcome.error


def _store(path, success):
    """Write rows of made-up outcomes: success of (sampler, instance, run)."""
    return _rows(path, [(_task(*run), solved) for run, solved in success.items()])


def _task(sampler, instance, run, n=64):
    return Task("arm-scara-shelf", instance, sampler, n, "k=10 ends=100", "kept", run, 1)


def _rows(path, outcomes):
    """Write rows of (task, whether it is solved), and read them."""
    with open_store(path) as store:
        for task, solved in outcomes:
            store.add("arms", task, Outcome("solved" if solved else "not_connected", seconds=0.001), "here")
    return read_rows(path)


def test_gains_are_paired_by_problem_with_the_standard_error_over_problems(tmp_path):
    rng = np.random.default_rng(0)
    success = {
        (sampler, i, run): bool(rng.random() < share)
        for sampler, share in (("uniform", 0.3), ("roadmap", 0.7))
        for i in range(20)
        for run in range(2)
    }
    lines = arm_lines(_store(tmp_path / "a.db", success))
    line = next(each for each in lines if each.sampler == "uniform" and each.generator == ALL)
    apart = [np.mean([success["roadmap", i, run] - success["uniform", i, run] for run in range(2)]) for i in range(20)]
    assert line.gain == pytest.approx(np.mean(apart))
    assert line.error == pytest.approx(np.std(apart, ddof=1) / np.sqrt(20))
    assert line.p <= line.p_corrected
    assert (line.problems, line.runs) == (20, 40)
    mine = next(each for each in lines if each.sampler == "roadmap")
    assert np.isnan(mine.gain)


def test_draws_that_the_roadmap_does_not_have_are_not_compared(tmp_path):
    success = {("uniform", i, run): run == 1 for i in range(4) for run in range(2)}
    success |= {("roadmap", i, 0): True for i in range(4)}
    lines = arm_lines(_store(tmp_path / "a.db", success))
    line = next(each for each in lines if each.sampler == "uniform" and each.generator == ALL)
    assert (line.gain, line.error) == (1.0, 0.0)


def test_costs_are_drawn_of_the_smallest_a_middle_and_the_largest_roadmap(tmp_path):
    outcomes = [
        (_task("roadmap", i, 0, n), i < solved)
        for n, solved in ((64, 1), (128, 2), (256, 3), (512, 4))
        for i in range(4)
    ]
    figure = draw_costs(_rows(tmp_path / "a.db", outcomes), "scara", "10")
    curves = {line.get_label(): line.get_ydata().tolist() for line in figure.axes[0].lines}
    assert curves == {
        "roadmap, 64": [25.0],
        "roadmap, 256": [25.0, 50.0, 75.0],
        "roadmap, 512": [25.0, 50.0, 75.0, 100.0],
    }


def _table(tables, name):
    return [[entry.text for entry in row] for row in next(t for t in tables if t.name == name).rows]


def test_a_mean_over_robots_is_there_where_all_of_them_were_run(tmp_path):
    outcomes = [
        (replace(_task("roadmap", i, 0, n), problem=f"arm-{robot}-shelf"), i < solved)
        for robot, n, solved in (("scara", 64, 1), ("arm7", 64, 4), ("arm7", 128, 4))
        for i in range(4)
    ]
    lines = arm_lines(_rows(tmp_path / "a.db", outcomes))
    assert _table(summary_tables(lines), "arms-samplers") == [["10", "roadmap", "62.5", "–"]]


def test_samplers_that_no_n_has_for_all_robots_are_left_out_of_the_mean(tmp_path):
    outcomes = [
        (replace(_task(sampler, 0, 0), problem=f"arm-{robot}-shelf"), True)
        for robot, sampler in (("scara", "roadmap"), ("ur5", "roadmap"), ("ur5", "mpmc"))
    ]
    lines = arm_lines(_rows(tmp_path / "a.db", outcomes))
    tables = summary_tables(lines)
    assert [row[1] for row in _table(tables, "arms-samplers")] == ["roadmap"]
    assert tables[0].notes[0].endswith("Not run for all robots: mpmc.")


def test_robots_are_counted_and_not_their_rules_and_without_points_nothing_is_summed_up(tmp_path):
    outcomes = [
        (replace(_task("roadmap", 0, 0, n), problem=f"arm-{robot}-shelf", rule=f"k=10 ends={ends}"), True)
        for robot, n, ends in (("scara", 64, 64), ("scara", 64, 100), ("ur5", 128, 128), ("scara", 128, 128))
    ]
    lines = arm_lines(_rows(tmp_path / "a.db", outcomes))
    assert _table(summary_tables(lines), "arms-samplers") == [["10", "roadmap", "–", "100.0"]]
    trees = Task("arm-scara-shelf", 0, "trees", 0, "-", "trees", 0, 1)
    assert summary_tables(arm_lines(_rows(tmp_path / "b.db", [(trees, True)]))) == ()
