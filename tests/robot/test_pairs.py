import numpy as np
import pytest

from evenroad.geometry.distance import segment_distance
from evenroad.robot import load_model, load_robot
from tests.robot.urdf_texts import LIMIT, joint, link, urdf, write


def test_points_and_parallel_segments_are_segments_too():
    point, along, beside = (np.array([row], dtype=float) for row in (
        [[0, 0, 2], [0, 0, 2]], [[0, 0, 0], [0, 0, 1]], [[3, 0, -5], [3, 0, 5]],
    ))  # fmt: skip
    assert segment_distance(point, along) == 1
    assert segment_distance(along, point) == 1
    assert segment_distance(along, beside) == 3
    assert segment_distance(point, point) == 0


def test_the_ur5s_pairs_are_those_of_its_srdf():
    model = load_model("ur5")
    links = (
        "base_link",
        "shoulder_link",
        "upper_arm_link",
        "forearm_link",
        "wrist_1_link",
        "wrist_2_link",
        "wrist_3_link",
    )
    by_number = ("03", "04", "05", "06", "13", "14", "15", "16", "24", "25", "26", "35", "36")
    assert model.robot.pairs == tuple((links[int(i)], links[int(j)]) for i, j in by_number)
    assert model.pairs_from == "SRDF"
    assert len(model.dropped) == 8


def _ball(radius, xyz="0 0 0"):
    return f"<collision><origin xyz='{xyz}'/><geometry><sphere radius='{radius}'/></geometry></collision>"


def test_neighbours_and_pairs_that_always_touch_are_dropped_and_said(tmp_path):
    # d is so near b that they touch whatever c does; a and d touch in some configurations only.
    text = urdf(
        link("a", _ball(0.05)),
        link("b", _ball(0.3, "0 0 0.1")),
        link("c", _ball(0.05)),
        link("d", _ball(0.05)),
        joint("j1", "a", "b", xyz="0 0 0.5"),
        joint("j2", "b", "c", xyz="0 0 0.1"),
        joint("j3", "c", "d", xyz="0 0 0.1"),
    )
    model = load_model(write(tmp_path, text))
    assert model.pairs_from == "computed"
    assert model.robot.pairs == (("a", "c"), ("a", "d"))
    assert set(model.dropped) == {
        ("a", "b", "neighbours"),
        ("b", "c", "neighbours"),
        ("c", "d", "neighbours"),
        ("b", "d", "touch in every sample"),
    }


def test_links_without_bodies_are_looked_through_for_neighbours(tmp_path):
    text = urdf(
        link("a", _ball(0.05)), link("flange", ""), link("b", _ball(0.05)), link("c", _ball(0.05)),
        joint("j1", "a", "flange", "fixed", "", "0 0 0.2"), joint("j2", "flange", "b"), joint("j3", "b", "c"),
    )  # fmt: skip
    model = load_model(write(tmp_path, text))
    assert model.robot.pairs == (("a", "c"),)
    assert ("a", "b", "neighbours") in model.dropped


def test_bodies_that_several_joints_move_on_each_other_are_tested_though_no_body_is_between(tmp_path):
    # Two links of 0.3 m without bodies: folded, the tool comes back to the base.
    text = urdf(
        link("base", _ball(0.05)), link("upper", ""), link("lower", ""), link("tool", _ball(0.05)),
        joint("j1", "base", "upper", xyz="0 0 0.1"), joint("j2", "upper", "lower", xyz="0 0 0.3"),
        joint("j3", "lower", "tool", xyz="0 0 0.3"),
    )  # fmt: skip
    assert load_model(write(tmp_path, text)).robot.pairs == (("base", "tool"),)


def test_bodies_about_one_point_touch_in_every_sample_however_many_joints_are_there(tmp_path):
    text = urdf(
        link("arm", _ball(0.05)), link("cross", ""), link("hand", _ball(0.05)), link("finger", _ball(0.05)),
        joint("roll", "arm", "cross", xyz="0 0 0"), joint("bend", "cross", "hand", xyz="0 0 0"),
        joint("grip", "hand", "finger", xyz="0 0 0.5"),
    )  # fmt: skip
    model = load_model(write(tmp_path, text))
    assert model.robot.pairs == (("arm", "finger"),)
    assert ("arm", "hand", "touch in every sample") in model.dropped


def test_two_branches_of_one_trunk_are_tested_against_each_other(tmp_path):
    text = urdf(
        link("trunk", ""), link("left", _ball(0.05)), link("right", _ball(0.05)),
        joint("l", "trunk", "left", xyz="0 0.2 0"), joint("r", "trunk", "right", xyz="0 -0.2 0"),
    )  # fmt: skip
    assert load_model(write(tmp_path, text)).robot.pairs == (("left", "right"),)


def test_what_is_fixed_to_each_other_is_not_tested_even_if_the_srdf_does_not_disable_it(tmp_path):
    text = urdf(
        link("a", _ball(0.05)), link("b", _ball(0.3)), link("c", _ball(0.05)),
        joint("f", "a", "b", "fixed", "", "0 0 0.1"), joint("j", "b", "c", "continuous", "", "0 0 1"),
    )  # fmt: skip
    srdf = "<robot name='arm'><disable_collisions link1='b' link2='c'/></robot>"
    model = load_model(write(tmp_path, text), srdf=write(tmp_path, srdf, "arm.srdf"))
    assert model.robot.pairs == (("a", "c"),)
    assert ("a", "b", "fixed to each other") in model.dropped


def test_an_srdf_that_disables_nothing_leaves_the_pairs_to_be_computed(tmp_path):
    text = urdf(
        *(link(name, _ball(0.05)) for name in "abc"), joint("j", "a", "b"), joint("k", "b", "c", inside=LIMIT)
    )
    srdf = "<robot name='arm'><group name='g'><joint name='k'/></group></robot>"
    model = load_model(write(tmp_path, text), srdf=write(tmp_path, srdf, "arm.srdf"))
    assert model.pairs_from == "computed"
    assert model.robot.pairs == (("a", "c"),)
    assert model.robot.group == ("k",)


SHORT_NECK = urdf(
    link("base", _ball(0.05)), link("neck", _ball(0.05)), link("head", _ball(0.05)),
    joint("pan", "base", "neck", xyz="0 0 0.08"), joint("tilt", "neck", "head", xyz="0 0 0.3"),
)  # fmt: skip


def test_a_pair_that_an_srdf_leaves_and_that_always_touches_is_named_when_the_robot_is_loaded(tmp_path):
    path = write(tmp_path, SHORT_NECK)
    disabled = "<disable_collisions link1='neck' link2='head' reason='Adjacent'/>"
    srdf = write(tmp_path, f"<robot name='arm'>{disabled}</robot>", "arm.srdf")
    model = load_model(path, srdf=srdf)
    assert model.always_touching == (("base", "neck"),)
    assert load_model(path, srdf=srdf) == model, "as it comes out of the cache"
    with pytest.warns(UserWarning, match="every sampled configuration: base and neck; disable these pairs"):
        load_robot(path, srdf=srdf)
    assert load_model(path).always_touching == ()
