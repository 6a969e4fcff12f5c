"""An SRDF that is read, and one that is written, which says what is known and is read again to the same robot."""

import re

import numpy as np
import pytest

from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.loading.groups import chains, choose_group, group_notes
from evenroad.loading.srdf import read_srdf
from evenroad.loading.urdf import read_urdf
from evenroad.loading.written_srdf import srdf_text
from evenroad.planning import plan
from evenroad.robot import ArmWorld, Scene, configuration, held_values, load_model, load_robot
from tests.refused import refused
from tests.robots.urdf_texts import LIMIT, SPHERE, joint, link, urdf, write

ARM = urdf(
    *(link(name) for name in ("base", "upper", "lower", "hand", "left", "right")),
    joint("shoulder", "base", "upper"),
    joint("elbow", "upper", "lower"),
    joint("flange", "lower", "hand", "fixed", ""),
    joint("grip", "hand", "left", "prismatic"),
    joint("follower", "hand", "right", "prismatic", LIMIT + "<mimic joint='grip'/>"),
)


def srdf_of(folder, inside, name="arm.srdf"):
    """Write an SRDF and return its file."""
    return write(folder, f"<robot name='arm'>{inside}</robot>", name)


@pytest.fixture
def read(tmp_path):
    """Read an SRDF for `ARM`; return both."""
    arm = read_urdf(write(tmp_path, ARM))
    return lambda inside: (arm, read_srdf(srdf_of(tmp_path, inside), arm))


@pytest.mark.parametrize(("inside", "joints"), [
    ("<chain base_link='base' tip_link='hand'/>", ("shoulder", "elbow")),
    ("<chain base_link='upper' tip_link='hand'/>", ("elbow",)),
    ("<joint name='elbow'/><joint name='shoulder'/>", ("shoulder", "elbow")),
    ("<joint name='flange'/><joint name='grip'/>", ("grip",)),
    ("<joint name='grip'/><joint name='follower'/>", ("grip",)),
    ("<link name='lower'/><link name='base'/>", ("elbow",)),
    ("<group name='fingers'/><joint name='elbow'/>", ("elbow", "grip")),
])  # fmt: skip
def test_a_group_is_what_moves_of_its_parts_in_the_order_of_the_urdf(read, inside, joints):
    _, srdf = read(f"<group name='g'>{inside}</group><group name='fingers'><joint name='grip'/></group>")
    assert srdf.groups["g"] == joints


def test_states_and_disabled_pairs_are_read_and_virtual_joints_skipped_wherever_they_are(read):
    arm, srdf = read(
        "<virtual_joint name='world_joint' type='planar' parent_frame='odom' child_link='base'/>"
        "<passive_joint name='world_joint'/>"
        "<group name='base'><joint name='world_joint'/></group>"
        "<group name='all'><group name='base'/><joint name='elbow'/></group>"
        "<group_state name='s' group='all'><joint name='world_joint' value='0 0 0'/>"
        "<joint name='elbow' value='0.5'/></group_state>"
        "<disable_collisions link1='base' link2='upper' reason='Adjacent'/>"
    )
    assert srdf.disabled == {frozenset(("base", "upper"))}
    assert srdf.groups == {"base": (), "all": ("elbow",)}
    assert srdf.states == {("all", "s"): {"elbow": 0.5}}
    assert choose_group(arm, srdf, "all") == ("elbow",)


def test_passive_joints_are_in_no_group(read):
    chain = "<chain base_link='base' tip_link='hand'/>"
    arm, srdf = read(f"<passive_joint name='shoulder'/><group name='g'>{chain}</group>")
    assert srdf.groups == {"g": ("elbow",)}
    assert choose_group(arm, read("<passive_joint name='shoulder'/>")[1], None) == ("elbow", "grip")


def test_a_joint_locked_by_its_limits_is_in_no_group(tmp_path):
    locked = "<limit lower='0.25' upper='0.25' velocity='1' effort='1'/>"
    text = urdf(*map(link, "xyz"), joint("a", "x", "y", inside=locked), joint("b", "y", "z"))
    srdf = "<group name='g'><chain base_link='x' tip_link='z'/></group>"
    robot = load_robot(write(tmp_path, text), srdf=srdf_of(tmp_path, srdf))
    assert robot.group == ("b",)
    assert held_values(robot) == {"a": 0.25}
    assert ArmWorld(robot, Scene((), name="empty")).space.dim == 1


BROKEN = {
    "a group that is not there": ("<group name='g'><group name='h'/></group>", UnknownName, "'h'; known: g"),
    "groups in a circle": ("<group name='g'><group name='h'/></group><group name='h'><group name='g'/></group>",
        BrokenFile, "contain each other: g -> h -> g"),
    "a chain that is none": ("<group name='g'><chain base_link='left' tip_link='right'/></group>", BrokenFile,
        "'right' does not hang on 'left'"),
    "a state of no group": ("<group_state name='s' group='g'/>", UnknownName, "unknown group in .*: 'g'"),
    "a value that is no number": (
        "<group name='g'/><group_state name='s' group='g'><joint name='elbow' value='much'/></group_state>",
        InvalidValue,
        "joint 'elbow' of a state in .* must be a finite number, got 'much'",
    ),
    "a pair of one": ("<disable_collisions link1='base'/>", BrokenFile, "<disable_collisions> in .* lacks 'link2'"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_wrong_in_an_srdf_is_named(case, read):
    inside, kind, says = BROKEN[case]
    with pytest.raises(EvenroadError, match=says) as caught:
        read(inside)
    assert isinstance(caught.value, kind)


LACKING = {
    "<group_state name='home'><joint name='elbow' value='0'/></group_state>": "states without a group.*: home",
    "<passive_joint name='knee'/>": "joints that the robot lacks, which are skipped: knee",
    "<group name='h'><joint name='knee'/><joint name='grip'/></group>": "joints .*: knee",
    "<group name='h'><link name='leg'/><joint name='grip'/></group>": "links .*: leg",
    "<group name='h'><chain base_link='base' tip_link='toe'/><joint name='grip'/></group>": "links .*: toe",
    "<group_state name='s' group='g'><joint name='knee' value='1'/></group_state>": "joints .*: knee",
    "<disable_collisions link1='moon' link2='sun'/>": "links .*: moon, sun",
}


@pytest.mark.parametrize("inside", LACKING)
def test_what_the_robot_lacks_is_noted_and_skipped(inside, read):
    _, srdf = read("<group name='g'><joint name='elbow'/></group>" + inside)
    (note,) = srdf.notes
    assert re.fullmatch("the SRDF names " + LACKING[inside], note) or re.search(LACKING[inside], note)
    assert srdf.groups["g"] == ("elbow",)
    assert srdf.groups.get("h", ("grip",)) == ("grip",)
    assert not srdf.disabled
    assert not srdf.passive
    assert all(values == {} for values in srdf.states.values())


def test_a_note_on_what_the_robot_lacks_is_one_short_line(tmp_path):
    pairs = "".join(f"<disable_collisions link1='base' link2='{'moon' * 100}{i}'/>" for i in range(500))
    model = load_model(write(tmp_path, ARM), srdf=srdf_of(tmp_path, pairs))
    (note,) = (note for note in model.notes if "SRDF" in note)
    assert note.endswith("and 492 more")
    assert len(note) < 800
    assert "\n" not in note


def test_an_srdf_that_is_no_xml_or_missing_is_named(tmp_path):
    arm = read_urdf(write(tmp_path, ARM))
    refused(BrokenFile, r"arm\.urdf\.txt is text, not XML", read_srdf, write(tmp_path, "hello", "arm.urdf.txt"), arm)
    refused(BrokenFile, r"arm\.urdf is a URDF, not an SRDF", read_srdf, write(tmp_path, ARM, "arm.urdf"), arm)
    refused(BrokenFile, "cannot read the SRDF", read_srdf, tmp_path / "none.srdf", arm)


def test_without_a_wish_the_group_is_the_srdfs_only_one_or_all_that_moves_by_itself(read):
    arm, srdf = read("<group name='g'><joint name='elbow'/></group>")
    assert choose_group(arm, srdf, None) == ("elbow",)
    assert choose_group(arm, None, None) == ("shoulder", "elbow", "grip")
    # One of which the robot has nothing is none.
    _, srdf = read("<group name='whole'><joint name='other/elbow'/></group>")
    assert choose_group(arm, srdf, None) == ("shoulder", "elbow", "grip")


@pytest.mark.parametrize(
    ("wanted", "joints"), [("grip, shoulder", ("grip", "shoulder")), (["grip"], ("grip",)), ("g", ("elbow",))]
)
def test_a_list_of_joints_is_a_group_in_the_order_of_the_list(read, wanted, joints):
    assert choose_group(*read("<group name='g'><joint name='elbow'/></group>"), wanted) == joints


TWO_GROUPS = """
<group name='arm'><joint name='shoulder'/><joint name='elbow'/></group>
<group name='forearm'><joint name='elbow'/></group><group name='fingers'><joint name='grip'/></group>
<group_state name='home' group='arm'><joint name='shoulder' value='0.1'/><joint name='elbow' value='0.2'/></group_state>
<group_state name='home' group='fingers'><joint name='grip' value='0.3'/></group_state>
<group_state name='open' group='fingers'><joint name='grip' value='0.4'/></group_state>
"""


@pytest.mark.parametrize(("wanted", "joints"), [
    ("fingers,arm", ("grip", "shoulder", "elbow")), (["arm", "fingers"], ("shoulder", "elbow", "grip")),
    ("forearm,arm", ("elbow", "shoulder")), ("grip,arm", ("grip", "shoulder", "elbow")),
])  # fmt: skip
def test_several_groups_are_one_in_the_order_of_the_wish(read, wanted, joints):
    arm, srdf = read(TWO_GROUPS)
    assert choose_group(arm, srdf, wanted) == joints


def test_two_groups_have_their_states_in_one_and_plan_together_in_the_order_of_the_wish(tmp_path):
    text = ARM.replace("radius='0.05'", "radius='0.02'")
    path, srdf = write(tmp_path, text), srdf_of(tmp_path, TWO_GROUPS)
    robot = load_robot(path, srdf=srdf, group="fingers,arm")
    assert robot.group == ("grip", "shoulder", "elbow")
    # States of one name are one.
    assert robot.states == {"home": {"grip": 0.3, "shoulder": 0.1, "elbow": 0.2}}
    turned = plan(Scene(name="s"), "home", "0.1,0.3,0.5", robot=path, srdf=srdf, group=("fingers", "arm"))
    assert turned.solved, turned.message
    np.testing.assert_allclose(turned.path[0], [0.3, 0.1, 0.2])
    np.testing.assert_allclose(turned.path[-1], [0.1, 0.3, 0.5])


@pytest.mark.parametrize(("wanted", "kind", "says"), [
    ("knee", UnknownName, "unknown group 'knee'; known: g, h"),
    ("elbow,knee", UnknownName, "unknown joint of the group 'knee'; known: elbow, grip, shoulder"),
    ("elbow,follower", InvalidValue, "'follower' cannot be planned for: it follows 'grip'"),
    ("elbow,flange", InvalidValue, "'flange' cannot be planned for: it is fixed"),
    ("elbow,elbow", InvalidValue, "named twice"), ("h", InvalidValue, "group 'h' has no joint"),
    ([], InvalidValue, "no joint"),
])  # fmt: skip
def test_a_group_that_cannot_be_planned_for_is_refused(read, wanted, kind, says):
    arm, srdf = read("<group name='g'><joint name='elbow'/></group><group name='h'/>")
    refused(kind, says, choose_group, arm, srdf, wanted)


def groups_of(groups):
    """The elements of groups, of the names of their joints."""
    return "".join(
        f"<group name='{name}'>{''.join(f'<joint name={each!r}/>' for each in members.split())}</group>"
        for name, members in groups.items()
    )


@pytest.mark.parametrize(("groups", "joints"), [
    # The arm, its hand, and both: the chain that is no gripper's.
    ({"both": "shoulder elbow grip", "arm": "shoulder elbow", "hand": "grip"}, ("shoulder", "elbow")),
    ({"forearm": "elbow", "arm": "shoulder elbow", "manipulator": "shoulder elbow"}, ("shoulder", "elbow")),
    ({"both": "shoulder grip", "hand": "grip"}, ("grip",)),
])  # fmt: skip
def test_of_several_groups_the_longest_chain_is_the_arm(read, groups, joints):
    arm, srdf = read(groups_of(groups))
    assert choose_group(arm, srdf, None) == joints
    (note,) = group_notes(arm, srdf, None)
    assert all(name in note for name in (*groups, "--group"))
    assert group_notes(arm, srdf, "grip") == ()


def test_a_finger_of_as_many_joints_as_its_arm_is_no_arm(tmp_path):
    names = ("base", "upper", "hand", "index1", "index2", "thumb1", "thumb2")
    carriers = ("base", "upper", "hand", "index1", "hand", "thumb1")
    arm = urdf(*map(link, names), *(joint(f"to_{b}", a, b) for a, b in zip(carriers, names[1:], strict=True)))
    path = write(tmp_path, arm)
    written = write(tmp_path, srdf_text(load_model(path)), "arm.srdf")
    assert load_model(path, srdf=written).robot.group == ("to_upper", "to_hand")


@pytest.mark.parametrize("groups", [("shoulder", "elbow"), ("shoulder elbow grip", "elbow grip")])
def test_where_no_group_is_the_arm_the_option_is_named(read, groups):
    arm, srdf = read(groups_of({f"g{i}": members for i, members in enumerate(groups)}))
    refused(InvalidValue, r"several groups.*--group.*: g0, g1", choose_group, arm, srdf, None)


def fingers(lower, upper):
    """An arm of two joints with two fingers that meet where their joint is at 0."""
    limit = f"<limit lower='{lower}' upper='{upper}' velocity='1' effort='1'/>"
    thumb = limit + "<mimic joint='grip' multiplier='-1'/>"
    return urdf(
        *(link(name, SPHERE.replace("0.05", "0.02")) for name in ("base", "upper", "hand", "left", "right")),
        joint("shoulder", "base", "upper", xyz="0 0 0.3"),
        joint("elbow", "upper", "hand", xyz="0 0 0.3"),
        joint("grip", "hand", "left", "prismatic", limit, xyz="0 0.02 0.1", axis="0 1 0"),
        joint("follower", "hand", "right", "prismatic", thumb, xyz="0 -0.0199 0.1", axis="0 1 0"),
    )


@pytest.mark.parametrize(("limits", "grip"), [((0.0, 0.04), 0.02), ((-0.01, 0.0), 0.0), ((-0.01, 0.04), 0.005)])
def test_fingers_that_are_held_stand_where_they_do_not_touch(tmp_path, limits, grip):
    path, pair = write(tmp_path, fingers(*limits)), "<disable_collisions link1='base' link2='upper'/>"
    robot = load_model(path, srdf=srdf_of(tmp_path, pair), group="shoulder,elbow").robot
    # Where they touch wherever they stand, they stay; the mimic's limits are the joint's.
    assert held_values(robot) == {"grip": grip}


@pytest.mark.parametrize(
    ("states", "grip"), [((0.03,), 0.03), ((0.0, 0.03), 0.03), ((0.0,), 0.02), ((0.01, 0.03), 0.01)]
)
def test_fingers_stand_where_the_first_state_has_them_in_which_they_do_not_touch(tmp_path, states, grip):
    said = "<group name='hand'><joint name='grip'/></group><disable_collisions link1='base' link2='upper'/>"
    for i, value in enumerate(states):
        said += f"<group_state name='s{i}' group='hand'><joint name='grip' value='{value}'/></group_state>"
    path = write(tmp_path, fingers(0.0, 0.04))
    robot = load_model(path, srdf=srdf_of(tmp_path, said), group="shoulder,elbow").robot
    assert held_values(robot) == {"grip": grip}


def test_the_srdf_of_an_arm_with_a_hand_is_read_again_and_planned_with(tmp_path):
    path = write(tmp_path, fingers(0.0, 0.04))
    srdf = write(tmp_path, srdf_text(load_model(path)), "arm.srdf")
    model = load_model(path, srdf=srdf)
    assert model.robot.group == ("shoulder", "elbow")
    assert not model.always_touching
    assert any("planned for is the group 'hand'" in note for note in model.notes)
    assert plan("empty", "home", "ready", robot=path, srdf=srdf).solved
    everything = load_model(path, srdf=srdf, group="planned").robot
    home, ready = (configuration(everything, name) for name in ("home", "ready"))
    np.testing.assert_array_equal(home, [0.0, 0.0, 0.02])
    assert ready[2] == 0.02
    assert np.abs(ready[:2]).max() > 0.1
    assert ArmWorld(everything, Scene(name="nothing")).valid([home, ready]).all()


def test_pairs_that_always_touch_are_disabled_in_what_is_written(tmp_path):
    # The two lie in each other, and this SRDF does not say so.
    places = {"awx": "0 0 0.5", "bxy": "0 0 0.02", "cyz": "0 0 0.02"}
    joints = [joint(*names, xyz=xyz) for names, xyz in places.items()]
    path = write(tmp_path, urdf(*map(link, "wxyz"), *joints))
    adjacent = "".join(f"<disable_collisions link1='{a}' link2='{b}'/>" for a, b in ("wx", "xy", "yz"))
    first = load_model(path, srdf=srdf_of(tmp_path, adjacent, "first.srdf"))
    assert first.always_touching == (("x", "z"),)
    again = load_model(path, srdf=write(tmp_path, srdf_text(first), "again.srdf"))
    assert not again.always_touching
    assert ("x", "z") not in again.robot.pairs
    assert ("w", "z") in again.robot.pairs


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


def test_what_is_written_has_its_reasons_and_gives_the_same_pairs_groups_and_states(tmp_path):
    path = write(tmp_path, TWO_ARMS)
    model = load_model(path)
    # Chains without a branch, and grippers apart.
    found = {name: [joint.name for joint in joints] for name, joints in chains(model.robot.joints).items()}
    assert found == {"left2": ["l1", "l2"], "finger": ["grip"], "right2": ["r1", "r2"]}
    srdf = write(tmp_path, text := srdf_text(model), "arm.srdf")
    assert '<disable_collisions link1="base" link2="left1" reason="Adjacent" />' in text
    assert '<disable_collisions link1="base" link2="camera" reason="Never moves" />' in text
    again = load_model(path, srdf=srdf, group="planned")
    assert again.pairs_from == "SRDF"
    assert again.robot.pairs == model.robot.pairs
    assert again.robot.group == model.robot.group
    assert {frozenset(pair[:2]) for pair in again.dropped} == {frozenset(pair[:2]) for pair in model.dropped}
    both = load_model(path, srdf=srdf, group="right2,left2").robot
    assert both.group == ("r1", "r2", "l1", "l2")
    assert both.states["home"] == {"r1": 0.0, "r2": 0.2, "l1": 0.0, "l2": 0.0}


def test_a_robot_of_one_chain_has_one_group_and_states_that_are_known_are_kept(tmp_path):
    text = urdf(*map(link, "xyz"), joint("a", "x", "y"), joint("b", "y", "z"))
    written = srdf_text(load_model(write(tmp_path, text)))
    assert written.count("<group name") == 1
    assert '<chain base_link="x" tip_link="z" />' in written
    text = srdf_text(load_model("ur5"))
    assert all(f'name="{name}"' in text for name in load_model("ur5").robot.states)
