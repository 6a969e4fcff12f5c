"""ArmWorld: the contract of worlds, motions, words, and values that it refuses."""

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, UnknownName
from evenroad.geometry.shapes import Capsule
from evenroad.robots.joint import Joint, Mimic
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Obstacle, Scene
from evenroad.testing import WorldContract
from evenroad.world import FunctionWorld
from tests.refused import refused
from tests.robots.kernel_arms import STRAIGHT, Z, box_scene, edge, random_scene, random_tree, ur5
from tests.robots.surface_scenes import cloud_scene

HOME = np.array([0.0, -math.pi / 2, 0.0, -math.pi / 2, 0.0])
INSIDE = np.array([-0.1216, -0.6993, 1.2160, -2.1070, 2.3023])


class TestContract(WorldContract):
    world = ArmWorld(ur5(), box_scene())
    free_between = False


class TestATreeWithJointsThatWrap(WorldContract):
    world = ArmWorld(random_tree(8), random_scene(108, spread=0.7, clear=0.45))
    free_between = False

    def test_some_joint_wraps(self):
        assert np.isfinite(self.world.bounds[2]).any()

    def test_full_turns_change_nothing(self):
        q = self.configurations()
        turned = q + np.where(np.isfinite(self.world.bounds[2]), 4.0 * math.pi, 0.0)
        assert np.mean(self.world.valid(turned) == self.world.valid(q)) > 0.99


def five_joints(**changes):
    return ArmWorld(ur5(math.pi, joints=5), box_scene(), **changes)


def test_home_and_a_place_inside_the_box_are_free():
    assert five_joints().valid(np.stack([HOME, INSIDE])).all()


@pytest.mark.parametrize("resolution", [0.05, 0.31, 2.0])
def test_a_motion_is_free_where_all_its_states_are(resolution):
    """The states of FunctionWorld, k / n of the way, whatever the order and the number of lanes."""
    world = five_joints(resolution=resolution)
    q = world.space.from_cube(np.random.default_rng(5).random((4_000, 5)))
    q = q[world.valid(q)]
    a, b = q[:500], q[500:1000]
    b = world.space.interpolate(a, b, np.random.default_rng(6).random(len(a)) ** 2)
    slow = FunctionWorld(world.space, world.valid, resolution)
    free = world.motion_valid(a, b)
    assert 0.1 < free.mean() < 0.99
    np.testing.assert_array_equal(free, slow.motion_valid(a, b))


@pytest.mark.parametrize("segments", [1, 2, 14, 15, 16, 17, 29, 30, 31, 32, 47, 48, 100])
def test_every_state_of_a_motion_is_looked_at(segments):
    """A ball that turns on a wheel meets a post at one state only, which must be found wherever it is."""
    turn = Joint("turn", "revolute", "base", "wheel", (0.0, 0.0, 0.0), STRAIGHT, Z, 0.0, 2.0)
    rim = Capsule((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1e-3, link="wheel")
    robot = Robot("wheel", ("base", "wheel"), (turn,), (rim,), (), ("turn",))
    length, count = 1.9, 2 * segments + 1
    for number, angle in enumerate(np.linspace(0.0, length, count)):
        post = Obstacle.of("post", "sphere", (1e-3,), (math.cos(angle), math.sin(angle), 0.0))
        world = ArmWorld(robot, Scene([post]), resolution=length / segments * (1.0 + 1e-9))
        # Every second post is between two states.
        assert world.motion_valid([[0.0]], [[length]])[0] == (number % 2 == 1), number


def test_explain_names_the_links_the_obstacle_or_the_joint_outside_its_limits():
    world = five_joints()
    assert world.explain([0.0, -math.pi / 2, 3.0, 0.0, 0.0]) == "'base' touches 'forearm'"
    assert world.explain([0.0, 0.5, 0.0, 0.0, 0.0]).endswith("touches 'table'")
    text = world.explain([0.0, 0.0, math.pi + 0.25, 0.0, 0.0])
    assert "'elbow_joint'" in text
    assert "0.25 outside its limits" in text


def test_explain_has_a_reason_for_whatever_is_not_free():
    world = five_joints()
    q = world.space.from_cube(np.random.default_rng(8).random((500, 5)))
    texts = [world.explain(row) for row in q[~world.valid(q)]]
    assert texts
    assert all("touches" in text for text in texts)
    assert world.explain(HOME) == "it is free"


def test_explain_has_a_reason_for_what_only_rounding_brings_into_contact():
    """The corner of a turned floor of 2 km: single precision knows its surface to a fraction of a millimetre."""
    tilt = (0.8, 0.0, 0.6, 0.0, 1.0, 0.0, -0.6, 0.0, 0.8)
    floor = Obstacle.of("floor", "box", (2000.0, 2000.0, 1.0), (-0.7, 0.0, -0.9), tilt)
    world = ArmWorld(ur5(math.pi, joints=5), Scene((floor,), name="hill"))
    q = world.space.from_cube(np.random.default_rng(12).random((500, 5)))
    _, blocked = edge(world, q)
    assert all("touches" in world.explain(row) for row in blocked)


def test_bodies_that_stand_in_contact_block_everything_and_are_named():
    scene = box_scene()
    world = ArmWorld(ur5(), scene.with_(Obstacle.of("post", "sphere", (0.1,), (0.0, 0.0, 0.0))))
    assert not world.valid(np.zeros((3, 6))).any()
    assert not world.motion_valid(np.zeros((3, 6)), np.ones((3, 6))).any()
    assert world.explain(np.zeros(6)).startswith("'base' touches 'post' wherever the joints are; ")


def test_outside_the_limits_nothing_is_free_however_far():
    world = five_joints()
    far = np.tile(HOME, (4, 1))
    far[:, 2] = [math.pi + 1e-9, -4.0, 1e30, 1e300]
    assert not world.valid(far).any()
    assert not world.motion_valid(far, np.tile(HOME, (4, 1))).any()


def test_an_obstacle_out_of_reach_changes_nothing():
    scene = box_scene()
    far = Obstacle.of("far", "box", (1.0, 1.0, 1.0), (50.0, 0.0, 0.0))
    # The first of all: what may touch what goes by the numbers of those that are left.
    world, more = ArmWorld(ur5(), scene), ArmWorld(ur5(), replace(scene, obstacles=(far, *scene.obstacles)))
    q = world.space.from_cube(np.random.default_rng(9).random((1_000, 6)))
    assert world.valid(q).any()
    np.testing.assert_array_equal(world.valid(q), more.valid(q))


def test_a_floor_of_a_hundred_kilometres_costs_no_digits():
    def floor(width):
        slab = Obstacle.of("floor", "box", (width, width, 0.2), (0.3 * width, 0.0, -0.1))
        allowed = frozenset({("base", "floor"), ("shoulder", "floor")})
        return ArmWorld(ur5(), Scene((slab,), allowed=allowed))

    q = floor(10.0).space.from_cube(np.random.default_rng(10).random((20_000, 6)))
    free = floor(10.0).valid(q)
    assert 0.1 < free.mean() < 0.9
    np.testing.assert_array_equal(floor(1e5).valid(q), free)


def test_a_robot_that_no_joint_moves_about_obstacles_only_has_limits():
    turn = Joint("turn", "revolute", "base", "wheel", (0.0, 0.0, 0.0), STRAIGHT, Z, 0.0, 2.0)
    post = Capsule((0, 0, 0), (0, 0, 1), 0.1, link="base")
    robot = Robot("wheel", ("base", "wheel"), (turn,), (post,), (), ("turn",))
    world = ArmWorld(robot, Scene((), name="empty"))
    np.testing.assert_array_equal(world.valid([[-0.1], [0.0], [2.0], [2.1]]), [False, True, True, False])


@pytest.mark.parametrize(("held", "value"), [({"wrist_3_joint": 0.7}, 0.7), ({}, 0.4)])
def test_a_joint_that_is_not_planned_for_is_held_at_its_value_or_at_the_limit_next_to_zero(held, value):
    whole = ur5()
    robot = replace(whole, joints=(*whole.joints[:5], replace(whole.joints[5], lower=0.4, upper=1.0)))
    # A finger that tells how the last joint is turned.
    finger = Capsule((0.3, 0.0, 0.0), (0.3, 0.1, 0.0), 0.02, link="wrist3")
    robot = replace(robot, capsules=(*robot.capsules, finger), pairs=(*robot.pairs, ("forearm", "wrist3")))
    five = replace(robot, group=robot.group[:5], held=held)
    scene = random_scene(1)
    q = ArmWorld(five, scene).space.from_cube(np.random.default_rng(2).random((2_000, 5)))
    verdicts = ArmWorld(five, scene).valid(q)
    np.testing.assert_array_equal(verdicts, ArmWorld(robot, scene).valid(np.c_[q, np.full(len(q), value)]))
    assert (verdicts != ArmWorld(robot, scene).valid(np.c_[q, np.full(len(q), 0.99)])).any()


def test_a_robot_of_lists_is_as_good_as_one_of_tuples():
    robot, scene = ur5(), random_scene(1)
    lists = replace(robot, capsules=[replace(c, a=list(c.a)) for c in robot.capsules])
    q = np.random.default_rng(1).uniform(-3.0, 3.0, (500, 6))
    np.testing.assert_array_equal(ArmWorld(lists, scene).valid(q), ArmWorld(robot, scene).valid(q))


@pytest.mark.parametrize("scene", [box_scene(), cloud_scene(15, 300)], ids=["boxes", "a cloud"])
def test_a_world_can_be_sent_to_another_process(scene):
    world = ArmWorld(ur5(math.pi, joints=5), scene)
    q = world.space.from_cube(np.random.default_rng(3).random((200, 5)))
    for sent in (pickle.loads(pickle.dumps(world)), copy.deepcopy(world)):
        np.testing.assert_array_equal(sent.valid(q), world.valid(q))


@pytest.mark.parametrize(("changes", "error", "words"), [
    ({"resolution": 0.0}, InvalidValue, "resolution"),
    ({"resolution": 1e-12}, InvalidValue, "resolution must be larger"),
])  # fmt: skip
def test_an_argument_out_of_range_is_named(changes, error, words):
    refused(error, words, five_joints, **changes)


def rod(length=1.0, radius=0.1, link="base"):
    return Capsule((0, 0, 0), (0, 0, length), radius, link=link)


@pytest.mark.parametrize(("change", "error", "words"), [
    ({"group": ("elbow_joint", "elbow_joint")}, InvalidValue, "each once"),
    ({"group": ()}, InvalidValue, "one joint or more"),
    ({"group": ("knee",)}, UnknownName, "unknown joint 'knee'"),
    ({"capsules": ()}, InvalidValue, "no capsules"),
    ({"capsules": (rod(link="hand"),)}, UnknownName, "unknown link 'hand'"),
    ({"capsules": (rod(length=1e8),)}, InvalidValue, "no larger than 1e"),
    ({"capsules": (rod(radius=1e8),)}, InvalidValue, "no larger than 1e"),
    ({"pairs": (("base", "hand"),)}, UnknownName, "unknown link 'hand'"),
    ({"held": {"knee": 1.0}}, UnknownName, "unknown joint 'knee'"),
])  # fmt: skip
def test_a_robot_that_is_not_sound_is_refused(change, error, words):
    refused(error, words, ArmWorld, replace(ur5(), **change), box_scene())


@pytest.mark.parametrize(("change", "words"), [
    ({"lower": 1.0, "upper": -1.0}, "lower below upper"), ({"upper": math.inf}, "must have limits"),
    ({"kind": "fixed"}, "cannot be planned for"),
    ({"mimic": Mimic("elbow_joint")}, "cannot be planned for"),
    ({"axis": (0.0, 0.0, 0.0)}, "must be a direction"), ({"xyz": (0.0, math.nan, 0.0)}, "finite numbers"),
    ({"xyz": (0.0, 1e39, 0.0)}, "reaches 1e[+]39 m"),
    ({"kind": "prismatic", "upper": 2e6}, "reaches 2e[+]06 m"),
    ({"lower": 1e12, "upper": 1e12 + 1.0}, "turns by up to 1e[+]12 rad"),
])  # fmt: skip
def test_a_joint_that_is_not_sound_is_refused(change, words):
    robot = ur5()
    joints = (replace(robot.joints[0], **change), *robot.joints[1:])
    refused(InvalidValue, words, ArmWorld, replace(robot, joints=joints), box_scene())


def gear(turn, follower):
    """A joint that turns, and one that follows it."""
    place = (0.0, 0.0, 0.0), STRAIGHT, Z
    joints = Joint("turn", turn[0], "a", "b", *place, *turn[1:]), replace(follower, parent="b", child="c")
    return Robot("gear", ("a", "b", "c"), joints, (rod(link="c"),), (), ("turn",))


def follower(mimic):
    return Joint("follower", "revolute", "", "", (0.0, 0.0, 0.0), STRAIGHT, Z, -1.0, 1.0, mimic=mimic)


@pytest.mark.parametrize(("mimic", "turn", "error", "words"), [
    (Mimic("turn", 0.5), ("continuous", -math.inf, math.inf), InvalidValue, "whole multiple"),
    # The bounds of its leader may be so narrow that the angle itself is small.
    (Mimic("turn", 1e39), ("revolute", -1e-39, 1e-39), InvalidValue, r"'turn' must do so .* at most 1e\+09"),
    (Mimic("turn", -1.0, 2e9), ("revolute", -1e-39, 1e-39), InvalidValue, r"'turn' must do so .* 1e\+09"),
    (Mimic("thumb"), ("revolute", -1.0, 1.0), UnknownName, "unknown joint 'thumb'"),
    (Mimic("follower"), ("revolute", -1.0, 1.0), InvalidValue, "mimics itself"),
])  # fmt: skip
def test_a_mimic_that_is_not_sound_is_refused(mimic, turn, error, words):
    refused(error, words, ArmWorld, gear(turn, follower(mimic)), Scene())


def test_an_obstacle_farther_away_than_single_precision_holds_is_refused():
    far = Obstacle.of("x", "sphere", (1e8,), (0, 1e8, 0))
    refused(InvalidValue, r"'x' must be within 1e[+]06 m", ArmWorld, ur5(), Scene((far,), name="x"))


@pytest.mark.parametrize("pair", [("hand", "table"), ("base", "chair")])
def test_an_allowed_contact_of_something_unknown_is_refused(pair):
    refused(UnknownName, "hand|chair", ArmWorld, ur5(), replace(box_scene(), allowed=frozenset({pair})))
