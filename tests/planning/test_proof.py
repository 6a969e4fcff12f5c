"""Where a world's check of motions has gaps, no path is handed out that its strict check does not confirm."""

from functools import partial

import numpy as np
import pytest

from evenroad.planning import Status
from evenroad.planning.shortcut import shortcut
from evenroad.points import draw
from evenroad.roadmap import Budget, KNearest
from evenroad.roadmap.build import roadmap_of_points
from evenroad.roadmap.search import confirmed
from evenroad.space.path import path_length
from evenroad.world import GridMap
from tests.counting import Counting
from tests.plan_on import fmt_on, plan_growing, plan_on
from tests.planning.gappy import GappyWorld

# A slalom: the way from the lower left to the upper right goes round the free ends of four thin walls.
SLALOM = [(0, 0.2, 0.0, 0.8), (0, 0.4, 0.2, 1.0), (0, 0.6, 0.0, 0.8), (0, 0.8, 0.2, 1.0)]
START, GOAL = np.array([0.05, 0.05]), np.array([0.95, 0.95])


def _kept(world, start, goal, points, **options):
    return roadmap_of_points(world.space, points).within(world).plan(start, goal, **options)


def _grown(world, start, goal, points, **options):
    return plan_growing(world, start, goal, first=64, budget=Budget(samples=512), until="settled", **options)


PLANNERS = {
    "full": plan_on,
    "lazy": partial(plan_on, search="lazy"),
    "any": partial(plan_on, success_only=True),
    "fmt": fmt_on,
    "anytime": _grown,
    "kept": _kept,
}


@pytest.mark.parametrize("name", PLANNERS)
def test_every_motion_of_a_path_passed_the_strict_check_before_it_is_shortened_and_after(name):
    # The tree is grown anew after each motion that fails, some hundred times.
    solved, seeds = 0, 2 if name == "fmt" else 4
    for seed in range(seeds):
        world = GappyWorld(SLALOM)
        result = PLANNERS[name](world, START, GOAL, draw("sobol", 256, 2, rng=seed))
        assert result.status in (Status.SOLVED, Status.NOT_CONNECTED, Status.BUDGET_SPENT)
        if result.solved:
            solved += 1
            assert result.proof == "resolution"
            for path in (result.path, result.milestone_path):
                assert world.truly_free(path[:-1], path[1:]).all()
            # Where points lie on one line, the same length is summed up in fewer pieces.
            assert result.cost <= result.milestone_cost * (1.0 + 1e-12)
    assert solved >= seeds - 1


def test_the_weak_check_alone_would_have_handed_out_a_path_through_a_wall():
    class Careless(GappyWorld):
        validate = None

    result = plan_on(Careless(SLALOM), START, GOAL, draw("sobol", 512, 2, rng=0))
    assert result.solved
    assert not GappyWorld(SLALOM).truly_free(result.path[:-1], result.path[1:]).all()


def test_a_shortcut_still_shortens_and_never_takes_what_fails():
    # Round the tip of one thin wall, by a wide detour whose motions are all free.
    world = GappyWorld([(0, 0.5, 0.0, 0.7)])
    path = np.array([[0.1, 0.1], [0.1, 0.9], [0.5, 0.95], [0.9, 0.9], [0.9, 0.1]])
    shorter, _ = shortcut(world, path)
    assert world.truly_free(shorter[:-1], shorter[1:]).all()
    shortest = 2.0 * np.hypot(0.4, 0.6)
    assert shortest <= path_length(shorter, world.space) <= 1.1 * shortest


def test_a_kept_roadmap_remembers_which_motions_failed_and_which_passed():
    world = GappyWorld(SLALOM)
    known = roadmap_of_points(world.space, draw("sobol", 512, 2, rng=0), KNearest(10)).within(world)
    first = known.plan(START, GOAL, links=None, smooth=False)
    asked, rechecked = world.asked_motions, world.rechecked
    again = known.plan(START, GOAL, links=None, smooth=False)
    assert again.path.tobytes() == first.path.tobytes()
    # Only the links of start and goal are new: at most ten each, and the motion between the two.
    assert world.rechecked - rechecked <= world.asked_motions - asked <= 21


def test_only_doubtful_motions_are_asked_about_and_runs_of_them_together():
    calls = []

    class Strict:
        proof = "certified"

        def validate(self, path):
            calls.append(path[:, 0].tolist())
            return path[1:, 0] != 4.0

    path = np.arange(7.0)[:, np.newaxis]
    passed = confirmed(Strict(), path, np.array([False, True, True, True, False, True]))
    assert calls == [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0]]
    assert passed.tolist() == [True, True, True, False, True, True]


def test_a_disk_on_a_grid_map_is_exact_and_a_counting_world_says_what_its_own_says():
    disk = GridMap(np.zeros((9, 9), dtype=bool)).world(0.5)
    assert plan_on(disk, (1, 1), (8, 8), draw("halton", 16, 2)).proof == "exact"
    assert plan_on(Counting(disk), (1, 1), (8, 8), draw("halton", 16, 2)).proof == "exact"
    assert plan_on(Counting(disk), (1, 1), (20, 8), draw("halton", 16, 2)).proof is None
    gappy = Counting(GappyWorld(SLALOM))
    result = plan_on(gappy, START, GOAL, draw("sobol", 512, 2, rng=0))
    assert gappy.world.truly_free(result.path[:-1], result.path[1:]).all()
