"""Many goals in one plan: the nearest first, then all."""

from importlib import import_module

import numpy as np
import pytest

import evenroad as er
from evenroad.planning import plan
from evenroad.planning.arm_trees import connect, shorten
from evenroad.roadmap import Budget
from evenroad.robot import ArmWorld, in_scene, load_robot, load_scene
from evenroad.space.path import path_length
from tests.robots.kernel_arms import random_scene


def free(world, count, seed):
    q = world.space.from_cube(np.random.default_rng(seed).random((20 * count, world.space.dim)))
    return q[world.valid(q)][:count]


def reach():
    """Return the shipped arm at its box, where it rests, and where it reaches."""
    scene = load_scene("box-reach")
    world = ArmWorld(in_scene(load_robot("ur5"), scene), scene)
    return world, *(world.robot.configuration(name, scene) for name in ("home", "inside"))


def test_a_near_goal_is_chosen_where_trees_that_are_led_to_all_meet_a_far_one():
    longer, better = [], []
    for seed in range(6):
        world = ArmWorld(load_robot("arm7"), random_scene(seed, count=6, spread=0.9, clear=0.35))
        start, *goals = free(world, 13, seed)
        goals = np.array(goals)
        budget = Budget(seconds=20, motions=3000)
        chosen = plan(world, start, goals, limits=budget)
        assert chosen.solved
        assert chosen.path[-1].tolist() == goals[chosen.goal_index].tolist()
        assert world.validate(chosen.path).all()
        at_once = connect(world, start, goals, most_motions=3000, seconds=20)
        longer.append(path_length(shorten(world, at_once.path)[0], world.space) / chosen.cost)
        alone = [plan(world, start, goal, limits=budget) for goal in goals]
        better.append(chosen.cost / min(one.cost for one in alone if one.solved))
    assert np.mean(longer) > 1.05
    assert np.mean(better) < 1.1


def test_a_nearest_goal_that_is_not_reached_soon_gives_way_to_all(monkeypatch):
    world = ArmWorld(load_robot("arm7"), random_scene(2, count=6, spread=0.9, clear=0.35))
    start, *goals = free(world, 7, 2)
    goals = np.array([goal for goal in goals if not world.motion_valid(start[None], goal[None])[0]])
    monkeypatch.setattr(import_module("evenroad.planning.planners.trees"), "TO_NEAREST", 1)
    result = plan(world, start, goals, smooth="quick")
    alone = connect(world, start, goals, most_motions=10**6, seconds=20)
    assert (result.solved, result.goal_index) == (True, alone.goal)
    np.testing.assert_array_equal(result.path, shorten(world, alone.path)[0])
    # What was asked in vain counts.
    assert result.counts["edges_checked"] == alone.motions + 1


def test_a_goal_that_is_near_and_cannot_be_reached_does_not_keep_from_others():
    world, start, inside = reach()
    blocked = start + 0.01
    blocked[2] = 3.0
    assert not world.valid(blocked[None])[0]
    result = plan(world, start, np.array([blocked, inside]), seconds=20)
    assert (result.status, result.goal_index) == (er.Status.SOLVED, 1)


@pytest.mark.parametrize("smooth", [True, False])
def test_the_same_goals_give_the_same_path_in_any_order(smooth):
    world = ArmWorld(load_robot("arm7"), random_scene(3, count=6, spread=0.9, clear=0.35))
    start, *goals = free(world, 9, 5)
    options = dict(seconds=20, smooth=smooth)
    one = plan(world, start, np.array(goals), **options)
    other = plan(world, start, np.array(goals[::-1]), **options)
    assert one.path.tolist() == other.path.tolist()
    assert one.goal_index == len(goals) - 1 - other.goal_index


def test_a_start_in_collision_and_motions_that_do_not_suffice_are_answers():
    world, start, inside = reach()
    goals = np.array([inside, inside])
    few = plan(world, start, goals, seconds=9, limits={"motions": 2})
    assert few.status is er.Status.BUDGET_SPENT
    # One search has spent it all: there is no other, with a budget of its own.
    assert few.counts["edges_checked"] == connect(world, start, goals[:1], most_motions=2).motions
    folded = start.copy()
    folded[2] = 3.0
    bad = plan(world, folded, goals, seconds=9)
    assert bad.status is er.Status.START_INVALID
