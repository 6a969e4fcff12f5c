"""Worlds with start and goal at opposite faces, and roadmaps of them for several k at once."""

import numpy as np
import pytest

import evenroad as er
from evenroad.roadmap import KNearest
from evenroad_studies.connected import connected
from evenroad_studies.problems.apart import COUNTS, FACE, SIZES, Kind, Use, make

KS = (4, 6, 10, 20)


@pytest.mark.parametrize("use", Use)
@pytest.mark.parametrize("kind", Kind)
def test_start_and_goal_are_free_apart_and_no_straight_motion_joins_them(use, kind):
    for d in (2, 4):
        problem = make(use, kind, d, SIZES[use, kind, d], 7)
        start, goal = problem.start[None], problem.goal[None]
        assert problem.world.valid(start)[0]
        assert problem.world.valid(goal)[0]
        assert not problem.world.motion_valid(start, goal)[0]
        if kind is not Kind.CAVE:
            assert np.abs(goal - start).max() >= 1.0 - 2.0 * FACE


def test_a_number_is_one_world_and_tuning_has_others():
    one, same = (make(Use.REPORTING, Kind.BARS, 3, 0.1, 4) for _ in range(2))
    np.testing.assert_array_equal(one.start, same.start)
    np.testing.assert_array_equal(one.world.first, same.world.first)
    assert len(make(Use.TUNING, Kind.BARS, 3, 0.1, 4).world.first) != len(one.world.first)


def test_every_family_has_a_size():
    assert set(SIZES) == {(use, kind, d) for use in Use for kind in Kind for d in COUNTS}


@pytest.mark.parametrize(("kind", "d", "n"), [(Kind.SLOTS, 2, 60), (Kind.ROOMS, 3, 130), (Kind.FOREST, 5, 300)])
def test_all_numbers_of_neighbours_at_once_are_the_plans_one_by_one(kind, d, n):
    for number in range(3):
        problem = make(Use.TUNING, kind, d, SIZES[Use.TUNING, kind, d], number)
        points = er.draw("sobol", n, d, rng=number)
        found = connected(problem, points.points, KS)
        for row, links in enumerate((None, 100)):
            for at, k in enumerate(KS):
                planner = er.PRM(points, rule=KNearest(k), links=links, success_only=True)
                result = er.plan(problem.world, problem.start, problem.goal, planner, smooth=False)
                assert result.solved == found[row, at], (row, k)
