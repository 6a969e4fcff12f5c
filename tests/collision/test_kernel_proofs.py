"""Proofs: a motion that they call free is free at every state, what is refused is in contact or nearly so."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.collision.arm_world import ArmWorld
from evenroad.collision.certified import CertifiedWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.hulls import piece_of
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule
from evenroad.planning import PRM, plan
from evenroad.points import draw
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.testing import WorldContract
from evenroad.world import FunctionWorld
from evenroad.world.protocol import ValidatesPaths
from tests.refused import refused
from tests.robots.kernel_arms import (
    STRAIGHT,
    Z,
    as_balls,
    box_scene,
    proof_edge,
    random_scene,
    random_tree,
    seven_joint_arm,
    states_along,
    through_contact,
    ur5,
)
from tests.robots.oracle import clearance
from tests.robots.paths import dense_states

NOTHING = Scene(name="nothing")
WORLDS = {
    "five joints in a box": (ur5(math.pi, joints=5), box_scene()),
    "capsules among obstacles": (ur5(np.pi), random_scene(5)),
    "balls among obstacles": (as_balls(ur5(np.pi)), random_scene(5)),
    "balls, many obstacles": (as_balls(ur5(np.pi)), random_scene(7, count=40, spread=1.1)),
    "capsules alone": (ur5(np.pi), NOTHING),
    "balls alone": (as_balls(ur5(np.pi)), NOTHING),
    "five balls a capsule alone": (as_balls(ur5(np.pi), 5), NOTHING),
} | {
    # Of every kind of joint.
    f"tree {seed}": (random_tree(seed), random_scene(100 + seed, spread=0.7, clear=0.45))
    for seed in (0, 5, 8, 12, 13)
}
IN_BOX = ArmWorld(*WORLDS["five joints in a box"])


class TestContract(WorldContract):
    world = CertifiedWorld(IN_BOX)


@pytest.fixture(scope="module", params=WORLDS)
def motions(request):
    """A world, motions between free configurations, and which of them are proved."""
    world = ArmWorld(*WORLDS[request.param])
    q = world.space.from_cube(np.random.default_rng(11).random((8_000, world.space.dim)))
    q = q[world.valid(q)][:800]
    a, b = q[: len(q) // 2 * 2 : 2], q[1::2]
    # Of one joint and of all, long and short: bodies are made larger by as much as they move, by more, by little.
    alone = np.arange(len(a)) % (2 * world.space.dim)
    b = np.where((alone[:, np.newaxis] < world.space.dim) & (np.arange(world.space.dim) != alone[:, np.newaxis]), a, b)
    b = world.space.interpolate(a, b, np.linspace(0.05, 1.0, len(b)) ** 2)
    return world, a, b, world.motion_certified(a, b, 1e-6)


def test_what_is_proved_is_free_for_the_oracle_and_ends_next_to_contact(motions):
    world, a, b, proved = motions
    assert 0.05 < proved.mean() < 1.0
    some = np.concatenate([np.flatnonzero(proved)[-20:], np.flatnonzero(~proved)[:60]])
    a, b = a[some], proof_edge(world, a[some], b[some])
    apart = clearance(world.robot, world.scene, states_along(world, a, b, np.random.default_rng(1)))
    assert apart.min() > 0.0
    assert np.median(apart.reshape(len(a), -1)[20:, -1]) < 1e-4


def test_no_motion_through_a_place_in_contact_is_proved(motions):
    world = motions[0]
    a, b = through_contact(world, lambda q: clearance(world.robot, world.scene, q), np.random.default_rng(3))
    assert len(a) > 10
    for tolerance in (1e-6, 0.03):
        assert not world.motion_certified(a, b, tolerance).any()


def test_what_the_states_say_is_blocked_is_not_proved_and_little_else(motions):
    world, a, b, proved = motions
    sampled = world.motion_valid(a, b)
    assert not (proved & ~sampled).any()
    assert proved.sum() > 0.97 * sampled.sum()


def test_short_motions_are_proved_together_as_each_alone(motions):
    world, a, b, _ = motions
    # As of a trajectory, and long ones between them.
    b = world.space.interpolate(a, b, np.where(np.arange(len(a)) % 50 == 7, 1.0, np.linspace(1e-4, 0.03, len(a))))
    together = world.motion_certified(a, b, 1e-6)
    alone = [world.motion_certified(a[i : i + 1], b[i : i + 1], 1e-6)[0] for i in range(len(a))]
    assert together.tolist() == alone
    assert together.mean() > 0.9


def needle(gap, half_width=1e-3):
    """A wheel's rim, a ball of 1 mm, and a post of 1 mm in its way or `gap` beside it."""
    turn = Joint("turn", "revolute", "base", "wheel", (0.0, 0.0, 0.0), STRAIGHT, Z, 0.0, 2.0)
    rim = Capsule((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1e-3, link="wheel")
    robot = Robot("wheel", ("base", "wheel"), (turn,), (rim,), (), ("turn",))
    reach = 1.0 - 1e-3 - half_width - gap
    post = Obstacle.of("post", "sphere", (half_width,), (reach * math.cos(0.97), reach * math.sin(0.97), 0.0))
    return ArmWorld(robot, Scene((post,), name="post"), resolution=0.05)


AHEAD = (1.0, 0.0, 0.0)
TURN = Joint("turn", "revolute", "base", "wheel", (0.0, 0.0, 0.0), STRAIGHT, Z, -2.0, 2.0)
OUT = Joint("out", "prismatic", "wheel", "sled", (0.0, 0.0, 0.0), STRAIGHT, AHEAD, 0.8, 0.9)
FOLLOWER = replace(TURN, name="follower", mimic=Mimic("turn", -2.0))
UP, ASIDE = (replace(TURN, kind="prismatic", axis=axis) for axis in (Z, (0.0, 1.0, 0.0)))
MATE = replace(ASIDE, name="mate", child="mate", mimic=Mimic("turn", -1.0))
GAUGES = {
    "a wheel": ((TURN,), 1.0),
    "its own post": ((TURN,), 1.0),
    "its own rod": ((TURN,), 1.0),
    "its own box": ((ASIDE,), 1.0),
    "its own mate": ((MATE, ASIDE), 1.0),
    "a slide": ((ASIDE,), 1.0),
    "a slide of many balls": ((ASIDE,), 1.0),
    "a lift of many balls": ((UP,), 1.0),
    "many balls past its own post": ((UP,), 1.0),
    "a slide on a wheel": ((TURN, OUT), 0.1),
    "a follower": ((replace(TURN, child="lever"), FOLLOWER), 1.0),
}
"""Joints, and how far ahead on the last link a ball is, which the first joint moves by a known length and no less."""


@pytest.mark.parametrize("kind", GAUGES)
def test_a_post_of_a_millimetre_is_not_missed_wherever_it_is_in_a_motion(kind):
    """Bodies must be made larger by all that a joint moves them: a tenth less, and some motions would be proved."""
    joints, far = GAUGES[kind]
    half = 0.02 if kind == "its own rod" else 0.0
    # Balls that lie in line ahead: a motion of one hits the post, of the others none.
    places = far + 0.01 * np.arange(20 if "many" in kind else 1)
    radius = 3e-3 if kind == "its own box" else 1e-3
    balls = [Capsule((x, 0.0, -half), (x, 0.0, half), radius, link=joints[-1].child) for x in places.tolist()]
    links, group = (("base", *(each.child for each in joints)), tuple(j.name for j in joints if j.mimic is None))
    robot, scene = Robot(kind, links, joints, tuple(balls), (), group), Scene([er.Sphere(1e-3, xyz=AHEAD)])
    if "own" in kind:
        own = replace(balls[0], link="mate" if kind == "its own mate" else "base")
        robot, scene = replace(robot, capsules=(*balls, own), pairs=((own.link, "wheel"),)), NOTHING
    if kind == "its own box":
        # The balls are around boxes, which decide.
        boxes = [Box((2e-3, 2e-3, 2e-3), pose=Pose(AHEAD), link=link) for link in ("base", "wheel")]
        robot = replace(robot, hulls=tuple(piece_of(box).hull for box in boxes))
    world, rng = ArmWorld(robot, scene, resolution=0.5), np.random.default_rng(1)
    a = np.full((2000, world.space.dim), 0.9)
    b, share, length = a.copy(), rng.random(2000), rng.uniform(0.1, 1.9, 2000)
    a[:, 0], b[:, 0] = -share * length, (1.0 - share) * length
    missed = world.motion_valid(a, b)
    assert missed.mean() > 0.9
    for tolerance in (1e-6, 1e-2):
        assert not world.motion_certified(a[missed], b[missed], tolerance).any()
    # Short ones are tried many at once.
    a[:, 0], b[:, 0] = -0.035 * share, 0.035 * (1.0 - share)
    missed = world.motion_valid(a, b)
    assert missed.mean() > 0.2
    assert not world.motion_certified(a[missed], b[missed], 1e-6).any()
    # Beside it all are.
    a[:, 0], b[:, 0] = 0.0025, 0.0025 + 0.5 * length
    assert world.motion_certified(a, b, 1e-4).all()


def test_short_motions_that_end_beyond_a_limit_are_not_proved_among_many():
    world = needle(gap=0.5)
    inside, beyond = np.linspace(1.98, 2.0, 40)[:, np.newaxis], np.linspace(2.001, 2.01, 40)[:, np.newaxis]
    assert world.motion_certified(inside, inside[::-1], 1e-6).all()
    for a, b in ((inside, beyond), (beyond, inside), (beyond, beyond)):
        assert not world.motion_certified(a, b, 1e-6).any()


ROUND = np.array([[0.0], [1.9]])


@pytest.mark.parametrize("world", [needle(gap=-1e-3), CertifiedWorld(needle(gap=-1e-3))])
def test_a_post_between_two_states_is_missed_by_them_but_not_by_the_proof(world):
    assert needle(gap=-1e-3).motion_valid(ROUND[:1], ROUND[1:])[0]
    assert not CertifiedWorld(needle(gap=-1e-3)).motion_valid(ROUND[:1], ROUND[1:])[0]
    assert isinstance(world, ValidatesPaths)
    assert world.proof == "certified"
    assert world.validate(np.array([[0.0], [0.9], [1.1], [1.9]])).tolist() == [True, False, True]


@pytest.mark.parametrize(("gap", "tolerance", "proved"), [(1e-3, 1e-4, True), (1e-5, 1e-4, False), (1e-5, 1e-6, True)])
def test_the_tolerance_says_how_near_a_proof_goes(gap, tolerance, proved):
    assert CertifiedWorld(needle(gap), tolerance).validate(ROUND).tolist() == [proved]
    assert needle(gap).validate(ROUND)[0]


@pytest.mark.parametrize("tolerance", [0.0, -1.0, math.nan])
def test_a_tolerance_out_of_range_is_named(tolerance):
    refused(InvalidValue, "tolerance", CertifiedWorld, IN_BOX, tolerance)


def test_explain_is_that_of_the_world_inside():
    q = [0.0, 0.5, 0.0, 0.0, 0.0]
    assert CertifiedWorld(IN_BOX).explain(q) == IN_BOX.explain(q)


class Careless(FunctionWorld):
    """A world without a strict check: there is something to find then."""

    validate = None


@pytest.mark.parametrize("robot", [ur5(3.2), seven_joint_arm(), random_tree(8)], ids=["ur5", "seven", "tree 8"])
def test_shortcuts_touch_and_what_passes_is_free_for_the_oracle_at_a_twentieth_of_the_resolution(robot):
    passed, refused = [], []
    for seed in range(6):
        world = ArmWorld(robot, random_scene(1000 + seed, count=10, spread=1.0, clear=0.35))
        q = world.space.from_cube(np.random.default_rng(seed).random((100, world.space.dim)))
        q = q[world.valid(q)]
        points = draw("sobol", 128, world.space.cube_dim, rng=0)
        weak = Careless(world.space, world.valid, world.resolution)
        for start, goal in zip(q[0:4:2], q[1:4:2], strict=True):
            path = plan(weak, start, goal, PRM(points, search="lazy")).path
            if path is None:
                continue
            assert world.motion_valid(path[:-1], path[1:]).all()
            for i, free in enumerate(world.validate(path)):
                states = dense_states(world, path[i : i + 2])
                (passed if free else refused).append(clearance(robot, world.scene, states).min())
    assert len(passed) > 15
    assert min(passed) > 0.0
    assert all(apart < 1e-5 for apart in refused), "what is refused touches, or as good as does"
    assert refused or robot.name != "ur5", "there was something to find"


def test_one_verdict_a_motion():
    home = np.array([0.0, -math.pi / 2, 0.0, -math.pi / 2, 0.0])
    path = np.stack([home, home + 0.1, home + 0.1])
    assert IN_BOX.validate(path).tolist() == [True, True]
    assert IN_BOX.validate(path[:1]).shape == (0,)
    refused(InvalidValue, "path must have shape", IN_BOX.validate, path[0])


def test_what_states_call_blocked_is_not_passed():
    world = IN_BOX
    path = world.space.from_cube(np.random.default_rng(3).random((200, 5)))
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
