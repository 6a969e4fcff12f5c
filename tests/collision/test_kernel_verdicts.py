"""The kernel's verdicts against an oracle that knows nothing of tables, lanes, pruning or polynomials."""

import math
from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from tests.robots.kernel_arms import (
    STRAIGHT,
    X,
    Y,
    Z,
    as_balls,
    box_scene,
    edge,
    random_rotation,
    random_scene,
    random_tree,
    seven_joint_arm,
    ur5,
)
from tests.robots.oracle import clearance

BAND = 1e-5
"""Nearer to contact than this [m] either verdict is right; but single precision must then say blocked."""


def some_allowed(robot, scene, seed=1):
    """The scene, with a third of all contacts of links and obstacles allowed."""
    rng = np.random.default_rng(seed)
    contacts = [(link, obstacle.name) for link in robot.links for obstacle in scene.obstacles]
    return replace(scene, allowed=frozenset(c for c in contacts if rng.random() < 1 / 3))


FORTY = some_allowed(ur5(), random_scene(7, count=40, sizes=(0.05, 0.1)))
ARMS = {
    "ur5 and a box": (ur5(), box_scene()),
    "ur5 among every shape": (ur5(), random_scene(5)),
    "seven joints among every shape": (seven_joint_arm(), random_scene(3)),
    "ur5 among forty small ones": (ur5(), random_scene(6, count=40, sizes=(0.02, 0.08))),
    "ur5 of balls among every shape": (as_balls(ur5()), random_scene(5)),
    "ur5 of balls that may touch some of forty": (as_balls(ur5()), FORTY),
    "ur5 that may touch some of forty": (ur5(), FORTY),
} | {
    f"tree {seed}": (random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45))
    for seed in (0, 4, 5, 8, 12, 13, 15, 17)
}


@pytest.fixture(scope="module", params=ARMS)
def arm(request):
    """A robot, its scene, random configurations, and by how much they are clear of contact."""
    robot, scene = ARMS[request.param]
    space = ArmWorld(robot, scene).space
    q = space.from_cube(np.random.default_rng(1).random((4_000, space.dim)))
    return robot, scene, q, clearance(robot, scene, q)


def test_verdicts_are_the_oracles(arm):
    robot, scene, q, apart = arm
    free = ArmWorld(robot, scene).valid(q)
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98, "both verdicts must come up for the test to mean anything"
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def free_edge(robot, scene, q):
    """Configurations that the kernel calls free, each next to one that it calls blocked."""
    return edge(ArmWorld(robot, scene), q)[0]


def test_single_precision_is_never_optimistic(arm):
    """Random configurations are never so near to contact that a rounding decides: these all are."""
    robot, scene, q, _ = arm
    apart = clearance(robot, scene, free_edge(robot, scene, q))
    assert (apart > 0.0).all()
    assert np.median(apart) < BAND


def following(multiplier):
    """A UR5 whose fourth joint follows the second, many times as fast."""
    robot = ur5(3.0)
    wrist = replace(robot.joints[3], mimic=Mimic("shoulder_lift_joint", multiplier, 0.1))
    joints = (*robot.joints[:3], wrist, *robot.joints[4:])
    return replace(robot, joints=joints, group=(*robot.group[:3], *robot.group[4:]))


@pytest.mark.parametrize("robot", [
    ur5(100.0), ur5(1e4), ur5(1e6), following(30.0), following(-1000.0),
], ids=["16 turns", "1600 turns", "no limit", "mimic x30", "mimic x-1000"])  # fmt: skip
def test_large_angles_cost_no_digits(robot):
    scene = random_scene(5)
    space = ArmWorld(robot, scene).space
    q = space.from_cube(np.random.default_rng(4).random((5_000, space.dim)))
    assert (clearance(robot, scene, free_edge(robot, scene, q)) > 0.0).all()


def test_a_turned_floor_of_kilometres_is_never_called_farther_than_it_is():
    tilt = (0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8)
    # Its middle lies 850 m down the hill; its face passes 0.4 m below the robot.
    scene = Scene([Obstacle.of("floor", "box", (2000.0, 2000.0, 1.0), (679.7, 0.0, -510.9), tilt)])
    q = ArmWorld(ur5(), scene).space.from_cube(np.random.default_rng(6).random((4_000, 6)))
    assert (clearance(ur5(), scene, free_edge(ur5(), scene, q)) > 0.0).all()


@pytest.mark.parametrize("place", [(31.5, 0.2, -0.4), (0.3, -33.0, 31.8), (45.0, 60.0, -40.0)])
def test_far_from_the_origin_no_contact_is_left_out(place):
    """Boxes in whole numbers end 32 m away: there, and across their end, verdicts are the oracle's as anywhere."""
    robot, scene = ur5(), random_scene(5)
    base = replace(robot.joints[0], xyz=tuple(np.add(robot.joints[0].xyz, place)))
    # What does not move stays at the origin, far from everything.
    far = replace(robot, joints=(base, *robot.joints[1:]))
    there = Scene(
        [
            Obstacle.of(each.name, each.shape, each.size, tuple(np.add(each.xyz, place)), each.rotation)
            for each in scene.obstacles
        ]
    )
    q = ArmWorld(far, there).space.from_cube(np.random.default_rng(9).random((2_000, 6)))
    free, apart = ArmWorld(far, there).valid(q), clearance(far, there, q)
    clear = np.abs(apart) > 1e-3
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


@pytest.mark.parametrize("turn", [1e-7, 1e-5, 1e-4, 6e-4, 1e-3, 2e-3, 1e-2])
@pytest.mark.parametrize("radius", [5e-4, 2e-3, 2e-2])
def test_thin_and_nearly_parallel_rods_are_never_called_free_where_they_touch(turn, radius):
    """Rods of 2 m in all directions: where they are nearest is lost in the rounding of the angle between them."""
    tilt = random_rotation(np.random.default_rng(7))
    ways = (
        ("spin", "revolute", "root", "base", tilt, Y, 3.0),
        ("x", "prismatic", "base", "a", STRAIGHT, X, 1.5),
        ("y", "prismatic", "a", "b", STRAIGHT, Y, 1.2 * radius),
        ("z", "prismatic", "b", "c", STRAIGHT, Z, 3.0 * radius),
        ("turn", "revolute", "c", "rod", STRAIGHT, Z, turn),
    )
    joints = tuple(
        Joint(name, kind, parent, child, (0.0, 0.0, 0.0), rotation, axis, -most, most)
        for name, kind, parent, child, rotation, axis, most in ways
    )
    rods = tuple(Capsule((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), radius, link=link) for link in ("base", "rod"))
    links, group = ("root", *(way[3] for way in ways)), tuple(way[0] for way in ways)
    robot, scene = Robot("rods", links, joints, rods, (("base", "rod"),), group), Scene((), name="empty")
    space = ArmWorld(robot, scene).space
    q = space.from_cube(np.random.default_rng(5).random((10_000, 5)))
    assert (clearance(robot, scene, free_edge(robot, scene, q)) > 0.0).all()


def test_what_is_free_touches_nothing_as_true_capsules(arm):
    robot, scene, q, _ = arm
    q = q[:500]
    free = ArmWorld(robot, scene).valid(q)
    assert (clearance(robot, scene, q[free], samples=40) > 0.0).all()


@pytest.mark.parametrize("noise", [0.0, 1e-7, 1e-5, 1e-3])
def test_parallel_and_nearly_parallel_capsules_get_the_oracles_verdict(noise):
    """At right angles the UR5's capsules lie along and across each other."""
    robot, scene = ur5(), box_scene()
    rng = np.random.default_rng(2)
    q = rng.integers(-4, 5, (4_000, 6)) * (math.pi / 2) + noise * rng.normal(size=(4_000, 6))
    q = np.clip(q, -6.28, 6.28)
    q[:, 2] = np.clip(q[:, 2], -math.pi, math.pi)
    apart = clearance(robot, scene, q)
    free = ArmWorld(robot, scene).valid(q)
    clear = np.abs(apart) > BAND
    assert 0.02 < free.mean() < 0.98
    np.testing.assert_array_equal(free[clear], apart[clear] > 0.0)


def test_one_joint_brings_two_parallel_capsules_together_within_the_padding():
    """Where contact happens is known: a slide that closes the gap between capsules side by side."""
    slide = Joint("slide", "prismatic", "base", "hand", (0.0, 0.0, 0.0), STRAIGHT, X, 0.1, 1.0)
    capsules = (
        Capsule((0.0, -0.3, 0.0), (0.0, 0.3, 0.0), 0.1, link="base"),
        Capsule((0.0, 0.1, 0.0), (0.0, 0.9, 0.0), 0.15, link="hand"),
    )
    robot = Robot("slider", ("base", "hand"), (slide,), capsules, (("base", "hand"),), ("slide",))
    q = np.array([[0.2], [0.2499], [0.25001], [0.3], [0.9]])
    free = ArmWorld(robot, Scene((), name="empty")).valid(q)
    np.testing.assert_array_equal(free, [False, False, True, True, True])
