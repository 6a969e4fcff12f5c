import pytest

from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.robot import load_robot
from evenroad.trajectory import Limits, limits_of
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


@pytest.mark.parametrize(("text", "error", "said"), [
    ("joint_limits: 3\n", BrokenFile, "mapping"), ("joint_limits: {elbow: {}}\n", UnknownName, "elbow"),
    ("joint_limits: {elbow_joint: 3}\n", BrokenFile, "elbow_joint"),
    ("joint_limits: {elbow_joint: {max_speed: 3}}\n", UnknownName, "max_speed"),
    ("joint_limits: {elbow_joint: {max_velocity: 0}}\n", InvalidValue, "max_velocity of elbow_joint"),
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
