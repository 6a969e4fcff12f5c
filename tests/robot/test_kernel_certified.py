"""Certified motions: never blocked however finely they are looked at, and not refused without need."""

import math

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import Capsule
from evenroad.planning.connectors import ARM_TREES
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.robot.joint import Joint
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle, Scene
from evenroad.space.path import path_length
from evenroad.testing import WorldContract
from tests.robot.kernel_arms import STRAIGHT, Z, box_scene, random_scene, random_tree, seven_joint_arm, ur5

WORLDS = {
    "ur5": ArmWorld(ur5(math.pi, joints=5), box_scene()),
    "seven": ArmWorld(seven_joint_arm(), random_scene(3)),
    "tree 8": ArmWorld(random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
    "tree 13": ArmWorld(random_tree(13), random_scene(113, spread=0.7, clear=0.45)),
}


class TestContract(WorldContract):
    world = CertifiedWorld(WORLDS["ur5"])


def free_motions(world, count, seed=1):
    """Ends of motions, short ones and long ones, with free ends."""
    rng = np.random.default_rng(seed)
    q = world.space.from_cube(rng.random((40 * count, world.space.dim)))
    q = q[world.valid(q)]
    a, b = q[:count], q[count : 2 * count]
    b = world.space.interpolate(a, b, rng.random(len(a)))
    return a, b


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
def test_a_certified_motion_is_free_at_a_thousand_times_as_many_states(world):
    a, b = free_motions(world, 150)
    certified = CertifiedWorld(world).motion_valid(a, b)
    assert 0.2 < certified.mean() < 1.0
    fine = ArmWorld(world.robot, world.scene, resolution=world.resolution / 1000.0)
    assert fine.motion_valid(a[certified], b[certified]).all()


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
def test_what_the_states_say_is_blocked_is_not_certified(world):
    a, b = free_motions(world, 300, seed=2)
    certified = CertifiedWorld(world).motion_valid(a, b)
    assert not (certified & ~world.motion_valid(a, b)).any()


def test_paths_are_shortened_by_compiled_code_and_stay_proved():
    world = CertifiedWorld(WORLDS["ur5"])
    a, b = free_motions(world.world, 200, seed=4)
    hop = np.flatnonzero(world.motion_valid(a[:-1], b[:-1]) & world.motion_valid(b[:-1], a[1:]))
    paths = [np.stack([a[i], b[i], a[i + 1]]) for i in hop]
    lengths = [
        [path_length(path, world.space) for path in (each, ARM_TREES.smooth(world.world, each)[0])]
        for each in paths
    ]
    assert all(world.validate(ARM_TREES.smooth(world.world, each)[0]).all() for each in paths)
    before, after = np.transpose(lengths)
    assert (after <= before * (1 + 1e-12)).all()
    assert after.sum() < 0.95 * before.sum()


@pytest.mark.parametrize("world", WORLDS.values(), ids=WORLDS)
def test_few_free_motions_are_not_certified(world):
    a, b = free_motions(world, 300, seed=3)
    sampled, certified = world.motion_valid(a, b), CertifiedWorld(world).motion_valid(a, b)
    assert certified.sum() > 0.97 * sampled.sum()


def needle(gap, half_width=1e-3):
    """A wheel's rim, a ball of 1 mm, and a post of 1 mm in its way or `gap` beside it."""
    turn = Joint("turn", "revolute", "base", "wheel", (0.0, 0.0, 0.0), STRAIGHT, Z, 0.0, 2.0)
    rim = Capsule((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1e-3, link="wheel")
    robot = Robot("wheel", ("base", "wheel"), (turn,), (rim,), (), ("turn",))
    reach = 1.0 - 1e-3 - half_width - gap
    post = Obstacle.of("post", "sphere", (half_width,), (reach * math.cos(0.97), reach * math.sin(0.97), 0.0))
    return ArmWorld(robot, Scene((post,), name="post"), resolution=0.05)


def test_a_post_between_two_states_is_missed_by_them_but_not_by_the_proof():
    world = needle(gap=-1e-3)
    ends = np.array([[0.0]]), np.array([[1.9]])
    assert world.motion_valid(*ends)[0]
    assert not CertifiedWorld(world).motion_valid(*ends)[0]


@pytest.mark.parametrize(
    ("gap", "tolerance", "proved"), [(1e-3, 1e-4, True), (1e-5, 1e-4, False), (1e-5, 1e-6, True)]
)
def test_the_tolerance_says_how_near_a_proof_goes(gap, tolerance, proved):
    world = CertifiedWorld(needle(gap), tolerance)
    assert world.motion_valid(np.array([[0.0]]), np.array([[1.9]]))[0] == proved


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan])
def test_a_tolerance_out_of_range_is_named(tolerance):
    with pytest.raises(InvalidValue, match="tolerance"):
        CertifiedWorld(WORLDS["ur5"], tolerance)


def test_explain_is_that_of_the_world_inside():
    q = [0.0, 0.5, 0.0, 0.0, 0.0]
    assert CertifiedWorld(WORLDS["ur5"]).explain(q) == WORLDS["ur5"].explain(q)
