"""Our planner of mplib's names: what a script reads is what the arm may do."""

import numpy as np
import pytest

import evenroad as er
from evenroad.adapters.mplib import Planner
from evenroad.errors import InvalidValue, UnknownName

ARM = """<robot name="reach">
  <link name="root"/>
  {links}
  <link name="left_finger"/>
  <joint name="left_finger_joint" type="prismatic"><parent link="tip"/><child link="left_finger"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="1" velocity="1"/></joint>
</robot>"""
CHAIN = (("z", 0.3), ("y", 0.0), ("y", 0.4), ("z", 0.0), ("y", 0.4), ("z", 0.0))
BASE = (-0.5, 0.2, 0.1, np.cos(0.4), 0.0, 0.0, np.sin(0.4))
HOME = np.array([0.2, 0.5, 1.2, 0.1, 0.6, 0.3, 0.02])


def arm_file(folder):
    rows, before = [], "root"
    for i, (axis, up) in enumerate(CHAIN):
        link = "tip" if i == len(CHAIN) - 1 else f"link{i}"
        ball = '<collision><geometry><sphere radius="0.05"/></geometry></collision>' if up else ""
        rows.append(
            f'<link name="{link}">{ball}</link><joint name="joint{i}" type="revolute"><parent link="{before}"/>'
            f'<child link="{link}"/><origin xyz="0 0 {up}"/><axis xyz="{int(axis == "x")} {int(axis == "y")}'
            f' {int(axis == "z")}"/><limit lower="-2.5" upper="2.5" effort="1" velocity="3"/></joint>'
        )
        before = link
    file = folder / "reach.urdf"
    file.write_text(ARM.format(links="".join(rows)))
    return file


@pytest.fixture
def planner(tmp_path):
    joints = [*(f"joint{i}" for i in range(6)), "left_finger_joint"]
    planner = Planner(arm_file(tmp_path), "", ["root", "tip"], joints, "tip")
    planner.set_base_pose(BASE)
    return planner


def base():
    return er.Pose(BASE[:3], xyzw=(*BASE[4:], BASE[3]))


def seen(planner, q):
    """Pose of the tip in the world's frame."""
    return base() @ planner.robot.fk(q, "tip")


def asked(pose):
    return [*pose.xyz, pose.xyzw[3], *pose.xyzw[:3]]


def moved(planner, x, y, z):
    here = seen(planner, HOME[:6])
    return er.Pose(tuple(np.add(here.xyz, (x, y, z))), here.rotation)


def test_the_tip_moves_in_a_straight_line_to_a_pose_of_the_worlds_frame(planner):
    goal = moved(planner, 0.1, -0.08, 0.05)
    answer = planner.plan_screw(asked(goal), HOME, time_step=0.05, use_point_cloud=False)
    assert answer["status"] == "Success"
    tips = np.array([seen(planner, q).xyz for q in answer["position"]])
    np.testing.assert_allclose(tips[-1], goal.xyz, atol=1e-6)
    start = np.array(seen(planner, HOME[:6]).xyz)
    along = (np.array(goal.xyz) - start) / np.linalg.norm(np.array(goal.xyz) - start)
    off = (tips - start) - np.outer((tips - start) @ along, along)
    assert np.linalg.norm(off, axis=1).max() < 2e-3


def test_joints_keep_their_limits_at_the_time_step(planner):
    planner.joint_vel_limits, planner.joint_acc_limits = np.full(6, 0.4), np.full(6, 0.6)
    answer = planner.plan_qpos_to_pose(asked(moved(planner, -0.1, 0.1, -0.1)), HOME, time_step=0.02, rrt_range=0.1)
    assert answer["status"] == "Success"
    rows = np.vstack([HOME[:6], answer["position"]])
    # The last step may be a short one.
    assert np.abs(np.diff(rows, axis=0)).max() <= 0.4 * 0.02 + 1e-9
    assert np.abs(answer["velocity"]).max() <= 0.4 + 1e-9
    assert len(answer["time"]) == len(answer["position"]) == len(answer["velocity"])
    assert answer["time"][-1] == pytest.approx(answer["duration"])


def test_points_in_the_worlds_frame_are_in_the_way_only_where_they_are_used(planner):
    goal = asked(moved(planner, -0.25, 0.0, 0.0))
    ways = [planner.plan_screw(goal, HOME)["position"]]
    elbow = base() @ planner.robot.fk(ways[0][len(ways[0]) // 2], "link2")
    planner.update_point_cloud([elbow.xyz])
    ways.append(planner.plan_screw(goal, HOME, use_point_cloud=False)["position"])
    np.testing.assert_array_equal(*ways)
    assert planner.plan_screw(goal, HOME, use_point_cloud=True)["status"] != "Success"
    # The points stay where they are, and the arm with its goal moves away from them.
    planner.set_base_pose([BASE[0] + 3.0, *BASE[1:]])
    beside = [goal[0] + 3.0, *goal[1:]]
    assert planner.plan_screw(beside, HOME, use_point_cloud=True)["status"] == "Success"


def test_joints_a_little_beyond_their_limits_are_taken_back(planner):
    beyond = HOME.copy()
    beyond[6] = 0.0403
    beyond[0] = 2.5001
    here = base() @ planner.robot.fk(np.minimum(beyond[:6], 2.5), "tip")
    assert planner.plan_screw(asked(here), beyond)["status"] == "Success"


def test_what_is_not_understood_is_refused(planner, tmp_path):
    goal = asked(moved(planner, 0.0, 0.0, 0.05))
    with pytest.raises(UnknownName, match="mask"):
        planner.plan_screw(goal, HOME, mask=[1])
    with pytest.raises(InvalidValue, match="use_attach"):
        planner.plan_screw(goal, HOME, use_attach=True)
    with pytest.raises(InvalidValue, match="qpos must be 7"):
        planner.plan_screw(goal, HOME[:6])
    with pytest.raises(InvalidValue, match="the goal must be 7"):
        planner.plan_screw(goal[:3], HOME)
    with pytest.raises(UnknownName, match="hand"):
        Planner(arm_file(tmp_path), "", [], planner.robot.group, "hand")
