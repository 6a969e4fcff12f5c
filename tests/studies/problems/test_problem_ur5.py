import numpy as np
import pytest

from evenroad.points import draw
from evenroad.roadmap import KNearest
from evenroad_studies.problems import source_named
from tests.plan_on import plan_on


@pytest.fixture(autouse=True)
def _a_cache_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path))


@pytest.mark.parametrize(
    ("name", "flange"), [("ur5-c", (0.7607, -0.0384, 0.2320)), ("ur5-a", (0.6629, 0.0211, 0.2007))]
)
def test_start_and_goal_are_free_in_the_space_of_five_joints(name, flange):
    from evenroad.robot import link_poses

    problem = source_named(name).make(0)
    assert problem.world.valid(np.stack([problem.start, problem.goal])).all()
    assert problem.set_dim == problem.world.space.dim == 5
    np.testing.assert_allclose(link_poses(problem.world.robot, [problem.goal])[0, -1, :3, 3], flange, atol=1e-4)


def test_the_space_is_the_protocols_and_does_not_wrap():
    space = source_named("ur5-c").make(0).world.space
    corners = space.from_cube(np.array([[0.0] * 5, [1.0] * 5]))
    np.testing.assert_allclose(corners[0], np.pi * np.array([-1, -1.3, -1, -1, -1]))
    np.testing.assert_allclose(corners[1], np.pi * np.array([1, 0.3, 1, 1, 1]))
    assert space.distance(corners[:1], corners[1:])[0] == pytest.approx(np.pi * np.sqrt(4 * 4 + 1.6**2))


def test_the_share_of_free_configurations_is_that_of_the_published_rows():
    """Uniform points: 378 valid of 1024 on average, so 36.9 %."""
    world = source_named("ur5-c").make(0).world
    free = world.valid(world.space.from_cube(draw("uniform", 40_000, 5).points)).mean()
    assert free == pytest.approx(0.369, abs=0.008)


def test_the_problem_can_be_solved():
    problem = source_named("ur5-c").make(0)
    solved = [
        plan_on(
            problem.world,
            problem.start,
            problem.goal,
            draw("halton", 1024, 5, rng=run),
            rule=KNearest(20),
            links=None,
            success_only=True,
        ).solved
        for run in range(30)
    ]
    assert 1 <= sum(solved) < 25
