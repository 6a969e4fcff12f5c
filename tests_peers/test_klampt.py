"""Klamp't and coal, placed behind the same protocol, agree with our capsules outside of what triangles lose."""

import math

import numpy as np
import pytest
from tests.robot.kernel_arms import box_scene, random_scene, random_tree, ur5
from tests.robot.oracle import clearance

from evenroad.errors import InvalidValue
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.reference.coal_world import CoalWorld
from evenroad.robot.reference.klampt_world import KlamptWorld
from evenroad.testing import WorldContract

ENGINES = (KlamptWorld, CoalWorld)
CASES = {
    "ur5": (ur5(math.pi, joints=5), box_scene(0.30)),
    "tree": (random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
}
LOST = 1e-3
"""Triangles in round bodies of at most 9 cm stay inside of them by up to this [m]."""


class TestKlampt(WorldContract):
    world = KlamptWorld(*CASES["ur5"])
    free_between = False


class TestCoal(WorldContract):
    world = CoalWorld(*CASES["tree"])
    free_between = False


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_verdicts_are_those_of_the_capsules(engine, robot, scene):
    world = engine(robot, scene)
    q = world.space.from_cube(np.random.default_rng(1).random((1_000, world.space.dim)))
    apart = clearance(robot, scene, q, samples=80)
    clear = np.abs(apart) > LOST
    np.testing.assert_array_equal(world.valid(q)[clear], apart[clear] > 0.0)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize(("robot", "scene"), CASES.values(), ids=CASES)
def test_what_we_call_free_they_call_free(engine, robot, scene):
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(2).random((2_000, world.space.dim)))
    assert engine(robot, scene).valid(q[world.valid(q)]).all()


@pytest.mark.parametrize("engine", ENGINES)
def test_no_surfaces_are_no_free_pass(engine):
    robot, scene = CASES["ur5"]
    with pytest.raises(InvalidValue, match="one or more"):
        engine(robot, scene, surfaces={})
    with pytest.raises(InvalidValue, match="unknown: hand"):
        engine(robot, scene, surfaces={"hand": None})


def test_coal_names_what_touches():
    robot, scene = CASES["ur5"]
    assert CoalWorld(robot, scene).explain(np.array([0.0, 0.6, 0.0, 0.0, 0.0])).endswith("touches 'table'")
