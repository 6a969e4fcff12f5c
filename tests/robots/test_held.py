"""What a robot holds: verdicts are those of a robot that it is welded to, and nothing is held unseen."""

import math
import shutil

import numpy as np
import pytest

import evenroad as er
from evenroad.collision.certified import CertifiedWorld
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.geometry import Box, Cylinder, Pose, Sphere
from evenroad.loading.find import DATA
from evenroad.roadmap import build_roadmap
from evenroad.robot import ArmWorld, HeldObject, Obstacle, Scene, in_scene, link_poses, load_robot, load_scene
from tests.refused import refused
from tests.robots.kernel_arms import random_scene

UR5 = load_robot("ur5")
BOX = Box((0.1, 0.06, 0.3), pose=Pose.from_rpy((0.02, 0.0, 0.17), (0.1, 0.2, 0.3)))
WELDED = """  <link name="thing"><collision>{origin}<geometry>{shape}</geometry></collision></link>
  <joint name="weld" type="fixed"><parent link="{link}"/><child link="thing"/></joint>
</robot>"""
ORIGIN = '<origin xyz="0.02 0 0.17" rpy="0.1 0.2 0.3"/>'
SHAPES = {
    "box": (BOX, '<box size="0.1 0.06 0.3"/>'),
    "cylinder": (Cylinder(0.03, 0.2, pose=BOX.pose), '<cylinder radius="0.03" length="0.2"/>'),
    "ball": (Sphere(0.05, pose=BOX.pose), '<sphere radius="0.05"/>'),
}


@pytest.mark.parametrize(("name", "link"), [
    ("box", "tool0"), ("cylinder", "tool0"), ("ball", "tool0"), ("cylinder", "forearm_link"), ("ball", "forearm_link"),
])  # fmt: skip
def test_verdicts_are_those_of_a_urdf_with_the_object_welded_on(tmp_path, name, link):
    shape, element = SHAPES[name]
    text = (DATA / "ur5.urdf").read_text().replace("</robot>", WELDED)
    (tmp_path / "welded.urdf").write_text(text.format(origin=ORIGIN, shape=element, link=link))
    shutil.copy(DATA / "ur5.srdf", tmp_path)
    welded = load_robot(tmp_path / "welded.urdf", srdf=tmp_path / "ur5.srdf")
    held = UR5.holding(shape, link, name="thing")
    assert len(held.pairs) > len(UR5.pairs)
    blocked = 0
    for seed in range(3):
        scene = random_scene(seed, count=8, spread=0.9, clear=0.3)
        ours, theirs, bare = (ArmWorld(robot, scene) for robot in (held, welded, UR5))
        q = ours.space.from_cube(np.random.default_rng(seed).random((20_000, 6)))
        assert (ours.valid(q) == theirs.valid(q)).all()
        assert (ours.motion_valid(q[:500], q[500:1000]) == theirs.motion_valid(q[:500], q[500:1000])).all()
        some = slice(0, 200)
        proofs = [CertifiedWorld(world).motion_valid(q[some], q[some] + 0.1) for world in (ours, theirs)]
        assert (proofs[0] == proofs[1]).all()
        blocked += int((bare.valid(q) & ~ours.valid(q)).sum())
        assert not (ours.valid(q) & ~bare.valid(q)).any()
    assert blocked > 20


def test_without_an_srdf_neighbours_are_left_out_as_of_a_urdf(tmp_path):
    shape, element = SHAPES["ball"]
    text = (DATA / "arm7.urdf").read_text()
    bare = load_robot(shutil.copy(DATA / "arm7.urdf", tmp_path / "bare.urdf"))
    (tmp_path / "welded.urdf").write_text(
        text.replace("</robot>", WELDED).format(origin=ORIGIN, shape=element, link="flange")
    )
    welded = load_robot(tmp_path / "welded.urdf")
    assert set(bare.holding(shape, "flange", name="thing").pairs) == set(welded.pairs)


def test_what_it_may_touch_is_not_tested():
    held = UR5.holding(BOX, "tool0", touches=["wrist_2_link"])
    every = UR5.holding(BOX, "tool0")
    assert set(every.pairs) - set(held.pairs) == {("wrist_2_link", "held")}


def test_the_robot_itself_stays_as_it_was_and_can_put_the_object_down():
    before = UR5.fingerprint()
    held = UR5.holding(BOX, "tool0", name="crate")
    assert UR5.fingerprint() == before != held.fingerprint()
    assert held.holds == ("crate",)
    assert held.empty_handed() == UR5
    two = held.holding(Sphere(0.02), "forearm_link", name="camera")
    assert ("crate", "camera") in two.pairs
    assert two.empty_handed() == UR5
    assert UR5.empty_handed() is UR5


def test_a_verdict_names_what_is_held():
    scene = Scene((Obstacle.of("wall", "box", (0.02, 4.0, 4.0), (0.9, 0.0, 0.0)),), name="s")
    q = np.array([0.0, -0.3, 0.2, 0.1, math.pi / 2, 0.0])
    for length in (0.05, 0.6):
        world = ArmWorld(UR5.holding(Cylinder(0.02, length, pose=Pose((0, 0, length / 2))), "tool0", name="rod"), scene)
        if not world.valid(q[None])[0]:
            assert world.explain(q) == "'rod' touches 'wall'"
            return
    pytest.fail("the rod never reaches the wall")


def test_an_attached_object_of_a_scene_file_is_held_and_may_touch_what_it_says(tmp_path):
    (tmp_path / "pick.yaml").write_text(
        "obstacles:\n  table: {shape: box, size: [1, 1, 0.1], xyz: [0.3, 0, -0.05]}\n"
        "allowed: {table: [base_link, shoulder_link]}\n"
        "attach:\n  crate: {shape: box, size: [0.1, 0.1, 0.2], link: tool0, xyz: [0, 0, 0.1],"
        " touches: [wrist_2_link, table]}\n"
    )
    scene = load_scene(tmp_path / "pick.yaml")
    assert scene.attached == (
        HeldObject("crate", Box((0.1, 0.1, 0.2), pose=Pose((0, 0, 0.1))), "tool0", ("wrist_2_link",)),
    )
    assert ("crate", "table") in scene.allowed
    robot = in_scene(UR5, scene)
    assert robot.holds == ("crate",)
    assert in_scene(robot, scene) == robot
    home = [0, -1.57, 0, -1.57, 0, 0]
    result = er.plan(tmp_path / "pick.yaml", home, [0.8, -1.2, 1.0, -1.0, -1.57, 0], robot="ur5")
    assert result.solved


def test_a_world_of_a_robot_that_does_not_hold_what_its_scene_attaches_is_refused():
    scene = Scene(name="pick", attached=(HeldObject("crate", BOX, "tool0"),))
    refused(InvalidValue, r"attaches 'crate', which the robot does not hold: give .* in_scene", ArmWorld, UR5, scene)
    assert ArmWorld(in_scene(UR5, scene), scene).valid(np.zeros((1, 6))).shape == (1,)


def test_what_is_attached_twice_or_to_nothing_is_refused():
    crate = HeldObject("crate", BOX, "tool0")
    refused(InvalidValue, "attached twice under one name", lambda: UR5.holding(crate).holding(crate))
    refused(InvalidValue, "attached twice: crate", Scene, name="pick", attached=(crate, crate))
    other = HeldObject("crate", Sphere(0.1), "tool0")
    with pytest.raises(InvalidValue, match="have two bodies of that name"):
        in_scene(UR5.holding(other), Scene(name="pick", attached=(crate,)))
    with pytest.raises(InvalidValue, match="attached and as an obstacle"):
        Scene((Obstacle.of("crate", "sphere", (0.1,)),), name="pick", attached=(crate,))
    refused(UnknownName, "'hand'; known: base_link", UR5.holding, BOX, "hand")
    refused(UnknownName, "'finger'; known: base_link", UR5.holding, BOX, "tool0", touches=["finger"])
    refused(InvalidValue, "must be a Shape, got 'box'", UR5.holding, "box", "tool0")


@pytest.mark.parametrize(("entry", "match"), [
    ("{shape: box, size: [1, 1, 1]}", "must have the link that carries it"),
    ("{shape: box, size: [1, 1, .nan], link: tool0}", "must be"),
    ("{shape: cone, link: tool0}", "unknown shape of attached 'crate'"),
    ("{shape: sphere, radius: 0.1, link: tool0, touches: wrist}", "must be a list of links and obstacles"),
])  # fmt: skip
def test_what_is_wrong_with_an_attached_object_is_said(tmp_path, entry, match):
    (tmp_path / "pick.yaml").write_text(f"obstacles: {{}}\nattach:\n  crate: {entry}\n")
    refused((InvalidValue, UnknownName), match, load_scene, tmp_path / "pick.yaml")


def test_a_roadmap_serves_a_robot_with_its_hands_full():
    robot = load_robot("ur5")
    roadmap = build_roadmap(ArmWorld(robot), 256)
    rod = HeldObject("rod", Cylinder(0.03, 0.5, pose=Pose((0, 0, 0.25))), "tool0", ("wrist_2_link",))
    post = Obstacle.of("post", "box", (0.1, 0.1, 0.8), (0.5, 0.4, 0.4))
    scene = Scene((post,), name="today", attached=(rod,))
    known = roadmap.within(ArmWorld(in_scene(robot, scene), scene))
    assert known.world.robot.holds == ("rod",)
    q = known.world.space.from_cube(np.random.default_rng(2).random((400, 6)))
    free = q[known.world.valid(q)]
    solved = 0
    for start, goal in zip(free[0:12:2], free[1:12:2], strict=True):
        result = known.plan(start, goal)
        if result.solved:
            solved += 1
            assert CertifiedWorld(known.world).validate(result.path).all()
    assert solved >= 3


def test_a_file_that_attaches_something_twice_is_refused(tmp_path):
    entry = "  crate: {shape: sphere, radius: 0.1, link: tool0}\n"
    (tmp_path / "pick.yaml").write_text(f"obstacles: {{}}\nattach:\n{entry}{entry}")
    refused(BrokenFile, "crate", load_scene, tmp_path / "pick.yaml")


def test_a_goal_pose_may_be_that_of_what_is_held():
    held = HeldObject(
        "crate", Box((0.1, 0.1, 0.2), pose=Pose.from_rpy((0, 0, 0.12), (0, 0.3, 0))), "tool0", ("wrist_2_link",)
    )
    goal = Pose.from_rpy((0.4, 0.2, 0.5), (0.0, 2.5, 0.0))
    start = [0.5, -1.9, 1.2, -0.8, -1.57, 0.0]
    result = er.plan(Scene(name="air", attached=(held,)), start, goal, robot="ur5", tip="crate")
    assert result.solved
    robot = in_scene(UR5, Scene(name="air", attached=(held,)))
    at = link_poses(robot, result.path[-1:])[0]
    assert np.abs(at[robot.links.index("crate")] - goal.matrix).max() < 1e-6
    tool = at[robot.links.index("tool0")] @ held.body.pose.matrix
    assert np.abs(tool - goal.matrix).max() < 1e-6
