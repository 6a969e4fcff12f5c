"""Links that may touch: of arms in a plane, the law of cosines says how near a ball comes to another one."""

import math
import time

import numpy as np
import pytest

import evenroad as er
from evenroad.certificates.link_pairs import Links, decide_pair, untested_pairs
from evenroad.loading.load import read_robot
from evenroad.loading.robot_file import RobotFile

LIMIT = 3.1


def arm(folder, radius, lengths=(1.0, 0.5), limit=LIMIT, kind="revolute"):
    """Return the links of an arm: a ball of 0.2 m at the root, joints about z, and a ball at the end."""
    ball = "<collision><geometry><sphere radius='{}'/></geometry></collision>"
    text = "<robot name='arm'><link name='base'>" + ball.format(0.2) + "</link>"
    for i, _ in enumerate(lengths):
        parent = f"l{i - 1}" if i else "base"
        at = lengths[i - 1] if i else 0.0
        text += f"<joint name='j{i}' type='{kind}'><parent link='{parent}'/><child link='l{i}'/>"
        text += f"<origin xyz='{at} 0 0'/><axis xyz='0 0 1'/><limit lower='{-limit}' upper='{limit}'/></joint>"
        last = i == len(lengths) - 1
        shape = ball.format(radius).replace("<geometry", f"<origin xyz='{lengths[i]} 0 0'/><geometry") if last else ""
        text += f"<link name='l{i}'>{shape}</link>"
    (folder / "arm.urdf").write_text(text + "</robot>")
    return Links(read_robot(RobotFile(folder / "arm.urdf")))


@pytest.mark.parametrize(
    ("radius", "limit", "status"), [(0.29, LIMIT, "never"), (0.31, LIMIT, "touches"), (0.45, 2.5, "never")]
)
def test_a_folding_arm_touches_its_base_where_it_is_short_enough(radius, limit, status, tmp_path):
    pair = decide_pair(arm(tmp_path, radius, limit=limit), ("base", "l1"), "disabled", 20.0)
    nearest = math.sqrt(1.25 + math.cos(limit)) - 0.2 - radius
    assert pair.status == status == ("never" if nearest > 0.0 else "touches")
    assert pair.joints == ("j0", "j1")
    assert not pair.adjacent
    if status == "touches":
        assert 1.25 + math.cos(pair.configuration["j1"]) <= (0.2 + radius) ** 2


def test_three_joints_are_decided_in_cells(tmp_path):
    # The shortest distance of the end from the base is 1 - 0.3 - 0.3.
    lengths = (1.0, 0.3, 0.3)
    assert decide_pair(arm(tmp_path, 0.1, lengths), ("base", "l2"), "disabled", 60.0).status == "never"
    touching = decide_pair(arm(tmp_path, 0.25, lengths), ("base", "l2"), "disabled", 60.0)
    assert touching.status == "touches"
    at = er.load_robot(tmp_path / "arm.urdf").fk(touching.configuration, "l2") @ er.Pose((0.3, 0.0, 0.0))
    assert np.linalg.norm(at.xyz) <= 0.45 + 1e-9


def test_without_time_a_pair_is_undecided(tmp_path):
    links = arm(tmp_path, 0.1, (1.0, 0.3, 0.3))
    (pair,) = untested_pairs(links, [("base", "l2", "disabled"), ("base", "l0", "no shape")], 1e-9)
    assert pair.status == "undecided"


def test_links_with_one_joint_between_them_are_adjacent(tmp_path):
    pair = decide_pair(arm(tmp_path, 0.1, (0.5,)), ("base", "l0"), "neighbours", 5.0)
    assert (pair.status, pair.adjacent) == ("never", True)
    assert pair.steps > 1
    links = arm(tmp_path, 0.31, (0.5,), kind="continuous")
    pair = decide_pair(links, ("base", "l0"), "neighbours", 5.0)
    assert (pair.status, pair.nearest) == ("touches", 0.0)
    reported = []
    pairs = [("base", "l0", "neighbours"), ("base", "nothing", "no shapes")]
    assert untested_pairs(links, pairs, 5.0, lambda *step: reported.append(step)) == [pair]
    assert reported == [(1, 1)]


def test_seven_joints_between_two_links_are_not_proved_and_keep_to_the_time(tmp_path):
    began = time.monotonic()
    pair = decide_pair(arm(tmp_path, 0.1, (1.0, *[0.05] * 6)), ("base", "l6"), "disabled", 30.0)
    assert (pair.status, len(pair.joints), pair.proof) == ("undecided", 7, None)
    assert time.monotonic() - began < 20.0


@pytest.mark.parametrize(("radius", "status"), [(0.29, "never"), (0.31, "touches")])
def test_links_of_a_robot_without_joints_are_fixed_to_each_other(radius, status, tmp_path):
    pair = decide_pair(arm(tmp_path, radius, (0.5,), kind="fixed"), ("base", "l0"), "disabled", 5.0)
    # The ball is 0.5 m from that of the root, whose radius is 0.2 m.
    assert (pair.status, pair.joints, pair.proof) == (status, (), None)


def test_fixed_links_whose_proof_is_too_long_are_undecided(tmp_path, monkeypatch):
    arm(tmp_path, 0.2, (0.5,), kind="fixed")
    # Two balls each, crosswise: no plane is between all of them.
    text = (tmp_path / "arm.urdf").read_text()
    cross = "<collision><origin xyz='{} {} 0'/><geometry><sphere radius='0.1'/></geometry></collision>"
    for link, balls in (("base", ((1, 0), (-1, 0))), ("l0", ((-0.5, 1), (-0.5, -1)))):
        start = text.index(f"<link name='{link}'>") + len(f"<link name='{link}'>")
        end = text.index("</link>", start)
        text = text[:start] + "".join(cross.format(*ball) for ball in balls) + text[end:]
    (tmp_path / "arm.urdf").write_text(text)
    links = Links(read_robot(RobotFile(tmp_path / "arm.urdf")))
    assert decide_pair(links, ("base", "l0"), "disabled", 5.0).status == "never"
    monkeypatch.setattr("evenroad.certificates.link_pairs._MOST", 1)
    assert decide_pair(links, ("base", "l0"), "disabled", 5.0).status == "undecided"
