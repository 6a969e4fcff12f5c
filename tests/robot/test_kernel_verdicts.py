"""The kernel's verdicts against an oracle that knows nothing of tables, lanes, pruning or polynomials."""

import math

import numpy as np
import pytest

from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.capsule import Capsule
from evenroad.robot.joint import Joint
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Scene
from tests.robot.kernel_arms import STRAIGHT, X, box_scene, random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""

ARMS = {
    "ur5 and a box": (ur5(), box_scene(), 20_000),
    "ur5 among every shape": (ur5(), random_scene(5), 20_000),
    "seven joints among every shape": (seven_joint_arm(), random_scene(3), 20_000),
    "ur5 among forty small ones": (ur5(), random_scene(6, count=40, sizes=(0.02, 0.08)), 5_000),
} | {
    f"tree {seed}": (random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45), 4_000)
    for seed in (0, 4, 5, 8, 12, 13, 15, 17)
}


@pytest.fixture(scope="module", params=ARMS)
def arm(request):
    """A robot, its scene, random configurations, and by how much they are clear of contact."""
    robot, scene, count = ARMS[request.param]
    space = ArmWorld(robot, scene).space
    q = space.from_cube(np.random.default_rng(1).random((count, space.dim)))
    return robot, scene, q, clearance(robot, scene, q)


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_verdicts_are_the_oracles(arm, backend):
    robot, scene, q, apart = arm
    free = ArmWorld(robot, scene, backend=backend).valid(q)
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98, "both verdicts must come up for the test to mean anything"
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_single_precision_is_never_optimistic(arm):
    robot, scene, q, apart = arm
    assert (apart[ArmWorld(robot, scene, backend="lanes").valid(q)] > 0.0).all()


def test_what_is_free_touches_nothing_as_true_capsules(arm):
    robot, scene, q, _ = arm
    q = q[:500]
    free = ArmWorld(robot, scene).valid(q)
    assert (clearance(robot, scene, q[free], samples=40) > 0.0).all()


@pytest.mark.parametrize("noise", [0.0, 1e-7, 1e-5, 1e-3])
@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_parallel_and_nearly_parallel_capsules_get_the_oracles_verdict(noise, backend):
    """At right angles the UR5's capsules lie along and across each other."""
    robot, scene = ur5(), box_scene()
    rng = np.random.default_rng(2)
    q = np.clip(
        rng.integers(-4, 5, (4_000, 6)) * (math.pi / 2) + noise * rng.normal(size=(4_000, 6)), -6.28, 6.28
    )
    q[:, 2] = np.clip(q[:, 2], -math.pi, math.pi)
    apart = clearance(robot, scene, q)
    free = ArmWorld(robot, scene, backend=backend).valid(q)
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_one_joint_brings_two_parallel_capsules_together_within_the_padding():
    """Where contact happens is known: a slide that closes the gap between capsules side by side."""
    slide = Joint("slide", "prismatic", "base", "hand", (0.0, 0.0, 0.0), STRAIGHT, X, 0.1, 1.0)
    capsules = (
        Capsule("base", (0.0, -0.3, 0.0), (0.0, 0.3, 0.0), 0.1),
        Capsule("hand", (0.0, 0.1, 0.0), (0.0, 0.9, 0.0), 0.15),
    )
    robot = Robot("slider", ("base", "hand"), (slide,), capsules, (("base", "hand"),), ("slide",))
    q = np.array([[0.2], [0.2499], [0.25001], [0.3], [0.9]])
    for backend in ("lanes", "scalar"):
        free = ArmWorld(robot, Scene("empty", ()), backend=backend).valid(q)
        np.testing.assert_array_equal(free, [False, False, True, True, True])
