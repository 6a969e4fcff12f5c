"""The paper's suite."""

from itertools import pairwise

import pytest

from evenroad.errors import UnknownName
from evenroad.points import draw
from evenroad.world.gridmap.load import LEVELS, load_maze
from evenroad_studies.bench.samplers import SAMPLERS, why_not
from evenroad_studies.bench.searches import search_named
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.rules import prm_star_gamma, rule_named
from evenroad_studies.suites import EXPERIMENTS, paper_suite


def test_every_cell_has_its_runs_or_a_reason():
    suite = paper_suite(runs=3)
    cells = {}
    for task in suite.tasks:
        cells.setdefault((task.problem, task.n, task.sampler), set()).add(task.run)
    wanted = {
        (each.problem, n, sampler)
        for each in EXPERIMENTS
        if each.problem in PROBLEMS
        for n in each.counts
        for sampler in SAMPLERS
    }
    reasons = {cell: why_not(cell[2], cell[1], PROBLEMS[cell[0]].set_dim) for cell in wanted}
    assert cells.keys() == {cell for cell, reason in reasons.items() if not reason}
    assert 0 < len(cells) < len(wanted)
    assert all(runs == {0, 1, 2} for (_, _, sampler), runs in cells.items() if sampler != "sukharev")


def test_every_task_names_things_that_exist():
    for task in paper_suite(runs=1).tasks:
        assert task.problem in PROBLEMS
        assert why_not(task.sampler, task.n, PROBLEMS[task.problem].set_dim) == ""
        assert str(rule_named(task.rule)) == task.rule
        search_named(task.search)


def test_keys_are_different_and_fewer_runs_and_the_quick_suite_are_part_of_more():
    keys = [task.key for task in paper_suite(runs=3).tasks]
    assert len(set(keys)) == len(keys)
    assert {task.key for task in paper_suite(runs=2).tasks} < set(keys)
    quick, whole = paper_suite(quick=True), paper_suite(runs=40)
    assert {task.key for task in quick.tasks} < {task.key for task in whole.tasks}
    assert max(task.n for task in quick.tasks) <= 256
    assert {task.problem for task in quick.tasks} == {task.problem for task in whole.tasks}


def test_the_one_grid_that_there_is_has_one_run_where_it_is_the_whole_set():
    runs = {}
    for task in paper_suite(runs=5).tasks:
        if task.sampler == "sukharev":
            runs.setdefault(task.problem, set()).add(task.run)
    assert runs["maze-1"] == {0}
    assert runs["twistycool"] == set(range(5))


def test_rules_and_samplers_of_one_problem_stand_together():
    problems = [task.problem for task in paper_suite(runs=2).tasks]
    changes = sum(a != b for a, b in pairwise(problems))
    assert changes == len(set(problems)) - 1


def test_the_published_table_is_made_with_stock_prm_and_mazes_and_arms_are_symmetrised():
    rules = {}
    for task in paper_suite(runs=1).tasks:
        rules.setdefault(task.problem, []).append((task.rule, task.search))
    assert set(rules["hypercube-legacy6"]) == {("k=10 earlier", "stock")}
    assert rules["ur5-c"][0] == ("k=10 symmetrised", "connect")
    assert rules["maze-1"][0] == ("k=10 symmetrised", "connect")


@pytest.mark.parametrize("level", LEVELS)
def test_the_radius_of_a_maze_is_that_of_prm_star_for_its_free_area(level):
    world = load_maze(level).world()
    free = float(world.valid(world.space.from_cube(draw("sobol", 2**14, 2).points)).mean())
    (experiment,) = (each for each in EXPERIMENTS if each.problem == f"maze-{level}")
    assert rule_named(experiment.rules[1]).gamma == pytest.approx(prm_star_gamma(2, free * 640 * 480), abs=2)


def test_only_keeps_the_problems_named():
    suite = paper_suite(runs=1, only=["hypercube-legacy6", "maze-2"])
    assert {task.problem for task in suite.tasks} == {"hypercube-legacy6", "maze-2"}
    with pytest.raises(UnknownName, match="unknown problem of this suite 'nonsense'; known: .*maze-1"):
        paper_suite(only=["nonsense"])
