"""What one asks a robot by itself, as one types it."""

import numpy as np
import pytest

import evenroad as er
from evenroad.robot import link_poses
from tests.refused import refused

ARM, TURNING = er.load_robot("ur5"), er.load_robot("arm7")


@pytest.mark.parametrize("robot", [ARM, TURNING], ids=lambda robot: robot.name)
def test_limits_are_those_of_the_joints_in_the_order_of_the_group(robot):
    assert robot.joint_names == robot.group
    assert robot.limits.shape == (robot.dof, 2) == (len(robot.group), 2)
    joints = {joint.name: joint for joint in robot.joints}
    for name, (lower, upper) in zip(robot.joint_names, robot.limits, strict=True):
        assert (lower, upper) == (joints[name].lower, joints[name].upper)


def test_a_configuration_may_be_numbers_a_mapping_with_0_where_it_is_silent_or_a_state():
    row = ARM.configuration("home")
    places = [row, row.tolist(), dict(zip(ARM.joint_names, row, strict=True)), "home", ARM.states["home"]]
    (pose,) = {ARM.fk(place, "tool0") for place in places}
    frame = link_poses(ARM, row[np.newaxis])[0, ARM.links.index("tool0")]
    assert np.allclose(pose.matrix, frame, rtol=0, atol=1e-15)
    assert ARM.fk({"elbow_joint": -1.5}, "tool0") == ARM.fk([0, 0, -1.5, 0, 0, 0], "tool0")


@pytest.mark.parametrize("robot", [ARM, TURNING], ids=lambda robot: robot.name)
def test_what_inverse_kinematics_finds_is_where_it_should_be(robot):
    for q in robot.random(3, 5):
        pose = robot.fk(q)
        found = robot.ik(pose, start=q)
        assert len(found)
        assert np.abs(found[0] - q).max() < 1e-4, "the nearest to the start comes first"
        assert (found >= robot.limits[:, 0]).all()
        assert (found <= robot.limits[:, 1]).all()
        for each in found:
            assert np.allclose(robot.fk(each).matrix, pose.matrix, rtol=0, atol=1e-6)


def test_out_of_reach_is_no_configuration_at_all():
    assert ARM.ik(er.Pose((9, 0, 0))).shape == (0, 6)


def test_random_configurations_lie_within_the_limits_and_are_those_of_their_seed():
    drawn = ARM.random(1, 200)
    assert (drawn >= ARM.limits[:, 0]).all()
    assert (drawn <= ARM.limits[:, 1]).all()
    assert np.array_equal(drawn, ARM.random(1, 200))
    assert not np.array_equal(drawn, ARM.random(2, 200))
    assert np.array_equal(ARM.random(5), ARM.random(5, 1)[0])
    assert np.abs(drawn.mean(axis=0) - ARM.limits.mean(axis=1)).max() < np.ptp(ARM.limits, axis=1).max() / 10


def test_a_robot_shows_itself_in_one_line():
    assert repr(ARM) == "Robot('ur5', 6 joints, 8 links)"


def test_a_world_is_made_of_names_files_and_shapes(tmp_path):
    named = er.ArmWorld("ur5", "box-reach")
    assert named.fingerprint() == er.ArmWorld(ARM, er.load_scene("box-reach")).fingerprint()
    assert er.ArmWorld(ARM).scene.obstacles == ()
    assert er.ArmWorld("ur5", [er.Sphere(0.1, xyz=(0.4, 0, 0.4))]).dim == 6
    for wrong in ((7, er.Scene()), (ARM, 7), ("ur6", er.Scene())):
        refused(er.errors.EvenroadError, "", er.ArmWorld, *wrong)
    assert "\n" not in repr(named)


def test_a_world_answers_of_one_configuration_as_of_many():
    world = er.ArmWorld("ur5", "box-reach")
    rows = np.concatenate([ARM.random(4, 40), ARM.configuration("home")[np.newaxis]])
    verdicts = [world.valid(row) for row in rows]
    assert verdicts == world.valid(rows).tolist() and len(set(verdicts)) == 2  # noqa: PT018
    assert all(type(each) is bool for each in verdicts)
    assert [world.motion_valid(rows[-1], row) for row in rows] == world.motion_valid(
        np.repeat(rows[-1:], len(rows), axis=0), rows
    ).tolist()
    assert world.valid("home") is world.valid(ARM.states["home"]) is True
    assert world.explain("home") == "it is free"
    refused(er.errors.InvalidValue, "6 finite numbers", world.valid, (0.0, 1.0))


def test_the_jacobian_is_how_the_pose_changes(tmp_path):
    """By differences of poses, also with a joint that slides and one that follows another, three times as fast."""
    text = """<robot name="slide"><link name="a"/><link name="b"/><link name="c"/><link name="d">
        <collision><geometry><sphere radius="0.01"/></geometry></collision></link>
      <joint name="turn" type="continuous"><parent link="a"/><child link="b"/>
        <origin xyz="0.1 0 0.2" rpy="0.3 0.1 0"/><axis xyz="0 0.6 0.8"/></joint>
      <joint name="slide" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0 0.3 0" rpy="0 0.4 0"/>
        <axis xyz="1 0 0"/><limit lower="-1" upper="1" velocity="0.5" effort="1"/></joint>
      <joint name="tilt" type="revolute"><parent link="c"/><child link="d"/><origin xyz="0.2 0 0"/>
        <axis xyz="0 1 0"/><limit lower="-6" upper="6" velocity="2" effort="1"/>
        <mimic joint="turn" multiplier="3" offset="0.1"/></joint></robot>"""
    (tmp_path / "slide.urdf").write_text(text)
    slide = er.load_robot(tmp_path / "slide.urdf")
    for robot, link, q in ((er.load_robot("ur5"), "tool0", [0.1, -1.2, 0.7, 0.3, -0.4, 2.0]), (slide, "d", [0.4, 0.2])):
        step = 1e-6
        columns = robot.jacobian(q, link)
        assert columns.shape == (6, robot.dof)
        for i, change in enumerate(step * np.eye(robot.dof)):
            before, after = (robot.fk(np.add(q, sign * change), link).matrix for sign in (-1, 1))
            np.testing.assert_allclose(columns[:3, i], (after - before)[:3, 3] / (2 * step), atol=1e-8)
            turn = (after[:3, :3] @ before[:3, :3].T - np.eye(3)) / (2 * step)
            np.testing.assert_allclose(columns[3:, i], (turn[2, 1], turn[0, 2], turn[1, 0]), atol=1e-5)
    assert slide.velocity_limits[1] == 0.5
