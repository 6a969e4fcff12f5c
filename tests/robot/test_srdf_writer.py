"""An SRDF that is written says of a robot what is known, and is read again to the same robot."""

from evenroad.robot import load_model
from evenroad.robot.srdf import chains, srdf_text
from tests.robot.urdf_texts import LIMIT, joint, link, urdf, write

TWO_ARMS = urdf(
    *map(link, ("base", "left1", "left2", "left3", "finger", "thumb", "right1", "right2", "camera")),
    joint("l1", "base", "left1", xyz="0 0.5 0"),
    joint("l2", "left1", "left2"),
    joint("l3", "left2", "left3", "fixed", ""),
    joint("grip", "left3", "finger", "prismatic", axis="1 0 0"),
    joint("follower", "left3", "thumb", "prismatic", LIMIT + "<mimic joint='grip'/>", axis="-1 0 0"),
    joint("r1", "base", "right1", xyz="0 -0.5 0"),
    joint("r2", "right1", "right2", inside="<limit lower='0.2' upper='1' velocity='1' effort='1'/>"),
    joint("look", "base", "camera", "fixed", "", xyz="0 0 0.02"),
)


def test_groups_are_the_chains_without_a_branch_and_grippers_apart(tmp_path):
    robot = load_model(write(tmp_path, TWO_ARMS)).robot
    found = {name: [joint.name for joint in joints] for name, joints in chains(robot).items()}
    assert found == {"left2": ["l1", "l2"], "finger": ["grip"], "right2": ["r1", "r2"]}


def test_the_file_read_again_gives_the_same_pairs_groups_and_states(tmp_path):
    path = write(tmp_path, TWO_ARMS)
    model = load_model(path)
    srdf = write(tmp_path, srdf_text(model), "arm.srdf")
    again = load_model(path, srdf=srdf, group="planned")
    assert again.pairs_from == "SRDF"
    assert again.robot.pairs == model.robot.pairs
    assert again.robot.group == model.robot.group
    assert {frozenset(pair[:2]) for pair in again.dropped} == {frozenset(pair[:2]) for pair in model.dropped}
    both = load_model(path, srdf=srdf, group="right2,left2").robot
    assert both.group == ("r1", "r2", "l1", "l2")
    assert both.states["home"] == {"r1": 0.0, "r2": 0.2, "l1": 0.0, "l2": 0.0}


def test_every_pair_that_is_not_tested_has_its_reason(tmp_path):
    text = srdf_text(load_model(write(tmp_path, TWO_ARMS)))
    assert '<disable_collisions link1="base" link2="left1" reason="Adjacent" />' in text
    assert '<disable_collisions link1="base" link2="camera" reason="Never moves" />' in text


def test_a_robot_of_one_chain_has_one_group(tmp_path):
    text = urdf(*map(link, "xyz"), joint("a", "x", "y"), joint("b", "y", "z"))
    written = srdf_text(load_model(write(tmp_path, text)))
    assert written.count("<group name") == 1
    assert '<chain base_link="x" tip_link="z" />' in written


def test_states_that_are_known_are_kept():
    text = srdf_text(load_model("ur5"))
    assert all(f'name="{name}"' in text for name in load_model("ur5").robot.states)
