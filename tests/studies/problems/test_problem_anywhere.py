"""Worlds with start and goal anywhere: what bounds them, and where they are freer."""

import numpy as np
import pytest

from evenroad_studies.problems.anywhere import ARMS, SIZES, Kind, Use, blocks, is_here, make


@pytest.mark.parametrize("use", Use)
@pytest.mark.parametrize("kind", [kind for kind in Kind if is_here(kind)])
def test_start_and_goal_are_free_and_no_straight_motion_joins_them(use, kind):
    d = ARMS[kind][1] if kind in ARMS else 3
    problem = make(use, kind, d, SIZES[use, kind, d], 5)
    start, goal = problem.start[None], problem.goal[None]
    assert problem.world.valid(start)[0]
    assert problem.world.valid(goal)[0]
    assert not problem.world.motion_valid(start, goal)[0]
    np.testing.assert_array_equal(make(use, kind, d, SIZES[use, kind, d], 5).start, problem.start)


@pytest.mark.parametrize(("beyond", "freer"), [(0.0, True), (1.0, False)])
def test_the_faces_are_freer_only_if_all_centres_lie_in_the_cube(beyond, freer):
    rng = np.random.default_rng(1)
    middle, near = 0.4 + 0.2 * rng.random((2000, 4)), 0.05 * rng.random((2000, 4))
    free = np.array(
        [
            [world.valid(middle).mean(), world.valid(near).mean()]
            for world in (blocks(beyond, Use.TUNING, 4, 0.25, np.random.default_rng(i)) for i in range(40))
        ]
    )
    inside, at_faces = free.mean(axis=0)
    error = free.std(axis=0).max() / np.sqrt(len(free))
    assert (at_faces > inside + 4.0 * error) == freer
