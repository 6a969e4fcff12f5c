"""Choosing a robot's recipe by random problems."""

from itertools import islice

import numpy as np
import pytest

from evenroad.robot import ArmWorld
from evenroad.robot_roadmap import make, tuning
from evenroad.robot_roadmap.file import load_robot_roadmap, save_robot_roadmap
from evenroad.robot_roadmap.make import joined, make_roadmap
from evenroad.robot_roadmap.recipe import Recipe
from evenroad.robot_roadmap.tuning import random_problems, solved_by, tune_recipe
from tests.robot.kernel_arms import TABLE, ur5


@pytest.fixture(scope="module")
def roadmap():
    return make_roadmap(ur5(joints=4), TABLE, 64, k=6, gamma=0.0, ends=0)


@pytest.fixture(scope="module")
def few(roadmap):
    return joined(roadmap, roadmap.milestones[:8], 4)


@pytest.fixture(scope="module")
def problems(few):
    return list(islice(random_problems(few, np.random.default_rng(0)), 24))


def test_a_random_problem_keeps_the_cell_and_is_solved_by_more_than_a_straight_motion(problems, few):
    assert len(problems) == 24
    assert not solved_by(few, problems).any()
    for scene, start, goal in problems:
        assert scene.obstacles[0] == TABLE.obstacles[0]
        assert scene.allowed == TABLE.allowed
        world = ArmWorld(few.robot, scene)
        assert world.valid(np.stack([start, goal])).all()
        assert not world.motion_certified(start[np.newaxis], goal[np.newaxis], 1e-6)[0]
        assert world.connect(start, goal[np.newaxis]).goal == 0


def test_some_goals_are_in_pockets_and_some_are_not(problems):
    walls = [len(problem.scene.obstacles) for problem in problems]
    assert len(set(walls)) > 2


def test_what_solves_more_problems_is_taken_and_by_how_much_is_said(roadmap, few, monkeypatch):
    monkeypatch.setattr(tuning, "PROBLEMS", 12)
    worse, better = Recipe(0.0, 0), Recipe(2.0, 5)
    made = {worse: few, better: roadmap}.__getitem__

    def tuned(recipes):
        return tune_recipe(few, recipes, made, np.random.default_rng(0))

    recipe, said = tuned([worse, better])
    assert recipe == better
    second = solved_by(roadmap, list(islice(random_problems(few, np.random.default_rng(0)), 24)))
    share = 100.0 * second[12:].mean()
    assert said.startswith(f"gamma 2 of 2 tried: {share:.0f} % of 12 random problems, {share:+.1f} ±")
    assert said.endswith("to gamma 0")
    recipe, said = tuned([better, worse])
    assert recipe == better
    assert "±" not in said


def test_equals_leave_the_first(roadmap, few, monkeypatch):
    monkeypatch.setattr(tuning, "PROBLEMS", 4)
    recipes = [Recipe(1.0, 0), Recipe(3.0, 0)]
    rng = np.random.default_rng(0)
    assert tune_recipe(few, recipes, lambda recipe: roadmap, rng)[0] == recipes[0]


def test_a_robot_for_which_hardly_a_scene_has_a_problem_is_not_tuned(roadmap, monkeypatch):
    # Nobody stands in the way of a robot that few milestones lead anywhere.
    monkeypatch.setattr(tuning, "TRIES", 3)
    monkeypatch.setattr(tuning, "solved_by", lambda roadmap, problems: np.ones(len(problems), dtype=bool))
    recipes = [Recipe(), Recipe(0.0, 0)]
    recipe, said = tune_recipe(roadmap, recipes, lambda recipe: roadmap, np.random.default_rng(0))
    assert recipe == recipes[0]
    assert said == "not tuned: only 0 random problems were found"


def test_tuning_is_the_same_every_time_and_makes_the_roadmap_of_the_recipe_that_it_names(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(tuning, "PROBLEMS", 10)
    monkeypatch.setattr(make, "EASY", 8)
    first, again = (make_roadmap(ur5(joints=4), TABLE, 24, k=4, ends=0, tune=True) for _ in range(2))
    assert first.tuned == again.tuned
    np.testing.assert_array_equal(first.milestones, again.milestones)
    plain = make_roadmap(ur5(joints=4), TABLE, 24, k=4, gamma=first.gamma, ends=first.ends)
    np.testing.assert_array_equal(first.milestones, plain.milestones)
    assert plain.tuned == ""
    save_robot_roadmap(tmp_path / "a.roadmap", first)
    kept = load_robot_roadmap(tmp_path / "a.roadmap")
    assert (kept.gamma, kept.ends, kept.tuned) == (first.gamma, first.ends, first.tuned)
    assert f"gamma {first.gamma:g} of 6 tried" in first.tuned
