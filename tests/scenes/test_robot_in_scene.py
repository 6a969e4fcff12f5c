"""What a scene says of its robot: padding of links, and objects in the frames of links, placed when both are known."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import InvalidValue, UnknownName
from evenroad.robot import HeldObject, capsule_endpoints, in_scene
from evenroad.robots.planes import Plane
from evenroad.scenes.robot_in_scene import placed_scene
from evenroad.scenes.robot_setup import LinkFrames, RobotSetup
from tests.refused import refused
from tests.robots.urdf_texts import joint, link, urdf, write
from tests.scenes.planning_scenes import IDENTITY, at, box, places, scene_of

LIMITS = "<limit lower='{}' upper='{}' velocity='1' effort='1'/>"
OF_A_LINK = "is taken as the robot's root link, unless a link has this name"


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Two links of 1 m and 0.5 m that turn in a plane, and a hand whose joint cannot be at 0."""
    parts = [
        *(link(name) for name in ("base", "upper", "lower", "hand")),
        joint("a", "base", "upper", "revolute", LIMITS.format(-3, 3), "0 0 0", "0 0 1"),
        joint("b", "upper", "lower", "revolute", LIMITS.format(-3, 3), "1 0 0", "0 0 1"),
        joint("c", "lower", "hand", "revolute", LIMITS.format(1, 2), "0.5 0 0", "0 0 1"),
    ]
    return er.load_robot(write(tmp_path_factory.mktemp("arm"), urdf(*parts)))


def standing(**joints):
    return {"joint_state": {"name": [*joints], "position": [*joints.values()]}}


def in_one_frame(*objects, **more):
    with pytest.warns(UserWarning, match=OF_A_LINK):
        return scene_of(*objects, **more)


def on_lower(a, b, x, y=0.0):
    """Where a point of the lower link is: forward kinematics by hand."""
    turn = a + b
    forward, aside = math.cos(turn) * x - math.sin(turn) * y, math.sin(turn) * x + math.cos(turn) * y
    return (math.cos(a) + forward, math.sin(a) + aside, 0.0)


def test_an_object_in_the_frame_of_a_link_is_where_the_state_of_the_scene_has_the_link(arm):
    can = box("can", at(0.5), "lower", subframe_names=["lid"], subframe_poses=[at(0.0, 0.2)])
    objects = box("far", at(4.0)), can, box("onto", frame="can/lid"), box("beside", at(0.25), "can")
    placed = er.ArmWorld(arm, in_one_frame(*objects, robot_state=standing(a=0.3, b=0.4))).scene
    wanted = {"far": (4, 0, 0), "can": on_lower(0.3, 0.4, 0.5), "onto": on_lower(0.3, 0.4, 0.5, 0.2)}
    wanted["beside"] = on_lower(0.3, 0.4, 0.75)
    assert [*places(placed)] == [*wanted]
    np.testing.assert_allclose([*places(placed).values()], [*wanted.values()], atol=1e-12)
    turn = np.array(placed.obstacles[1].rotation).reshape(3, 3)
    np.testing.assert_allclose(turn[0], (math.cos(0.7), -math.sin(0.7), 0.0), atol=1e-12)


def test_an_object_in_the_frame_of_a_link_stays_where_it_is_when_the_robot_moves(arm):
    scene = in_one_frame(box("can", at(0.5, 0.1), "lower"), robot_state=standing(a=0.3, b=0.4))
    x, y, z = on_lower(0.3, 0.4, 0.5, 0.1)
    by_hand = er.Scene([er.Box((0.1, 0.1, 0.1), xyz=(x, y, z), rpy=(0.0, 0.0, 0.7))])
    q = np.random.default_rng(1).uniform((-3, -3, 1), (3, 3, 2), (2000, 3))
    free = er.ArmWorld(arm, scene).valid(q)
    np.testing.assert_array_equal(free, er.ArmWorld(arm, by_hand).valid(q))
    assert not free.all()
    # A plan reads the scene as a world does.
    planned = er.plan(scene, [-1.0, 0.0, 1.5], [2.0, 0.0, 1.5], robot=arm)
    assert places(planned.world.scene) == places(er.ArmWorld(arm, scene).scene)


def test_joints_of_which_nothing_is_said_are_where_moveit_has_them_or_the_robot_holds_them(arm):
    scene = in_one_frame(box("can", at(0.1), "hand"))
    held = er.robot.with_group(arm, ("a", "b"), {"c": 2.0})
    for robot, angle in ((arm, 1.5), (held, 2.0)):
        (place,) = places(placed_scene(robot, scene)).values()
        np.testing.assert_allclose(place, (1.5 + 0.1 * math.cos(angle), 0.1 * math.sin(angle), 0.0), atol=1e-12)


def test_what_is_attached_may_be_in_another_frame_than_that_of_its_link(arm):
    def attaching(frame, pose):
        crate = {"link_name": "hand", "object": box("crate", pose, frame)}
        return standing(a=0.3, b=0.4, c=1.0) | {"attached_collision_objects": [crate]}

    scene = scene_of(box("onto", at(0.0, 0.2), "crate"), robot_state=attaching("hand", at(0.1)))
    (onto,) = places(er.ArmWorld(in_scene(arm, scene), scene).scene).values()
    turn = 0.3 + 0.4 + 1.0
    x, y, _ = on_lower(0.3, 0.4, 0.5)
    wanted = x + 0.1 * math.cos(turn) - 0.2 * math.sin(turn), y + 0.1 * math.sin(turn) + 0.2 * math.cos(turn), 0.0
    np.testing.assert_allclose(onto, wanted, atol=1e-12)
    # One place, said in three frames.
    for frame, pose in (("world", at(x, y)), ("lower", at(0.5))):
        say = in_one_frame if frame == "lower" else scene_of
        (crate,) = placed_scene(arm, say(robot_state=attaching(frame, pose))).attached
        assert (crate.name, crate.link) == ("crate", "hand")
        np.testing.assert_allclose(crate.body.pose.xyz, 0.0, atol=1e-12)


def test_frames_and_joints_that_the_robot_does_not_have_are_refused(arm):
    for objects, state, said in (
        ([box("can", frame="lower"), box("cup", frame="lowr")], {}, "frame of object 'cup' .* did you mean 'lower'"),
        ([box("can", frame="lower"), box("cup", frame="hand")], standing(d=1.0), "joint in the state .* 'd'"),
    ):
        scene = scene_of(*objects, robot_state=state)
        refused(UnknownName, said, er.ArmWorld, arm, scene)
        refused(UnknownName, said, er.plan, scene, [0, 0, 1], [1, 0, 1], robot=arm)
    two = box("can"), box("can", frame="lower", operation="append")
    refused(InvalidValue, "all its shapes in one frame, got '' and 'lower'", scene_of, *two)
    away = {"translation": {"x": 1.0, "y": 0.0, "z": 0.0}, "rotation": IDENTITY["orientation"]}
    state = {"multi_dof_joint_state": {"joint_names": ["base"], "transforms": [away]}}
    refused(InvalidValue, "base away from the planning frame", scene_of, box("can"), robot_state=state)
    assert in_one_frame(box("can", frame="lower"), robot_state=state).names == ("can",)


def test_changes_of_a_scene_keep_the_frames_of_the_others(arm):
    frames = LinkFrames({"can": "upper", "cup": "lower"}, {"a": 0.3, "b": 0.4})
    bodies = [er.Sphere(0.1, xyz=(0.5, 0, 0), name=name) for name in ("can", "cup")]
    scene = er.Scene(bodies, setup=RobotSetup(frames=frames))
    can, cup = (0.5 * math.cos(0.3), 0.5 * math.sin(0.3), 0.0), on_lower(0.3, 0.4, 0.5)
    for changed, wanted in (
        (scene, {"can": can, "cup": cup}),
        (scene.moved({"can": er.Pose((2, 0, 0))}), {"can": (2, 0, 0), "cup": cup}),
        (scene.without("cup"), {"can": can}),
        (scene.without("cup").with_(er.Sphere(0.1, name="cup")), {"can": can, "cup": (0, 0, 0)}),
        (pickle.loads(pickle.dumps(scene)), {"can": can, "cup": cup}),
    ):
        found = places(placed_scene(arm, changed))
        assert [*found] == [*wanted]
        np.testing.assert_allclose([*found.values()], [*wanted.values()], atol=1e-12)
    assert placed_scene(arm, scene.without("can", "cup")).setup.frames is None
    assert scene.fingerprint() != er.Scene(bodies).fingerprint()
    assert placed_scene(arm, placed_scene(arm, scene)) == placed_scene(arm, scene)


def test_links_that_a_planning_scene_pads_are_larger_against_obstacles_by_their_padding():
    ball = {"type": 2, "dimensions": [0.1]}
    objects = [box("ball", at(0.4, 0.2, 0.5)) | {"primitives": [ball]}]
    padding = [{"link_name": "forearm_link", "padding": 0.04}, {"link_name": "tool0", "padding": 0.0}]
    scene = scene_of(*objects, link_padding=padding)
    robot = er.load_robot("ur5")
    world, q = er.ArmWorld(robot, scene), np.random.default_rng(3).uniform(-3, 3, (4000, 6))
    of_itself = er.ArmWorld(robot).valid(q)
    # Distances of segments from the ball's middle, by hand.
    near = np.full(len(q), np.inf)
    for capsule, ends in zip(robot.capsules, capsule_endpoints(robot, q).swapaxes(0, 1), strict=True):
        a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
        share = ((np.array((0.4, 0.2, 0.5)) - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-12)
        middle = a + np.clip(share, 0.0, 1.0)[:, np.newaxis] * along
        apart = np.linalg.norm(middle - (0.4, 0.2, 0.5), axis=1) - 0.1 - capsule.radius
        near = np.minimum(near, apart - (0.04 if capsule.link == "forearm_link" else 0.0))
    free = world.valid(q)
    assert not free[near <= 0.0].any()
    assert (free == of_itself)[near > world.excess + 1e-4].all()
    assert (of_itself & ~free).sum() > (of_itself & ~er.ArmWorld(robot, er.Scene(scene.obstacles)).valid(q)).sum()
    # The same padding once more changes nothing, a larger one of the robot stays, and 0.0 is none.
    assert world.robot.padding == er.ArmWorld(world.robot, scene).robot.padding == (("forearm_link", 0.04),)
    assert er.ArmWorld(robot.with_padding(0.05), scene).robot == robot.with_padding(0.05)
    assert (
        er.plan(scene, [0, -1.9, 1.6, -1.3, -1.57, 0], [0.3, -1.9, 1.6, -1.3, -1.57, 0], robot=robot).world.robot
        == world.robot
    )


def test_padding_of_a_scene_is_checked_with_its_robot():
    robot = er.load_robot("ur5")
    refused(UnknownName, "unknown link of 'ur5': 'tip'", er.ArmWorld, robot, er.Scene(padding={"tip": 0.01}))
    refused(InvalidValue, "the padding of 'tool0'", er.ArmWorld, robot, er.Scene(padding={"tool0": -0.01}))
    crate = HeldObject("crate", er.Box((0.1, 0.1, 0.1)), "tool0")
    both = er.Scene(padding={"tool0": 0.01}, attached=(crate,))
    assert in_scene(robot, both).padding == (("tool0", 0.01),)
    assert er.Scene(setup=both.setup) == both
    assert er.Scene(setup=both.setup, padding={}).attached == (crate,)


def test_a_world_within_another_scene_keeps_to_all_that_this_says_of_the_robot(arm):
    plane = Plane("floor", (0.0, 0.0, -0.5), (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), ("base",))
    robot = replace(arm, planes=(plane,))
    frames = RobotSetup(frames=LinkFrames({"can": "upper"}, {"a": 0.3}), padding={"lower": 0.02})
    scene = er.Scene([er.Sphere(0.1, xyz=(0.5, 0, 0), name="can")], setup=frames)
    for given in (scene, replace(scene, setup=replace(scene.setup, padding={}))):
        world, wanted = er.ArmWorld(robot).within(given), er.ArmWorld(robot, given)
        assert world.scene == wanted.scene
        assert world.scene.names == ("can", "floor")
        assert world.robot == wanted.robot
