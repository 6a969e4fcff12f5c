"""Problems for arms: they can be solved, but not by chance; what chooses constants and what is reported are apart."""

from itertools import product

import numpy as np
import pytest

from evenroad.datasets.random_scenes import GENERATORS, cell_of
from evenroad.planning.arm_trees import connect
from evenroad.robot import ArmWorld
from evenroad_studies.arms.problems import ARM_ROBOTS, PREFIXES, RANGES, draw_problem, problem_name, robot_and_generator
from evenroad_studies.arms.robots import ARMS, arm_named
from evenroad_studies.bench.execute import run_task
from evenroad_studies.problems import PROBLEMS
from evenroad_studies.suites import arms_suite


@pytest.mark.parametrize("robot", ["scara", "twoarm"])
@pytest.mark.parametrize("generator", ["shelf", "boxes"])
def test_a_problem_has_free_ends_that_no_straight_motion_joins_and_that_trees_do(robot, generator):
    problem = draw_problem(robot, generator, "tune", 0)
    ends = np.stack([problem.start, problem.goal])
    assert problem.world.valid(ends).all()
    assert not problem.world.motion_valid(ends[:1], ends[1:])[0]
    found = connect(problem.world, problem.start, problem.goal[np.newaxis])
    assert found.goal == 0
    assert problem.world.validate(found.path).all()


def test_the_same_number_is_the_same_problem_and_another_one_is_not():
    first, other = (draw_problem.__wrapped__("scara", "clutter", "tune", i) for i in (0, 1))
    again = draw_problem.__wrapped__("scara", "clutter", "tune", 0)
    assert again.start.tolist() == first.start.tolist()
    assert again.world.scene == first.world.scene
    assert first.start.tolist() != other.start.tolist()


def test_the_two_streams_differ_in_every_parameter_or_in_none_that_counts():
    tune, report = RANGES["tune"], RANGES["report"]
    same = [name for name in tune._fields if getattr(tune, name) == getattr(report, name)]
    assert same == []


def test_names_of_problems_say_whose_they_are():
    for stream in PREFIXES:
        for robot in ARM_ROBOTS:
            for generator in GENERATORS:
                name = problem_name(robot, generator, stream)
                assert robot_and_generator(name) == (robot, generator)
                assert PROBLEMS[name].set_dim == ARM_ROBOTS[robot]


@pytest.mark.parametrize("robot", ARMS)
def test_robots_have_the_joints_that_lists_say_and_are_free_somewhere_in_their_cell(robot):
    arm = arm_named(robot)
    world = ArmWorld(arm, cell_of(arm))
    assert world.space.dim == ARM_ROBOTS[robot]
    q = world.space.from_cube(np.random.default_rng(0).random((400, world.space.dim)))
    assert 0.1 < world.valid(q).mean() <= 1.0


def test_the_suite_has_every_robot_generator_and_sampler_each_task_once():
    tasks = arms_suite(2).tasks
    assert len({task.key for task in tasks}) == len(tasks)
    assert {task.problem for task in tasks} == {problem_name(*pair) for pair in product(ARM_ROBOTS, GENERATORS)}
    assert {"uniform", "even", "sobol scrambled"} <= {task.sampler for task in tasks}
    one = next(task for task in arms_suite(1, only=["arm-scara-shelf"]).tasks if task.sampler == "even")
    assert run_task(one).status in ("solved", "not_connected")
