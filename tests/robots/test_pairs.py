import numpy as np
import pytest
import trimesh

from evenroad.robot import ArmWorld, load_model, load_robot, with_group
from evenroad.robots.pairs import CONTAINED
from tests.robots.kernel_arms import PAIRS
from tests.robots.mesh_arms import write_plate_arm
from tests.robots.urdf_texts import LIMIT, joint, link, urdf, write


def test_the_ur5s_pairs_are_those_of_its_srdf():
    model = load_model("ur5")
    names = [f"{name}_link" for name in ("base", "shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3")]
    assert model.robot.pairs == tuple((names[int(i)], names[int(j)]) for i, j in PAIRS)
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
    text = urdf(*(link(name, _ball(0.05)) for name in "abc"), joint("j", "a", "b"), joint("k", "b", "c", inside=LIMIT))
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


def test_a_pair_is_tested_whose_capsules_always_touch_but_not_its_shapes(tmp_path):
    robot = load_model(write_plate_arm(tmp_path)).robot
    world = ArmWorld(robot)
    turn, bend = np.zeros((90, 3)), np.zeros((90, 3))
    turn[:, 0], bend[:, 1] = np.linspace(-2.8, 2.8, 90), np.linspace(-2.8, 2.8, 90)
    assert world.valid(turn).all()
    # The lowest point of the tip, a ball of 12 mm 2 cm from its joint, 30 mm above the top of the plate.
    touches = 0.03 - 0.02 * np.sin(bend[:, 1]) <= 0.012
    assert not world.valid(bend[touches]).any()
    assert world.valid(bend[~touches]).all()
    assert touches.sum() > 5


def _gripper(*, opening):
    """An arm with two fingers that touch where they are closed, 0, and come apart by `opening` [m]."""
    slide = f"<limit lower='0' upper='{opening}' velocity='1' effort='1'/>"
    box = "<collision><geometry><box size='0.02 0.02 0.05'/></geometry></collision>"
    return urdf(
        link("base", _ball(0.05)), link("arm", _ball(0.05)), link("hand", _ball(0.02)),
        link("left", box), link("right", box),
        joint("j", "base", "arm", xyz="0 0 0.2"), joint("w", "arm", "hand", xyz="0 0 0.2"),
        joint("l", "hand", "left", "prismatic", slide, "0 -0.0099 0.08", "0 -1 0"),
        joint("r", "hand", "right", "prismatic", slide, "0 0.0099 0.08"),
    )  # fmt: skip


def test_fingers_that_touch_where_they_are_held_do_not_block_the_arm_that_holds_them(tmp_path):
    path = write(tmp_path, _gripper(opening=0.03))
    robot = load_model(path, group="j,w").robot
    assert ("left", "right") not in robot.pairs
    assert ArmWorld(robot).valid(np.zeros((1, 2))).all()
    opened = with_group(robot, robot.group, {"l": 0.02, "r": 0.02})
    assert ArmWorld(opened).valid(np.zeros((1, 2))).all()
    whole = ArmWorld(with_group(robot, ("j", "w", "l", "r")))
    assert not whole.valid(np.zeros((1, 4))).any()
    assert whole.valid(np.array([[0, 0, 0.01, 0.01]])).all()


def test_two_links_that_an_srdf_lets_be_tested_block_the_arm_where_they_are_held_in_contact(tmp_path):
    srdf = "<robot name='arm'><disable_collisions link1='arm' link2='hand'/></robot>"
    path = write(tmp_path, _gripper(opening=0.03))
    robot = load_model(path, srdf=write(tmp_path, srdf, "arm.srdf"), group="j,w").robot
    closed = with_group(robot, robot.group, {"l": 0.0, "r": 0.0})
    assert ArmWorld(closed).fixed_contact == ("left", "right")
    # Where nobody says how, they are held open.
    assert ArmWorld(robot).fixed_contact is None


def test_a_robot_of_which_no_configuration_is_free_says_so_and_names_the_pair_that_blocks_most(tmp_path):
    # A ball goes round among four others, which are two links: it touches now one of these, now the other.
    two = "".join(_ball(0.14, f"{x} {y} 0.3") for x, y in ((0.2, 0), (-0.2, 0)))
    other = "".join(_ball(0.14, f"{x} {y} 0.3") for x, y in ((0, 0.2), (0, -0.2)))
    text = urdf(
        link("base", _ball(0.05)), link("one", two), link("two", other), link("arm", _ball(0.02)),
        link("tip", _ball(0.06, "0.2 0 0")), link("tail", _ball(0.02, "0 0 0.3")),
        joint("a", "base", "one", "fixed", "", "0 0 0"), joint("b", "base", "two", "fixed", "", "0 0 0"),
        joint("turn", "base", "arm", "continuous", "", "0 0 0.3", "0 0 1"),
        joint("nod", "arm", "tip", xyz="0 0 0", axis="1 0 0"), joint("wag", "tip", "tail", xyz="0 0 0", axis="0 0 1"),
    )  # fmt: skip
    path = write(tmp_path, text)
    model = load_model(path)
    assert {("one", "tip"), ("two", "tip")} <= set(model.robot.pairs)
    assert "random configurations is free of self-collision" in model.never_free
    assert "'tip' touch in" in model.never_free
    with pytest.warns(UserWarning, match="free of self-collision"):
        load_robot(path)


def test_a_pair_that_touches_only_where_another_joint_is_held_comes_back_elsewhere(tmp_path):
    slide = "<limit lower='0' upper='1' velocity='1' effort='1'/>"
    text = urdf(
        link("base", _ball(0.1)), link("trolley", ""), link("arm", _ball(0.1, "0.1 0 0")), link("tip", _ball(0.02)),
        joint("lift", "base", "trolley", "prismatic", slide, "0 0 0", "0 0 1"),
        joint("turn", "trolley", "arm", "continuous", "", "0 0 0.05", "0 0 1"),
        joint("nod", "arm", "tip", xyz="0.5 0 0"),
    )  # fmt: skip
    path = write(tmp_path, text)
    model = load_model(path, group="turn,nod")
    robot = model.robot
    assert ("base", "arm", "touch in every sample with the other joints where they are held") in model.dropped
    assert robot.pairs == (("base", "tip"),)
    assert with_group(robot, ("turn", "nod"), {"lift": 0.0}).pairs == robot.pairs
    lifted = with_group(robot, ("turn", "nod"), {"lift": 0.5})
    assert set(lifted.pairs) == {("base", "tip"), ("base", "arm")}
    assert ArmWorld(lifted).valid(np.zeros((1, 2))).all()
    assert ("base", "arm") in with_group(robot, ("lift", "turn", "nod")).pairs
    assert ("base", "arm") in load_model(path).robot.pairs


def _crossing(tmp_path, outer):
    """The world of a block of 4 cm that slides through a link with a mesh, 1 m to either side and up and down."""
    outer.export(tmp_path / "outer.stl")
    trimesh.creation.box((0.04, 0.04, 0.04)).export(tmp_path / "block.stl")
    slide = "<limit lower='-1' upper='1' velocity='1' effort='1'/>"
    mesh = "<collision><geometry><mesh filename='{}.stl'/></geometry></collision>"
    text = urdf(
        link("outer", mesh.format("outer")), link("rod", _ball(0.02, "0 0 3")), link("block", mesh.format("block")),
        joint("across", "outer", "rod", "prismatic", slide, "0 0 0", "1 0 0"),
        joint("up", "rod", "block", "prismatic", slide, "0 0 0", "0 0 1"),
    )  # fmt: skip
    return ArmWorld(load_model(write(tmp_path, text)).robot)


BESIDE = np.stack(np.meshgrid(np.linspace(-0.9, 0.9, 37), np.linspace(-0.9, 0.9, 37)), axis=-1).reshape(-1, 2)


def test_a_link_wholly_inside_the_closed_convex_mesh_of_another_is_not_free(tmp_path):
    world = _crossing(tmp_path, trimesh.creation.box((0.5, 0.5, 0.5)))
    apart = np.abs(BESIDE).max(axis=1) - 0.27
    assert (apart < -0.1).sum() > 20, "wholly inside, far from the surface"
    np.testing.assert_array_equal(world.valid(BESIDE), apart > 0.0)


def test_a_link_in_an_open_bin_is_free(tmp_path):
    box = trimesh.creation.box((0.5, 0.5, 0.5))
    lidless = trimesh.Trimesh(box.vertices, box.faces[box.face_normals[:, 2] < 0.5])
    world = _crossing(tmp_path, lidless)
    inside = (np.abs(BESIDE) < 0.1).all(axis=1)
    assert inside.sum() > 5
    assert world.valid(BESIDE[inside]).mean() > 0.5


def test_pairs_of_a_hundred_bodies_are_soon_judged(tmp_path):
    box = "<collision><origin xyz='0 0 0.04'/><geometry><box size='0.03 0.03 0.06'/></geometry></collision>"
    links = [link(f"l{i}", box) for i in range(100)]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}", xyz="0 0 0.08") for i in range(99)]
    model = load_model(write(tmp_path, urdf(*links, *joints)))
    assert len(model.robot.pairs) == 100 * 99 // 2 - 99


def _bellows(into, upper=0.4, glue="fixed"):
    """A bellows of .3 m on a mast, so far in the base where the mast, which rises by `upper`, is low [m]."""
    base = "<collision><geometry><box size='.4 .4 .3'/></geometry></collision>"
    mast = "<collision><origin xyz='0 0 .3'/><geometry><box size='.05 .05 .1'/></geometry></collision>"
    tube = f"<collision><origin xyz='0 0 {0.15 - into + 0.15}'/><geometry><box size='.1 .1 .3'/></geometry></collision>"
    return urdf(
        link("base", base), link("mast", mast), link("bellows", tube), link("arm", _ball(0.04, "0.3 0 0")),
        joint("lift", "base", "mast", "prismatic", f"<limit lower='0' upper='{upper}'/>", "0 0 0", "0 0 1"),
        joint("glue", "mast", "bellows", glue, "", "0 0 0", "0 0 1"),
        joint("turn", "mast", "arm", "continuous", "", "0 0 .6", "0 0 1"),
    )  # fmt: skip


def test_a_bellows_in_its_base_as_drawn_is_named_and_left_out_unless_an_srdf_says_otherwise(tmp_path):
    path = write(tmp_path, _bellows(0.26))
    model = load_model(path)
    assert ("base", "bellows", CONTAINED) in model.dropped
    assert model.notes == (
        "'base' and 'bellows', of which one goes into the other as drawn, are not tested against each other: an SRDF"
        " that disables other pairs alone has them tested",
    )
    assert load_model(path) == model, "as it comes out of the cache"
    world = ArmWorld(model.robot)
    assert world.valid(world.space.from_cube(np.random.default_rng(0).random((50, 2)))).all()
    disabled = "<disable_collisions link1='base' link2='mast' reason='Adjacent'/>"
    srdf = write(tmp_path, f"<robot name='arm'>{disabled}</robot>", "arm.srdf")
    assert ("base", "bellows") in load_model(path, srdf=srdf).robot.pairs


@pytest.mark.parametrize(("into", "upper"), [(0.14, 0.2), (0.18, 0.4)])
def test_a_body_that_reaches_into_another_but_less_or_seldom_stays_tested(tmp_path, into, upper):
    assert ("base", "bellows") in load_model(write(tmp_path, _bellows(into, upper))).robot.pairs


def test_bodies_that_more_joints_move_on_each_other_stay_tested_however_deep_they_are(tmp_path):
    assert ("base", "bellows") in load_model(write(tmp_path, _bellows(0.26, glue="continuous"))).robot.pairs
