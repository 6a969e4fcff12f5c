"""The cheapest of many goals, found in one plan."""

import numpy as np
import pytest

import evenroad as er
from evenroad.arms import find_cheapest
from evenroad.roadmap import Budget, find_path
from evenroad.robot import ArmWorld, in_scene, load_robot, load_scene
from tests.robot.kernel_arms import random_scene


def free(world, count, seed):
    q = world.space.from_cube(np.random.default_rng(seed).random((20 * count, world.space.dim)))
    return q[world.valid(q)][:count]


def test_no_goal_alone_is_much_cheaper_than_the_one_that_is_chosen():
    better, first = [], []
    for seed in range(6):
        world = ArmWorld(load_robot("arm7"), random_scene(seed, count=6, spread=0.9, clear=0.35))
        start, *goals = free(world, 13, seed)
        goals = np.array(goals)
        budget = Budget(seconds=20, motions=3000)
        chosen = find_cheapest(world, start, goals, budget=budget, shorten=True, improve=False)
        assert chosen.solved
        assert chosen.path[-1].tolist() == goals[chosen.goal_index].tolist()
        assert world.recheck(chosen.path).all()
        alone = [find_path(world, start, goal, budget=budget) for goal in goals]
        better.append(chosen.cost / min(one.cost for one in alone if one.solved))
        first.append(find_path(world, start, goals, budget=budget).cost / chosen.cost)
    assert np.mean(better) < 1.1
    assert np.mean(first) > 1.0


def test_a_goal_that_is_near_and_cannot_be_reached_does_not_keep_from_others():
    scene = load_scene("box-reach")
    world = ArmWorld(in_scene(load_robot("ur5"), scene), scene)
    start = er.configuration(world.robot, "home", scene)
    inside = er.configuration(world.robot, "inside", scene)
    blocked = start + 0.01
    blocked[2] = 3.0
    assert not world.valid(blocked[None])[0]
    result = find_cheapest(
        world, start, np.array([blocked, inside]), budget=Budget(seconds=20), shorten=True, improve=False
    )
    assert (result.status, result.goal_index) == (er.Status.SOLVED, 1)


@pytest.mark.parametrize("shorten", [True, False])
def test_the_same_goals_give_the_same_path_in_any_order(shorten):
    world = ArmWorld(load_robot("arm7"), random_scene(3, count=6, spread=0.9, clear=0.35))
    start, *goals = free(world, 9, 5)
    options = dict(budget=Budget(seconds=20), shorten=shorten, improve=False)
    one = find_cheapest(world, start, np.array(goals), **options)
    other = find_cheapest(world, start, np.array(goals[::-1]), **options)
    assert one.path.tolist() == other.path.tolist()
    assert one.goal_index == len(goals) - 1 - other.goal_index


def test_a_start_in_collision_and_motions_that_do_not_suffice_are_answers():
    scene = load_scene("box-reach")
    world = ArmWorld(in_scene(load_robot("ur5"), scene), scene)
    start = er.configuration(world.robot, "home", scene)
    inside = er.configuration(world.robot, "inside", scene)
    goals = np.array([inside, inside])
    few = find_cheapest(world, start, goals, budget=Budget(motions=2, seconds=9), shorten=True, improve=False)
    assert few.status is er.Status.BUDGET_SPENT
    # One search has spent it all: there is no other, with a budget of its own.
    assert few.counts["edges_checked"] == world.connect(start, goals[:1], most_motions=2).motions
    folded = start.copy()
    folded[2] = 3.0
    bad = find_cheapest(world, folded, goals, budget=Budget(seconds=9), shorten=True, improve=False)
    assert bad.status is er.Status.START_INVALID
