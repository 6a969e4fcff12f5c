"""The strict check of a path that is handed out: proofs, on paths that shortcutting pressed against obstacles."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from evenroad.errors import InvalidValue
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.certified import CertifiedWorld
from evenroad.world import FunctionWorld
from evenroad.world.protocol import ValidatesPaths
from tests.robot.kernel_arms import box_scene, random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance
from tests.robot.test_kernel_certified import needle

FINER = 20
ARMS = {"ur5": ur5(3.2), "seven": seven_joint_arm(), "tree 8": random_tree(8)}


class Careless(FunctionWorld):
    """A world without a strict check: there is something to find then."""

    validate = None


def shortcut_paths(robot, scenes):
    """Worlds and paths between random free configurations, shortcut."""
    for seed in scenes:
        world = ArmWorld(robot, random_scene(1000 + seed, count=10, spread=1.0, clear=0.35))
        q = world.space.from_cube(np.random.default_rng(seed).random((100, world.space.dim)))
        q = q[world.valid(q)]
        points = draw("sobol", 128, world.space.cube_dim, rng=0)
        for start, goal in zip(q[0:4:2], q[1:4:2], strict=True):
            weak = Careless(world.space, world.valid, world.resolution)
            result = plan(weak, start, goal, PRM(points, search="lazy"))
            if result.path is not None:
                yield world, result.path


def nearest(world, a, b):
    """By how much bodies stay apart at worst at states a twentieth of the resolution apart; negative in contact."""
    count = 1 + FINER * math.ceil(world.space.distance(a[None], b[None])[0] / world.resolution)
    share = np.linspace(0.0, 1.0, count)
    states = world.space.interpolate(np.tile(a, (count, 1)), np.tile(b, (count, 1)), share)
    return clearance(world.robot, world.scene, states).min()


@pytest.mark.parametrize("robot", ARMS.values(), ids=ARMS)
def test_a_shortcut_motion_that_passes_is_free_for_the_oracle_at_a_twentieth_of_the_resolution(robot):
    passed, refused = [], []
    for world, path in shortcut_paths(robot, range(8)):
        for a, b, free in zip(path[:-1], path[1:], world.validate(path), strict=True):
            (passed if free else refused).append(nearest(world, a, b))
    assert len(passed) > 15
    assert min(passed) > 0.0
    assert all(apart < 1e-5 for apart in refused), "what is refused touches, or as good as does"


def test_shortcut_paths_do_touch_so_that_the_check_has_something_to_find():
    paths = list(shortcut_paths(ARMS["ur5"], range(8)))
    assert all(world.motion_valid(path[:-1], path[1:]).all() for world, path in paths)
    assert not all(world.validate(path).all() for world, path in paths)


@pytest.mark.parametrize("world", [needle(gap=-1e-3), CertifiedWorld(needle(gap=-1e-3))])
def test_a_post_between_two_states_is_found(world):
    assert isinstance(world, ValidatesPaths)
    assert world.proof == "certified"
    assert world.validate(np.array([[0.0], [0.9], [1.1], [1.9]])).tolist() == [True, False, True]


@pytest.mark.parametrize("gap", [1e-5, 1e-4, 1e-3])
def test_a_post_beside_the_way_is_passed(gap):
    assert needle(gap).validate(np.array([[0.0], [1.9]]))[0]


def test_one_verdict_a_motion():
    world = ArmWorld(ur5(), box_scene())
    home = np.array([0.0, -math.pi / 2, 0.0, -math.pi / 2, 0.0, 0.0])
    path = np.array([home, home + 0.1, home + 0.1])
    assert world.validate(path).tolist() == [True, True]
    assert world.validate(path[:1]).shape == (0,)
    with pytest.raises(InvalidValue, match="path must have shape"):
        world.validate(home)


@pytest.mark.parametrize("backend", ["lanes", "scalar"])
def test_what_states_call_blocked_is_not_passed(backend):
    world = ArmWorld(ur5(), box_scene(), backend=backend)
    path = world.space.from_cube(np.random.default_rng(3).random((200, 6)))
    assert not (world.validate(path) & ~world.motion_valid(path[:-1], path[1:])).any()


def test_a_motion_of_thirty_thousand_turns_is_refused_in_bounded_time():
    """It would take some hundred thousand intervals to prove it."""
    wheel = needle(gap=0.1)
    turn = replace(wheel.robot.joints[0], lower=-1e5, upper=1e5)
    world = ArmWorld(replace(wheel.robot, joints=(turn,)), wheel.scene, resolution=100.0)
    path = np.array([[-1e5], [1e5]])
    assert world.motion_valid(path[:1], path[1:])[0]
    assert world.validate(np.array([[-10.0], [10.0]]))[0]
    begin = time.process_time()
    assert not world.validate(path)[0]
    assert time.process_time() - begin < 2.0
