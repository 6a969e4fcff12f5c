import numpy as np
import pytest

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.robot import load_robot
from evenroad.trajectory import Limits, limits_of
from evenroad.trajectory.make import make_trajectory
from tests.refused import refused


@pytest.fixture
def arm():
    return load_robot("ur5")


def write(tmp_path, text):
    file = tmp_path / "joint_limits.yaml"
    file.write_text(text)
    return file


def test_velocities_are_those_of_the_urdf_and_full_speed_takes_half_a_second(arm):
    limits = limits_of(arm)
    assert limits.velocity == (3.15, 3.15, 3.15, 3.2, 3.2, 3.2)
    assert limits.acceleration == tuple(2 * v for v in limits.velocity)
    assert limits.jerk is None


def test_a_file_replaces_what_it_names(arm, tmp_path):
    file = write(
        tmp_path,
        "joint_limits:\n"
        "  elbow_joint: {has_velocity_limits: true, max_velocity: 1.5, max_acceleration: 4}\n"
        "  wrist_1_joint: {has_acceleration_limits: false, max_acceleration: 99}\n",
    )
    limits = limits_of(arm, file)
    assert limits.velocity == (3.15, 3.15, 1.5, 3.2, 3.2, 3.2)
    assert limits.acceleration == (6.3, 6.3, 4.0, 6.4, 6.4, 6.4)


def test_jerk_is_limited_where_every_joint_has_one(arm, tmp_path):
    rows = "".join(f"  {name}: {{max_jerk: 50}}\n" for name in arm.group)
    assert limits_of(arm, write(tmp_path, "joint_limits:\n" + rows)).jerk == (50.0,) * 6


def test_one_jerk_limits_that_joint_and_others_reach_full_acceleration_with_it(arm, tmp_path):
    limits = limits_of(arm, write(tmp_path, "joint_limits: {elbow_joint: {max_jerk: 50}}\n"))
    assert limits.jerk[2] == 50.0
    np.testing.assert_allclose(np.divide(limits.acceleration, limits.jerk), limits.acceleration[2] / 50.0)


def test_factors_of_all_joints_scale_velocities_and_accelerations(arm, tmp_path):
    text = "default_velocity_scaling_factor: 0.1\ndefault_acceleration_scaling_factor: 0.5\n"
    limits, plain = limits_of(arm, write(tmp_path, text + "joint_limits: {}\n")), limits_of(arm)
    np.testing.assert_allclose(limits.velocity, np.multiply(0.1, plain.velocity))
    np.testing.assert_allclose(limits.acceleration, np.multiply(0.5, plain.acceleration))


def test_pilz_decelerations_below_zero_are_kept(arm, tmp_path):
    text = "joint_limits: {elbow_joint: {has_deceleration_limits: true, max_deceleration: -2.5}}\n"
    limits = limits_of(arm, write(tmp_path, text))
    assert (limits.acceleration[2], limits.deceleration[2]) == (6.3, 2.5)
    off = text.replace("true", "false")
    assert limits_of(arm, write(tmp_path, off)) == limits_of(arm)


@pytest.mark.parametrize("row", [
    "{min_position: -0.5, max_position: 0.5}", "{max_position: 0.5, soft_lower_limit: -0.5}",
])  # fmt: skip
def test_a_path_beyond_the_positions_of_a_file_gets_no_times(arm, tmp_path, row):
    limits = limits_of(arm, write(tmp_path, f"joint_limits: {{elbow_joint: {row}}}\n"))
    assert limits.position[2] == (-0.5, 0.5)
    still, beyond = [0.0] * 6, [0.0, 0.0, 0.6, 0.0, 0.0, 0.0]
    with pytest.raises(InvalidValue, match=r"'elbow_joint' at 0.6, 0.1 outside its limits of position \[-0.5, 0.5\]"):
        make_trajectory([still, beyond, still], limits, names=arm.group)
    assert make_trajectory([still, np.multiply(0.5, beyond)], limits, names=arm.group).duration > 0.0
    off = f"joint_limits: {{elbow_joint: {row[:-1]}, has_position_limits: false, has_soft_limits: false}}}}\n"
    assert limits_of(arm, write(tmp_path, off)).position is None


@pytest.mark.parametrize(("change", "says"), [
    ("zzz: 1\njoint_limits: {}\n", "key of .*joint_limits.yaml: 'zzz'"),
    ("joint_limits: {elbow_joint: {zzz: 1}}\n", "key of elbow_joint of joint_limits in .*: 'zzz'"),
    ("joint_limits: {elbow_joint: {max_positoin: 1}}\n", "did you mean 'max_position'"),
    ("cartesian_limits: {max_trans_vel: 1}\njoint_limits: {}\n", "TipLimits"),
])  # fmt: skip
def test_what_a_file_has_besides_is_refused_by_name(arm, tmp_path, change, says):
    refused(UnknownName, says, limits_of, arm, write(tmp_path, change))


@pytest.mark.parametrize(("text", "error", "said"), [
    ("joint_limits: 3\n", BrokenFile, "mapping"), ("joint_limits: {elbow: {}}\n", UnknownName, "elbow"),
    ("joint_limits: {elbow_joint: 3}\n", BrokenFile, "elbow_joint"),
    ("joint_limits: {elbow_joint: {max_speed: 3}}\n", UnknownName, "max_speed"),
    ("joint_limits: {elbow_joint: {max_velocity: 0}}\n", InvalidValue, "max_velocity of elbow_joint"),
    ("joint_limits: {elbow_joint: {min_position: 1, max_position: 0}}\n", InvalidValue, "min < max"),
    ("default_velocity_scaling_factor: 1.5\n", InvalidValue, "at most 1"),
    ("joint_limits: {elbow_joint: {has_velocity_limits: 'no', max_velocity: 1}}\n", InvalidValue, "true or false"),
    ("joint_limits: {elbow_joint: {max_acceleration: fast}}\n", InvalidValue, "max_acceleration"),
])  # fmt: skip
def test_bad_files_are_named(arm, tmp_path, text, error, said):
    refused(error, said, limits_of, arm, write(tmp_path, text))


@pytest.mark.parametrize("speed", [0.0, -1.0, 1.5, float("nan")])
def test_speed_is_a_share(speed):
    refused(InvalidValue, "speed", lambda: Limits((1.0,), (1.0,)).at_speed(speed))


@pytest.mark.parametrize("rows", [((0.0,), (1.0,)), ((1.0,), (1.0, 1.0)), ((1.0,), (float("inf"),)), ((), ())])
def test_limits_are_positive_and_as_many_as_joints(rows):
    refused(InvalidValue, "", Limits, *rows)
