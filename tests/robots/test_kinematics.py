import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.errors import InvalidValue
from evenroad.robot import Joint, Robot, capsule_endpoints, joint_values, link_poses, load_robot, tip_links, with_group
from tests.robots.kernel_arms import STRAIGHT
from tests.robots.urdf_texts import LIMIT, joint, link, urdf, write

TABLE = (
    ((0, 0, 0.089159), 0, "z"),
    ((0, 0.13585, 0), np.pi / 2, "y"),
    ((0, -0.1197, 0.425), 0, "y"),
    ((0, 0, 0.39225), np.pi / 2, "y"),
    ((0, 0.093, 0), 0, "z"),
    ((0, 0, 0.09465), 0, "y"),
)
"""Of a UR5: origin, pitch and axis of each joint."""


def _about(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(4)
    if axis == "x":
        matrix[1:3, 1:3] = [[c, -s], [s, c]]
    elif axis == "y":
        matrix[0, 0], matrix[0, 2], matrix[2, 0], matrix[2, 2] = c, s, -s, c
    else:
        matrix[:2, :2] = [[c, -s], [s, c]]
    return matrix


def _shift(xyz):
    matrix = np.eye(4)
    matrix[:3, 3] = xyz
    return matrix


def _ur5_flange(q):
    pose = np.eye(4)
    for (xyz, pitch, axis), angle in zip(TABLE, q, strict=True):
        pose = pose @ _shift(xyz) @ _about("y", pitch) @ _about(axis, angle)
    return pose @ _shift((0, 0.0823, 0)) @ _about("x", -np.pi / 2)


def test_the_ur5_stands_where_its_table_of_joints_says():
    robot = load_robot("ur5")
    q = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 6))
    expected = [_ur5_flange(row) for row in q]
    np.testing.assert_allclose(link_poses(robot, q)[:, robot.links.index("tool0")], expected, atol=1e-12)


@settings(max_examples=30, deadline=None)
@given(q=st.lists(st.floats(-6, 6), min_size=7, max_size=7))
def test_frames_stay_rigid(q):
    poses = link_poses(load_robot("arm7"), [q])[0]
    turned = poses[:, :3, :3]
    np.testing.assert_allclose(turned @ turned.transpose(0, 2, 1), np.tile(np.eye(3), (len(turned), 1, 1)), atol=1e-12)
    assert (np.linalg.det(turned) > 0).all()


def test_a_slide_moves_along_its_axis_and_a_mimic_follows(tmp_path):
    inside = LIMIT + "<mimic joint='slide' multiplier='2' offset='0.1'/>"
    text = urdf(
        *(link(name) for name in ("base", "cart", "wheel")),
        joint("slide", "base", "cart", "prismatic", xyz="0 0 1", axis="0 3 4"),
        joint("turn", "cart", "wheel", "revolute", inside, "0 0 0", "0 0 1"),
    )
    robot = load_robot(write(tmp_path, text))
    assert robot.group == ("slide",)
    assert joint_values(robot, [[0.5]]) == {"slide": [0.5], "turn": [1.1]}
    cart, wheel = link_poses(robot, [[0.5]])[0, 1:]
    np.testing.assert_allclose(cart[:3, 3], [0, 0.3, 1.4])
    np.testing.assert_allclose(wheel[:3, :3], _about("z", 1.1)[:3, :3], atol=1e-15)


def test_what_is_not_in_the_group_is_held_within_its_limits(tmp_path):
    inside = "<limit lower='0.2' upper='1' velocity='1' effort='1'/>"
    text = urdf(*(link(name) for name in "xyz"), joint("a", "x", "y"), joint("b", "y", "z", inside=inside))
    robot = load_robot(write(tmp_path, text), group=["a"])
    assert joint_values(robot, [[0.0]])["b"] == 0.2
    assert joint_values(with_group(robot, ["a"], {"b": 0.7}), [[0.0]])["b"] == 0.7


def test_capsules_move_with_their_links():
    robot = load_robot("ur5")
    q = np.random.default_rng(1).uniform(-3, 3, (3, 6))
    ends, poses = capsule_endpoints(robot, q), link_poses(robot, q)
    for i, capsule in enumerate(robot.capsules):
        for j in range(3):
            frame = poses[j, robot.links.index(capsule.link)]
            np.testing.assert_allclose(ends[j, i, 0], (frame @ [*capsule.a, 1])[:3], atol=1e-15)
            np.testing.assert_allclose(ends[j, i, 1], (frame @ [*capsule.b, 1])[:3], atol=1e-15)


@pytest.mark.parametrize("q", [np.zeros(6), np.zeros((2, 5))])
def test_configurations_of_another_shape_are_refused(q):
    with pytest.raises(InvalidValue, match=r"q must have the shape \(n, 6\)"):
        link_poses(load_robot("ur5"), q)


def test_the_tip_of_a_chain_is_its_last_link_before_it_branches():
    def moved(name, parent, child, kind="revolute"):
        return Joint(name, kind, parent, child, (0.0, 0.0, 0.1), STRAIGHT)

    joints = (
        moved("left", "body", "left arm"),
        moved("left wrist", "left arm", "left hand"),
        moved("thumb", "left hand", "thumb"),
        moved("finger", "left hand", "finger"),
        moved("right", "body", "right arm"),
        moved("flange", "right arm", "right flange", "fixed"),
    )
    links = ("body", "left arm", "left hand", "thumb", "finger", "right arm", "right flange")
    robot = Robot("two arms", links, joints, (), (), ("left", "left wrist", "right"))
    assert tip_links(robot) == ("left hand", "right flange")
    assert tip_links(dataclasses.replace(robot, group=("left",))) == ("left hand",)
