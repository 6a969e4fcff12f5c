"""Planning in spaces that wrap, turn, or have redundant coordinates."""

import numpy as np
import pytest

from evenroad.points import draw
from evenroad.points.samplers import Sobol
from evenroad.points.samplers.even import Sliced
from evenroad.roadmap import KNearest, Radius
from evenroad.roadmap.build import roadmap_of_points
from evenroad.roadmap.points_of import even_points
from evenroad.space import SE2, SE3, SO3, BoxSpace, JointSpace, Product
from evenroad.world import FunctionWorld
from tests.counting import Counting
from tests.plan_on import fmt_on, plan_growing, plan_on


def _slit(q):
    """The middle may be passed only with a small turn."""
    return (np.abs(q[:, 0] - 0.5) > 0.1) | (np.abs(q[:, -1]) < 0.5)


def _corridor(d, width):
    """Along the edges of the unit cube: once a coordinate is beyond the width, all after it are near 1."""
    space = BoxSpace(np.zeros(d), np.ones(d))

    def free(q):
        passed = np.cumsum(q > width, axis=1) - (q > width) > 0
        return np.all(~passed | (q >= 1.0 - width), axis=1)

    return FunctionWorld(space, free, 0.02)


JOINTS = JointSpace([-np.pi, -1.0, -np.pi], [np.pi, 1.0, np.pi], wrapping=[True, False, True])
CASES = {
    "joints": (FunctionWorld(JOINTS, _slit, 0.05), (-3.0, 0.0, 2.0), (3.0, 0.5, -2.0), 3),
    "SE2": (FunctionWorld(SE2((0.0, 0.0), (1.0, 1.0)), _slit, 0.05), (0.1, 0.5, 3.0), (0.9, 0.5, -3.0), 3),
    "SE3": (
        FunctionWorld(SE3((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), _slit, 0.05),
        (0.1, 0.5, 0.5, 1.0, 0.0, 0.0, 0.0),
        (0.9, 0.5, 0.5, -1.0, 0.0, 0.0, 0.0),
        6,
    ),
    "corridor": (_corridor(3, 0.35), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), 3),
}


@pytest.mark.parametrize("rule", [KNearest(8), Radius(0.8)], ids=str)
@pytest.mark.parametrize("case", CASES)
def test_every_planner_works_in_every_space_and_lazy_equals_full(case, rule):
    world, start, goal, d = CASES[case]
    points = draw("sobol", 150, d, rng=1)
    full = plan_on(world, start, goal, points, rule=rule, smooth=False)
    counting = Counting(world)
    lazy = plan_on(counting, start, goal, points, rule=rule, search="lazy", smooth=False)
    assert lazy.status is full.status
    assert lazy.counts["edges_checked"] == counting.motions <= full.counts["edges_checked"]
    assert lazy.counts["configurations_checked"] == counting.configurations
    if full.solved:
        assert lazy.path.tobytes() == full.path.tobytes()
        assert full.cost >= world.space.distance(full.start[None], full.goal[None])[0] * (1 - 1e-12)
    tree = fmt_on(world, start, goal, points, rule=rule, smooth=False)
    assert full.solved or not tree.solved
    known = roadmap_of_points(world.space, points, rule).within(world)
    once, twice = (known.plan(start, goal, smooth=False) for _ in range(2))
    assert once.status is twice.status
    if once.solved:
        assert once.path.tobytes() == twice.path.tobytes()
        assert world.motion_valid(once.path[:-1], once.path[1:]).all()


@pytest.mark.parametrize("case", CASES)
def test_growing_solves_them_all(case):
    world, start, goal, _ = CASES[case]
    result = plan_growing(world, start, goal)
    assert result.solved
    assert world.motion_valid(result.path[:-1], result.path[1:]).all()


@pytest.mark.parametrize(("d", "k"), [(2, 10), (5, 10), (6, 20), (10, 20)])
@pytest.mark.parametrize("planner", [plan_on, fmt_on])
def test_the_default_k_grows_with_the_dimension(planner, d, k):
    result = planner(_corridor(d, 0.4), np.zeros(d), np.ones(d), draw("sobol", 16, d))
    assert result.rule == f"k={k} symmetrised"


@pytest.mark.parametrize(("rule", "sampler"), [
    (KNearest(4), Sliced()), (KNearest(6), Sliced()), (KNearest(7), Sobol()), (Radius(0.5), Sobol()), (None, Sobol()),
])  # fmt: skip
def test_a_number_of_points_in_space_means_sliced_poses_for_few_neighbours_and_sobol_for_more(rule, sampler):
    space = SE3((0.0, 0.0, 0.0), (2.0, 1.0, 1.0))
    assert even_points(40, space, rule, rng=3) == sampler.draw(40, 6, rng=3)


@pytest.mark.parametrize(
    "space",
    [
        BoxSpace([0.0] * 10, [2.0] * 10),
        JOINTS,
        JointSpace([-3.0] * 10, [3.0] * 10),
        SE2((0.0, 0.0), (1.0, 1.0)),
        Product([SO3(), SO3()]),
    ],
)
@pytest.mark.parametrize("rule", [KNearest(4), KNearest(20), Radius(0.5), None])
def test_elsewhere_a_number_of_points_means_even_whatever_the_rule(space, rule):
    assert even_points(40, space, rule, rng=3) == draw("even", 40, space.cube_dim, rng=3)


@pytest.mark.parametrize("rule", [KNearest(5), KNearest(15)])
def test_a_plan_and_a_roadmap_in_space_take_what_their_rule_wants(rule):
    world, start, goal, _ = CASES["SE3"]
    points = even_points(100, world.space, rule)
    asked, given = plan_on(world, start, goal, 100, rule=rule), plan_on(world, start, goal, points, rule=rule)
    np.testing.assert_array_equal(asked.path, given.path)
    assert asked.counts == given.counts
    assert roadmap_of_points(world.space, 100, rule).points == points
