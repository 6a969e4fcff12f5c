"""The SRDF that is written to start from: which joints it has as the arm."""

from itertools import pairwise

from evenroad.loading.written_srdf import srdf_text
from evenroad.robot import load_model
from tests.robots.urdf_texts import joint, link, urdf, write


def test_a_last_joint_that_opens_a_gripper_is_no_joint_of_the_written_arm(tmp_path):
    names = ("base", "upper", "wrist", "jaw")
    turns = ("Gripper", "elbow", "pan")
    # Some files name their joints from the hand on.
    moving = [joint(name, a, b) for name, a, b in zip(turns, names[2::-1], names[:0:-1], strict=True)]
    path = write(tmp_path, urdf(*map(link, names), *moving))
    assert load_model(path).robot.group == turns
    written = write(tmp_path, srdf_text(load_model(path)), "arm.srdf")
    again = load_model(path, srdf=written).robot
    assert set(again.group) == {"pan", "elbow"}
    assert {"home", "ready"} <= set(again.states)
    assert load_model(path, srdf=written, group="jaw").robot.group == ("Gripper",)
    fingers = urdf(*map(link, names), *(joint(f"finger{b}", a, b) for a, b in pairwise(names)))
    assert srdf_text(load_model(write(tmp_path, fingers))).count("<group name") == 1
