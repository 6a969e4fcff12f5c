"""A start or a goal that is enclosed is named."""

from types import SimpleNamespace

import numpy as np

from evenroad.planning import PRM, plan
from evenroad.planning.diagnose import with_reasons
from evenroad.roadmap import Budget
from evenroad.space import BoxSpace
from evenroad.world import FunctionWorld


class Named(FunctionWorld):
    def explain(self, q):
        return f"the ring stands {'left' if q[0] < 0.8 else 'right'} of it"


def ring(q):
    """Free but between two circles around (0.8, 0.5), and on their left side twice as thick."""
    away = np.hypot(q[:, 0] - 0.8, q[:, 1] - 0.5)
    return (away < 0.02) | (away > 0.06)


WORLD = Named(BoxSpace((0, 0), (1, 1)), ring, 0.002)
START, GOAL = (0.2, 0.5), (0.8, 0.5)


def test_the_end_that_is_shut_in_is_named_with_what_touches_most_often():
    result = plan(WORLD, START, GOAL, limits=Budget(samples=64))
    assert result.status == "budget_spent"
    assert "The goal is enclosed: 0 of 128 motions of length 0.04" in result.message
    assert "the ring stands left of it in" in result.message
    assert "the nearest free sample is 0.0" in result.message
    assert "The start" not in result.message
    back = plan(WORLD, GOAL, START, limits=Budget(samples=64))
    assert "The start is enclosed" in back.message
    assert "The goal" not in back.message


def test_of_several_goals_each_is_named_by_its_number():
    goals = np.array([GOAL, (0.8, 0.51)])
    result = plan(WORLD, START, goals, limits=Budget(samples=64))
    assert "Goal 0 is enclosed" in result.message
    assert "Goal 1 is enclosed" in result.message


def test_nothing_is_said_of_a_path_and_without_words_it_is_only_counted():
    solved = plan(WORLD, START, (0.2, 0.6), PRM(16))
    assert with_reasons(WORLD, solved) is solved
    wall = FunctionWorld(BoxSpace((0, 0), (1, 1)), lambda q: np.abs(q[:, 0] - 0.5) > 0.1, 0.01)
    apart = plan(wall, START, (0.9, 0.5), PRM(64))
    assert with_reasons(wall, apart) is apart
    mute = SimpleNamespace(space=WORLD.space, valid=WORLD.valid, motion_valid=WORLD.motion_valid)
    message = with_reasons(mute, plan(mute, START, GOAL, PRM(16))).message
    assert "The goal is enclosed: 0 of 128 motions of length 0.04" in message
    assert " from it are free; the nearest free sample" in message
