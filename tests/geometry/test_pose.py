import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from evenroad.errors import InvalidValue
from evenroad.geometry import Pose, rotation_from_quaternion, rotation_from_rpy
from evenroad.geometry.rotation import rotation_from_z
from tests.refused import refused

RNG = np.random.default_rng(1)
RPY = RNG.uniform(-1.5, 1.5, (5, 3))
QUATERNIONS = RNG.normal(size=(5, 4))
POSES = [Pose.from_rpy(xyz, rpy) for xyz, rpy in zip(RNG.normal(size=(5, 3)), RPY, strict=True)]


@pytest.mark.parametrize("rpy", RPY)
def test_roll_pitch_and_yaw_are_about_fixed_axes(rpy):
    expected = Rotation.from_euler("xyz", rpy).as_matrix()
    np.testing.assert_allclose(np.reshape(rotation_from_rpy(*rpy), (3, 3)), expected, atol=1e-15)


def test_quaternions_have_the_order_of_scipy_and_any_norm():
    expected = Rotation.from_quat(QUATERNIONS).as_matrix()
    one_by_one = [np.reshape(rotation_from_quaternion(xyzw=q), (3, 3)) for q in QUATERNIONS]
    np.testing.assert_allclose(one_by_one, expected, atol=1e-15)


@pytest.mark.parametrize("axis", [(0, 0, 2), (0, 0, -1), (1, 2, 3), (1e-9, 0, -1)])
def test_a_rotation_from_z_takes_z_to_the_axis(axis):
    rotation = rotation_from_z(axis)
    np.testing.assert_allclose(rotation[:, 2], np.array(axis) / np.linalg.norm(axis), atol=1e-15)
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-15)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("pose", POSES)
def test_a_pose_is_its_matrix(pose):
    points = RNG.normal(size=(4, 3))
    by_matrix = (pose.matrix @ np.column_stack([points, np.ones(4)]).T).T[:, :3]
    np.testing.assert_allclose(pose.apply(points), by_matrix, atol=1e-14)
    np.testing.assert_allclose(pose.apply(points[0]), by_matrix[0], atol=1e-14)
    np.testing.assert_allclose(pose.local(pose.apply(points)), points, atol=1e-14)
    np.testing.assert_allclose(pose.local(pose.apply(points[1])), points[1], atol=1e-14)
    np.testing.assert_allclose(pose.inverse().matrix, np.linalg.inv(pose.matrix), atol=1e-14)
    assert Pose.from_matrix(pose.matrix) == pose


def test_the_right_one_of_two_composed_poses_comes_first():
    for first, second in pairwise(POSES):
        np.testing.assert_allclose((second @ first).matrix, second.matrix @ first.matrix, atol=1e-14)


def test_a_quarter_about_y_of_scipy_is_a_quarter_about_y():
    turn = Rotation.from_euler("y", 90, degrees=True)
    pose = Pose.from_quaternion((0, 0, 0), xyzw=turn.as_quat())
    np.testing.assert_allclose(pose.rotation_matrix, turn.as_matrix(), atol=1e-15)


def test_a_quaternion_whose_order_one_could_guess_is_refused():
    for guess in (
        lambda: Pose.from_quaternion((0, 0, 0), (0, 0, 0, 1)),
        lambda: rotation_from_quaternion((1, 0, 0, 0)),
    ):
        refused(InvalidValue, r"xyzw=\(x, y, z, w\), by its keyword: others have w first", guess)


STRETCHED = np.diag([2.0, 1.0, 1.0, 1.0])
MIRRORED = np.diag([-1.0, 1.0, 1.0, 1.0])


@pytest.mark.parametrize(("make", "says"), [
    (lambda: Pose((0, 0, math.inf)), "xyz must be 3 finite"),
    (lambda: Pose((0, 0)), "xyz must be 3 finite"),
    (lambda: Pose((0, 0, 0), rpy=(0, 0, 1), xyzw=(0, 0, 0, 1)), "one of rotation, rpy and xyzw"),
    (lambda: Pose((0, 0, 0), (1.0, 0.0)), "rotation must be 9 finite"),
    (lambda: Pose.from_matrix(STRETCHED), "perpendicular rows of length 1, got .*2.0"),
    (lambda: Pose.from_matrix(MIRRORED), "reflection, got .*-1.0"),
    (lambda: Pose.from_matrix(np.eye(3)), "4x4 matrix with the last row 0, 0, 0, 1"),
    (lambda: Pose.from_matrix(np.full((4, 4), 0.5)), "last row"),
    (lambda: Pose.from_matrix("pose"), "4x4 matrix of numbers, got 'pose'"),
    (lambda: Pose.from_quaternion((0, 0, 0), xyzw=(0, 0, 0, 0)), "norm > 0"),
    (lambda: Pose.from_quaternion((0, 0, 0), xyzw=(1, 0, 0)), "4 finite"),
    (lambda: Pose.from_rpy((0, 0, 0), (0, math.nan, 0)), "rpy must be 3 finite"),
    (lambda: rotation_from_z((0, 0, 0)), "must be a direction"),
])  # fmt: skip
def test_what_is_no_pose_is_refused_with_its_value(make, says):
    refused(InvalidValue, says, make)


def test_a_pose_takes_and_gives_angles_and_quaternions():
    rng = np.random.default_rng(0)
    for angles in rng.uniform(-1.5, 1.5, (50, 3)).tolist():
        pose = Pose((1, 2, 3), rpy=angles)
        assert pose == Pose.from_rpy((1, 2, 3), angles)
        theirs = Rotation.from_euler("xyz", angles)
        assert np.allclose(pose.rpy, angles)
        x, y, z, w = theirs.as_quat()
        assert np.allclose(pose.xyzw, np.array([x, y, z, w]) * (1 if w >= 0 else -1))
        assert np.allclose(Pose(pose.xyz, xyzw=pose.xyzw).matrix, pose.matrix)
    for quaternion in ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0.5, -0.5, 0.5, 0.5)):
        assert np.allclose(np.abs(Pose(xyzw=quaternion).xyzw), np.abs(quaternion))


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
def test_angles_at_the_gimbal_give_the_same_rotation(pitch):
    pose = Pose(rpy=(0.3, pitch, 0.7))
    assert np.allclose(Pose(rpy=pose.rpy).rotation, pose.rotation, atol=1e-8)


def test_a_pose_shows_itself_as_it_can_be_written():
    assert repr(Pose((1, 2, 3))) == "Pose((1, 2, 3))"
    assert repr(Pose((1, 2, 3), rpy=(0, 0, 0.5))) == "Pose((1, 2, 3), rpy=(0, 0, 0.5))"
