"""Proofs in lanes: a motion that they call free is free at every state, also of robots of many bodies."""

from types import SimpleNamespace

import numpy as np
import pytest

from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.kernel import layout as at
from evenroad.robot.kernel import motion_proof
from evenroad.robot.scene import Scene
from tests.robot.kernel_arms import as_balls, random_scene, random_tree, seven_joint_arm, ur5
from tests.robot.oracle import clearance

NOTHING = Scene((), name="nothing")
WORLDS = {
    "capsules among obstacles": (ur5(np.pi), random_scene(5)),
    "balls among obstacles": (as_balls(ur5(np.pi)), random_scene(5)),
    "balls, many obstacles": (as_balls(ur5(np.pi)), random_scene(7, count=40, spread=1.1)),
    "capsules alone": (ur5(np.pi), NOTHING),
    "balls alone": (as_balls(ur5(np.pi)), NOTHING),
    "five balls a capsule alone": (as_balls(seven_joint_arm(), 5), NOTHING),
    "tree": (random_tree(8), random_scene(108, spread=0.7, clear=0.45)),
    "tree with a joint that wraps": (random_tree(13), random_scene(113, spread=0.7, clear=0.45)),
}
FINER = 20


@pytest.fixture(scope="module", params=WORLDS)
def motions(request):
    """A world, motions between free configurations, which states call free, and which are proved."""
    robot, scene = WORLDS[request.param]
    world = ArmWorld(robot, scene)
    q = world.space.from_cube(np.random.default_rng(11).random((40_000, world.space.dim)))
    q = q[world.valid(q)]
    a, b = q[0::2][:2_000], q[1::2][:2_000]
    a = a[: len(b)]
    # Long ones and short ones: bodies are made larger by much, and by little.
    b = world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)
    return world, a, b, world.motion_certified(a, b, 1e-6)


def fine_states(world, a, b, finer=FINER):
    count = 1 + finer * int(np.ceil(world.space.distance(a[None], b[None])[0] / world.resolution))
    ends = (np.broadcast_to(end, (count, len(a))) for end in (a, b))
    return world.space.interpolate(*ends, np.linspace(0.0, 1.0, count))


def test_what_is_proved_is_free_in_double_precision_at_a_twentieth_of_the_resolution(motions):
    world, a, b, proved = motions
    assert 0.05 < proved.mean() < 1.0
    scalar = ArmWorld(world.robot, world.scene, world.resolution / FINER, backend="scalar")
    assert scalar.motion_valid(a[proved], b[proved]).all()


def test_what_is_proved_is_free_for_the_oracle(motions):
    world, a, b, proved = motions
    states = [fine_states(world, *motion) for motion in zip(a[proved][-10:], b[proved][-10:], strict=True)]
    assert clearance(world.robot, world.scene, np.concatenate(states)).min() > 0.0


def test_lanes_and_double_precision_prove_the_same_but_for_micrometres(motions):
    world, a, b, proved = motions
    scalar = ArmWorld(world.robot, world.scene, world.resolution, backend="scalar")
    a, b, proved = a[-300:], b[-300:], proved[-300:]
    wide, near = (scalar.motion_certified(a, b, tolerance) for tolerance in (1e-4, 1e-7))
    assert not (proved & ~near).any()
    assert not (wide & ~proved).any()


@pytest.mark.parametrize("name", ["capsules among obstacles", "balls among obstacles", "tree"])
def test_every_length_that_decides_a_test_is_made_larger_and_nothing_else(name, monkeypatch):
    world = ArmWorld(*WORLDS[name])
    robot, lanes = world.robot_tables, world.tables.lanes
    ints, table = lanes[: lanes[at.INTEGERS]], lanes[lanes[at.INTEGERS] :].view(np.float32)
    speeds = robot.speeds @ np.linspace(1.0, 2.0, world.space.dim)
    pair_speeds = robot.pair_speeds @ np.linspace(1.0, 2.0, world.space.dim)
    motion = SimpleNamespace(speeds=speeds, pair_speeds=pair_speeds)
    wide = table.copy()
    for helper in ("_wider", "_largest"):
        monkeypatch.setattr(motion_proof, helper, getattr(motion_proof, helper).py_func)
    monkeypatch.setattr(motion_proof, "row", lambda array, place, count: array[place : place + count])
    motion_proof._enlarge.py_func(0.25, motion, SimpleNamespace(ints=ints, table=table, enlarged=wide))
    least = np.zeros(len(table))
    for i, speed in enumerate(speeds):
        least[ints[at.CAPSULE_FLOATS] + at.CAPSULE_FLOAT_ROW * i + 6] = 0.25 * speed
    for i in range(ints[at.BODIES]):
        _, first, end = ints[ints[at.BODY_INTS] + at.BODY_INT_ROW * i :][:3]
        place = ints[at.BODY_FLOATS] + at.BODY_FLOAT_ROW * i
        least[place + 3 : place + 7] = 0.25 * speeds[first:end].max()
    for p in range(ints[at.BODY_PAIRS]):
        _, _, first, end = ints[ints[at.BODY_PAIR_INTS] + at.BODY_PAIR_INT_ROW * p :][:4]
        least[ints[at.BODY_PAIR_FLOATS] + p] = 0.25 * pair_speeds[first:end].max()
    for i, speed in enumerate(pair_speeds):
        place = ints[at.PAIR_FLOATS] + at.PAIR_FLOAT_ROW * i
        least[place : place + 2] = 0.25 * speed
    assert (wide.astype(np.float64) >= table + least).all()
    np.testing.assert_allclose(wide, table + least, rtol=1e-6)
