import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from evenroad.geometry.distance import segment_distance
from evenroad.robot import load_model
from tests.robot.urdf_texts import LIMIT, joint, link, urdf, write

ends = arrays(np.float64, (2, 3), elements=st.floats(-1, 1, width=16))


def _by_grid(first, second):
    """The distance of two segments by many points on both: a slow upper bound, close to it."""
    t = np.linspace(0, 1, 101)[:, np.newaxis]
    on_first, on_second = (pair[0] + t * (pair[1] - pair[0]) for pair in (first, second))
    return np.linalg.norm(on_first[:, np.newaxis] - on_second, axis=2).min()


@settings(max_examples=100, deadline=None)
@given(first=ends, second=ends)
def test_the_distance_of_segments_is_that_of_their_closest_points(first, second):
    found = segment_distance(first[np.newaxis], second[np.newaxis])[0]
    by_grid = _by_grid(first, second)
    assert found <= by_grid + 1e-9
    step = max(np.linalg.norm(first[1] - first[0]), np.linalg.norm(second[1] - second[0])) / 100
    assert found >= by_grid - step - 1e-9


@settings(max_examples=50, deadline=None)
@given(first=ends, second=ends)
def test_the_distance_of_segments_does_not_depend_on_names(first, second):
    found = [
        segment_distance(a[np.newaxis], b[np.newaxis])[0]
        for a, b in ((first, second), (second, first), (first[::-1], second), (first, second[::-1]))
    ]
    assert found == pytest.approx([found[0]] * 4, abs=1e-7)


@given(
    st.integers(0, 2**32 - 1), st.sampled_from(["skew", "parallel", "points", "crossing", "nearly parallel"])
)
def test_the_distance_of_segments_is_the_least_between_sampled_points(seed, case):
    rng = np.random.default_rng(seed)
    a, b, c, d = rng.uniform(-1.0, 1.0, (4, 3))
    if case == "parallel":
        d = c + rng.uniform(-2.0, 2.0) * (b - a)
    elif case == "nearly parallel":
        d = c + rng.uniform(-2.0, 2.0) * (b - a) + 10.0 ** rng.uniform(-12.0, -3.0) * rng.normal(size=3)
    elif case == "points":
        b, d = a, (d if seed % 2 else c)
    elif case == "crossing":
        d = 2.0 * (a + 0.3 * (b - a)) - c
    shares = np.linspace(0.0, 1.0, 201)[:, None]
    first, second = a + shares * (b - a), c + shares * (d - c)
    sampled = np.linalg.norm(first[:, None] - second, axis=2).min()
    exact = segment_distance(np.array([[a, b]]), np.array([[c, d]]))[0]
    step = 0.005 * (np.linalg.norm(b - a) + np.linalg.norm(d - c)) / 2.0
    assert sampled - step - 1e-12 <= exact <= sampled + 1e-12


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
