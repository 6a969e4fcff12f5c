"""A joint that others follow goes no further than they can."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evenroad.collision.arm_world import ArmWorld
from evenroad.loading.load import load_robot
from evenroad.robots.joint import Joint, Mimic, within_limits_of_mimics
from evenroad.robots.kinematics import joint_values
from evenroad.robots.variants import with_limits
from evenroad.scenes.scene import Scene
from tests.robots.urdf_texts import joint, link, urdf, write

NONE = (0.0, 0.0, 0.0)
STRAIGHT = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def leader(lower, upper, kind="revolute"):
    return Joint("a", kind, "base", "upper", NONE, STRAIGHT, lower=lower, upper=upper)


def follower(lower, upper, multiplier, offset=0.0, name="b"):
    kind = "continuous" if math.isinf(lower) else "revolute"
    mimic = Mimic("a", multiplier, offset)
    return Joint(name, kind, "upper", name, NONE, STRAIGHT, lower=lower, upper=upper, mimic=mimic)


def limits(*joints):
    first = within_limits_of_mimics(joints)[0]
    return first.kind, first.lower, first.upper


@pytest.mark.parametrize(("followers", "expected"), [
    ([follower(-1.0, 1.0, 2.0)], (-0.5, 0.5)), ([follower(-1.0, 1.0, -2.0, 0.5)], (-0.25, 0.75)),
    ([follower(-1.0, 0.2, 1.0), follower(-0.3, 1.0, 0.5, name="c")], (-0.6, 0.2)),
    ([follower(-9.0, 9.0, 1.0)], (-1.0, 1.0)), ([follower(-math.inf, math.inf, 5.0)], (-1.0, 1.0)),
    ([follower(-1.0, 1.0, 0.0, 0.5)], (-1.0, 1.0)),
], ids=["half as far", "the other way", "two of them", "wider", "turns on", "stays"])  # fmt: skip
def test_limits_of_a_leader_are_narrowed_to_those_of_its_mimics(followers, expected):
    kind, *found = limits(leader(-1.0, 1.0), *followers)
    assert kind == "revolute"
    assert found == pytest.approx(list(expected))


def test_a_joint_that_turns_on_stops_where_its_mimic_does_and_rounding_narrows_nothing():
    assert limits(leader(-math.inf, math.inf, "continuous"), follower(-1.0, 2.0, 0.5)) == ("revolute", -2.0, 4.0)
    free = follower(-math.inf, math.inf, 2.0)
    assert limits(leader(-math.inf, math.inf, "continuous"), free) == ("continuous", -math.inf, math.inf)
    """0.7 / 0.1 is not 7: a start at the limit must not be outside of it."""
    assert limits(leader(-7.0, 7.0), follower(-0.7, 0.7, 0.1)) == ("revolute", -7.0, 7.0)


@pytest.mark.parametrize("alone", [
    follower(2.0, 3.0, 1.0),
    follower(-1.0, 1.0, 0.0, 1.5),
    follower(2.5, 2.6, -1.0, 0.0),
    follower(0.0, 0.0, 1.0, -0.25),
], ids=["never within", "stays outside", "the other way", "cannot move"])  # fmt: skip
def test_limits_of_a_mimic_that_leave_its_leader_no_way_to_go_are_not_heeded(alone):
    assert limits(leader(-1.0, 1.0), alone) == ("revolute", -1.0, 1.0)


def test_a_mirrored_finger_with_the_limits_of_the_other_does_not_lock_the_gripper():
    assert limits(leader(0.0, 0.04), follower(0.0, 0.04, -1.0)) == ("revolute", 0.0, 0.04)


@settings(max_examples=200, deadline=None)
@given(
    st.floats(-3, 3).filter(lambda m: abs(m) > 1e-3),
    st.floats(-0.5, 0.5),
    st.floats(-2, -0.6),
    st.floats(0.6, 2),
    st.floats(0, 1),
)
def test_a_leader_within_its_limits_keeps_its_mimic_within_its_own(multiplier, offset, lower, upper, share):
    _, low, high = limits(leader(-2.0, 2.0), follower(lower, upper, multiplier, offset))
    value = multiplier * (low + share * (high - low)) + offset
    assert lower - 1e-8 <= value <= upper + 1e-8


def test_no_configuration_of_a_loaded_robot_takes_a_mimic_out_of_its_limits(tmp_path):
    """Followers of followers, one of them backwards; the leader is planned for within what is left."""
    inside = "<limit lower='-0.4' upper='0.3'/>"
    text = urdf(
        *(link(name) for name in "wxyz"),
        joint("a", "w", "x"),
        joint("b", "x", "y", inside=inside + "<mimic joint='a' multiplier='2' offset='0.1'/>"),
        joint("c", "y", "z", inside=inside + "<mimic joint='b' multiplier='-1' offset='0.1'/>"),
    )
    robot = load_robot(write(tmp_path, text))
    world = ArmWorld(robot, Scene((), name="nothing"))
    q = world.space.from_cube(np.linspace(0.0, 1.0, 200)[:, np.newaxis])
    values = joint_values(robot, q)
    for name in "bc":
        assert values[name].min() >= -0.4 - 1e-9
        assert values[name].max() <= 0.3 + 1e-9
    np.testing.assert_allclose([q.min(), q.max()], [-0.15, 0.1], atol=1e-12)


def test_limits_of_a_mimic_given_later_narrow_its_leader_too(tmp_path):
    text = urdf(
        *(link(name) for name in "xyz"),
        joint("a", "x", "y"),
        joint("b", "y", "z", inside="<limit lower='-1' upper='1'/><mimic joint='a'/>"),
    )
    narrow = with_limits(load_robot(write(tmp_path, text)), {"b": (-0.2, 0.3)})
    first = next(each for each in narrow.joints if each.name == "a")
    assert (first.lower, first.upper) == (-0.2, 0.3)
