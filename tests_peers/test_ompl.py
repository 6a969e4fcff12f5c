"""Our roadmap and OMPL's PRM agree: same points, same rule (k earlier), same states along motions."""

import numpy as np
import pytest

from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.roadmap import KEarlier
from evenroad.space import BoxSpace
from evenroad.world import FunctionWorld
from evenroad_studies.worlds import Corridor
from tests_peers.engines.ompl_prm import ompl_prm


def _balls(seed):
    """A random world of balls in 2 or 3 dimensions, neither empty nor full, with its checker for one state."""
    random = np.random.default_rng(seed)
    d = int(random.integers(2, 4))
    centres = random.random((int(random.integers(4, 12)), d))
    radius = random.uniform(0.1, 0.3 if d == 3 else 0.22)

    def free(q):
        return (((q[:, None, :] - centres) ** 2).sum(axis=2) > radius**2).all(axis=1)

    def free_state(x):
        return all(sum((a - b) ** 2 for a, b in zip(x, c, strict=True)) > radius**2 for c in centres.tolist())

    return d, free, free_state


@pytest.mark.parametrize("seed", range(200))
def test_success_agrees_on_random_worlds(seed):
    d, free, free_state = _balls(seed)
    start, goal = np.full(d, 0.02), np.full(d, 0.98)
    points = draw("uniform", 40, d, rng=seed)
    share = 0.01
    world = FunctionWorld(BoxSpace(np.zeros(d), np.ones(d)), free, share * np.sqrt(d))
    ours = plan(world, start, goal, PRM(points, rule=KEarlier(10), links=None), smooth=False)
    if str(ours.status).endswith("invalid"):
        start_and_goal_free = free(np.stack([start, goal]))
        assert not start_and_goal_free.all()
        return
    joined, _, _ = ompl_prm(free_state, points.points, start, goal, share)
    assert ours.solved == joined


def test_random_worlds_are_both_solved_and_not():
    outcomes = set()
    for seed in range(60):
        d, free, _ = _balls(seed)
        world = FunctionWorld(BoxSpace(np.zeros(d), np.ones(d)), free, 0.01 * np.sqrt(d))
        points = draw("uniform", 40, d, rng=seed)
        result = plan(
            world,
            np.full(d, 0.02),
            np.full(d, 0.98),
            PRM(points, rule=KEarlier(10), links=None),
            smooth=False,
        )
        outcomes.add(str(result.status))
    assert {"solved", "not_connected"} <= outcomes


@pytest.mark.parametrize(("d", "lam", "n"), [(2, 0.1, 128), (3, 0.2, 128), (3, 0.15, 256)])
def test_success_agrees_in_corridors(d, lam, n):
    world = Corridor(d, lam)

    def free(x):
        return any(all(v <= lam for v in x[:k]) and all(v >= 1 - lam for v in x[k + 1 :]) for k in range(d))

    for seed in range(4):
        points = draw("uniform", n, d, rng=seed)
        ours = plan(
            world, world.start, world.goal, PRM(points, rule=KEarlier(10), links=None), smooth=False
        ).solved
        assert ours == ompl_prm(free, points.points, world.start, world.goal, 0.001)[0]
