import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import trimesh

from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.loading import load
from evenroad.loading.load import load_model, load_robot
from evenroad.robots.variants import with_group, with_limits
from evenroad.scenes.robot_in_scene import in_scene
from evenroad.scenes.scene import Scene
from tests.refused import refused
from tests.robots.kernel_arms import CAPSULES, LINKS
from tests.robots.urdf_texts import joint, link, two_joints, urdf, write


def test_the_ur5_has_its_capsules_its_limits_and_its_names():
    robot = load_robot("ur5")
    for capsule, (link_number, a, b, radius) in zip(robot.capsules, CAPSULES, strict=True):
        assert capsule.link.replace("_", "") == f"{LINKS[link_number]}link"
        np.testing.assert_allclose([*capsule.a, *capsule.b, capsule.radius], [0, *a, 0, *b, radius], atol=1e-15)
    names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    assert robot.group == tuple(f"{name}_joint" for name in names)
    moving = [joint for joint in robot.joints if joint.kind != "fixed"]
    assert [joint.upper for joint in moving] == [2 * np.pi, 2 * np.pi, np.pi, 2 * np.pi, 2 * np.pi, 2 * np.pi]
    assert [joint.lower for joint in moving] == [-joint.upper for joint in moving]
    assert [joint.velocity for joint in moving] == [3.15, 3.15, 3.15, 3.2, 3.2, 3.2]


def test_a_file_goes_before_a_shipped_name_but_no_folder_does(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write(tmp_path, two_joints(), "ur5")
    assert load_robot("ur5").group == ("a", "b")
    (tmp_path / "ur5").unlink()
    (tmp_path / "ur5").mkdir()
    assert load_robot("ur5").name == "ur5"


STATES = """
<group name="all"><joint name="a"/><joint name="b"/></group><group name="arm"><joint name="a"/></group>
<group_state name="home" group="{0}"><joint name="a" value="{1}"/></group_state>
<group_state name="home" group="{2}"><joint name="a" value="{3}"/><joint name="b" value="0.5"/></group_state>
<group_state name="rest" group="all"><joint name="a" value="0.75"/><joint name="b" value="0.25"/></group_state>
"""


@pytest.mark.parametrize("row", [("arm", 0.1, "all", 0.2), ("all", 0.2, "arm", 0.1)])
@pytest.mark.parametrize("group", ["arm", "a"])
def test_of_two_states_of_a_name_the_one_of_the_group_is_taken(tmp_path, row, group):
    srdf = write(tmp_path, f"<robot name='arm'>{STATES.format(*row)}</robot>", "arm.srdf")
    robot = load_robot(write(tmp_path, two_joints()), srdf=srdf, group=group)
    assert robot.states["home"]["a"] == 0.1
    # One of another group under a name of its own, with what it says of the others.
    assert robot.states["rest"] == {"a": 0.75, "b": 0.25}


@pytest.mark.parametrize("name", ["ur6", "UR5"])
def test_an_unknown_robot_gets_the_list_of_shipped_ones(name):
    refused(UnknownName, f"no robot file '{name}', and none .* shipped: arm7, ur5", load_robot, name)
    refused(BrokenFile, r"cannot read the robot no/where\.urdf", load_robot, "no/where.urdf")


DRAWN = "<visual><geometry><box size='1 1 1'/></geometry></visual>"


def test_links_without_a_body_are_named_those_that_are_drawn_apart(tmp_path):
    text = urdf(
        link("base"),
        link("camera", DRAWN),
        link("tool", ""),
        link("hand", DRAWN),
        joint("a", "base", "camera"),
        joint("b", "camera", "tool", "fixed", ""),
        joint("c", "tool", "hand", "fixed", ""),
    )
    path = write(tmp_path, text)
    for model in (load_model(path), load_model(path)):
        assert model.bodiless == ("camera", "tool", "hand")
        assert model.drawn_only == ("camera", "hand")
    bodies = write(tmp_path, "hand: [{centre: [0, 0, 0], radius: 0.1}]", "bodies.yaml")
    assert load_model(path, bodies=bodies).drawn_only == ("camera",)


BODIES = "lower: [{a: [0, 0, 0], b: [0, 0, 0.2], radius: 0.03}, {centre: [0, 0, 0.3], radius: 0.05}]\n"


def test_bodies_of_the_user_take_the_place_of_a_links_own(tmp_path):
    path = write(tmp_path, two_joints())
    model = load_model(path, bodies=write(tmp_path, BODIES, "bodies.yaml"))
    lower = [capsule for capsule in model.robot.capsules if capsule.link == "lower"]
    assert [(capsule.a, capsule.b, capsule.radius) for capsule in lower] == [
        ((0, 0, 0), (0, 0, 0.2), 0.03),
        ((0, 0, 0.3), (0, 0, 0.3), 0.05),
    ]
    assert len(model.robot.capsules) == 4
    assert [body.given for body in model.bodies] == [False, False, True]


@pytest.mark.parametrize(("text", "kind", "says"), [
    ("ghost: [{centre: [0, 0, 0], radius: 1}]", UnknownName, "link in .*'ghost'; known: base"),
    ("lower: [{centre: [0, 0, 0], radius: 1, colour: red}]", UnknownName, "'colour'; known: centre, radius"),
    ("lower: [{a: [0, 0, 0], radius: 1}]", BrokenFile, "a body of link 'lower' in .* lacks b"),
    ("lower: [{centre: [0, 0], radius: 1}]", InvalidValue, r"must be a list of 3 finite numbers, got \[0, 0\]"),
    ("lower: [{centre: [0, 0, 0], radius: 0}]", InvalidValue, "radius of .* > 0, got 0.0"),
    ("lower: [{centre: [0, 0, 0], radius: 1e-2}]", InvalidValue, "got '1e-2' .*decimal point"),
    ("lower: []", InvalidValue, "has no body"),
    ("lower: [{centre: [0, 0, 0], radius: 1}]\nlower: [{centre: [0, 0, 0], radius: 2}]\n", BrokenFile,
        "bodies.yaml has the key 'lower' twice, in lines 1 and 2"),
    ("lower: [{centre: [0, 0, 0], radius: 1, radius: 2}]", BrokenFile,
        "has the key 'radius' twice, in lines 1 and 1"),
    ("lower: 3", BrokenFile, "must have a list"), ("hello", BrokenFile, "is not a file of bodies"),
    ("a: [", BrokenFile, "is not YAML"),
])  # fmt: skip
def test_bodies_that_are_wrong_are_named(tmp_path, text, kind, says):
    with pytest.raises(EvenroadError, match=says) as caught:
        load_robot(write(tmp_path, two_joints()), bodies=write(tmp_path, text, "bodies.yaml"))
    assert isinstance(caught.value, kind)
    assert "\n" not in str(caught.value)


def _with_mesh(folder):
    trimesh.creation.cone(0.05, 0.3).export(folder / "part.stl")
    body = "<collision><geometry><mesh filename='part.stl' scale='1 1 2'/></geometry></collision>"
    return write(folder, two_joints(body))


def test_a_robot_of_meshes_says_how_much_its_capsules_add(tmp_path):
    model = load_model(_with_mesh(tmp_path))
    (body,) = [body for body in model.bodies if body.link == "lower"]
    assert body.shapes == ("mesh part.stl",)
    assert body.shape_volume == pytest.approx(np.pi * 0.05**2 * 0.6 / 3, rel=0.02)
    assert 0.1 < body.added < 4.0


def test_a_robot_from_the_cache_is_the_one_that_was_put_there(tmp_path):
    path = _with_mesh(tmp_path)
    first = load_model(path)
    (kept,) = kept_robots()
    # Under a seal, as plain JSON.
    seal, _, record = kept.read_text().partition("\n")
    assert seal.startswith("evenroad-kept:")
    assert json.loads(record)["robot"]["name"] == first.robot.name
    assert load_model(path) == first
    assert load_model("ur5") == load_model("ur5")
    kept.write_text("{")
    assert load_model(path) == first


def kept_robots():
    """The files of the cache."""
    return {*(Path(os.environ["EVENROAD_CACHE"]) / "robots").iterdir()}


@pytest.mark.parametrize("changed", ["urdf", "mesh", "srdf", "bodies", "group"])
def test_the_cache_takes_notice_of_every_change(tmp_path, changed):
    path = _with_mesh(tmp_path)
    group = "<robot name='a'><group name='g'><joint name='a'/><joint name='b'/></group></robot>"
    srdf = write(tmp_path, group, "a.srdf")
    bodies = write(tmp_path, BODIES.replace("lower", "upper"), "bodies.yaml")
    options = {"srdf": srdf, "bodies": bodies, "group": "g"}
    before = load_robot(path, **options)
    if changed == "urdf":
        path.write_text(path.read_text().replace("upper='1'", "upper='0.5'"))
    elif changed == "mesh":
        trimesh.creation.cone(0.06, 0.3).export(tmp_path / "part.stl")
    elif changed == "srdf":
        srdf.write_text(srdf.read_text().replace("<joint name='b'/>", ""))
    elif changed == "bodies":
        bodies.write_text(bodies.read_text().replace("0.05", "0.06"))
    else:
        options["group"] = "a"
    assert load_robot(path, **options) != before


def test_a_robot_read_before_is_the_same_until_a_file_or_a_state_changes(tmp_path):
    path = _with_mesh(tmp_path)
    for file in (path, tmp_path / "part.stl"):
        os.utime(file, (1e9, 1e9))
    robot = load_model(path).robot
    assert load_model(path).robot is robot
    os.utime(tmp_path / "part.stl", (1.1e9, 1.1e9))
    again = load_model(path).robot
    assert again is not robot
    assert again == robot
    again.states["mine"] = {"a": 0.5}
    assert "mine" not in load_model(path).robot.states


def test_the_cache_knows_shapes_by_all_their_digits(tmp_path):
    box = "<collision><geometry><box size='0.1 0.1 {}'/></geometry></collision>"
    robots = [load_robot(write(tmp_path, two_joints(box.format(z)))) for z in ("0.3", "0.30000001")]
    assert robots[0] != robots[1]


def test_an_srdf_without_a_pair_is_told_from_no_srdf_and_from_one_that_is_empty(tmp_path):
    path, empty = write(tmp_path, two_joints()), write(tmp_path, "", "empty")
    assert load_model(path).pairs_from == "computed"
    refused(BrokenFile, "empty is empty, not XML", load_model, path, srdf=empty)
    refused(BrokenFile, "empty is empty, not a file of bodies", load_model, path, bodies=empty)


def test_a_file_saved_while_it_is_read_is_not_kept_for_what_it_was(tmp_path):
    from evenroad.loading import load

    path = write(tmp_path, two_joints())
    read = load.read_urdf

    def saved_meanwhile(source):
        path.write_text(two_joints().replace("upper='1'", "upper='0.5'"))
        return read(source)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(load, "read_urdf", saved_meanwhile)
        assert load_robot(path).joints[0].upper == 0.5
    path.write_text(two_joints())
    assert load_robot(path).joints[0].upper == 1.0


def test_a_mesh_that_went_away_is_missed_though_the_robot_is_in_the_cache(tmp_path):
    path = _with_mesh(tmp_path)
    load_robot(path)
    (tmp_path / "part.stl").unlink()
    refused(BrokenFile, r"'part.stl' of link 'lower' .* is missing", load_robot, path)


def test_a_cache_that_cannot_be_written_only_costs_time(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path / "file"))
    assert load_robot(write(tmp_path, two_joints())).group == ("a", "b")


def test_a_cached_robot_waits_for_no_library_of_meshes_or_fits(tmp_path):
    code = (
        "import sys; from evenroad.loading.load import load_robot; load_robot('ur5');"
        "print([name for name in ('trimesh', 'scipy.optimize') if name in sys.modules])"
    )
    load_robot("ur5")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def damaged(content, rng):
    """Yield what may become of a file: cut off anywhere, bits flipped, bytes lost, zeroed or appended."""
    yield from (b"", content[:1], content[:-1], content + b" ", content[1:], content * 2, b"\0" * len(content))
    yield from (content[:at] for at in rng.integers(len(content), size=100))
    for at in rng.integers(8 * len(content), size=300):
        flipped = bytearray(content)
        flipped[at // 8] ^= 1 << at % 8
        yield bytes(flipped)
    for at in rng.integers(len(content), size=50):
        yield content[:at] + bytes(512) + content[at + 512 :]
        yield content[:at] + content[at + 7 :]


def test_of_a_damaged_cache_comes_the_right_robot_and_one_line(tmp_path, monkeypatch, caplog):
    path = write(tmp_path, two_joints())
    right = load_model(path)
    (kept,) = kept_robots()
    content, made = kept.read_bytes(), []
    # As another process, which has not read it before.
    monkeypatch.setattr(load, "known", lambda request: None)
    monkeypatch.setattr(load, "_build", lambda *arguments: made.append(arguments) or replace(right, file=None))
    broken = [each for each in damaged(content, np.random.default_rng(1)) if each != content]
    for i, each in enumerate(broken):
        kept.write_bytes(each)
        assert load_model(path) == right
        assert len(made) == len(caplog.messages) == i + 1
        assert kept.read_bytes() == content, "it is kept again, whole"
    assert len(broken) > 450
    assert {line.replace(str(kept), "FILE") for line in caplog.messages} == {
        "evenroad: the robot kept in FILE was damaged, and is made again"
    }


def test_a_robot_that_is_kept_under_the_name_of_another_is_not_taken(tmp_path):
    first = write(tmp_path, two_joints())
    second = write(tmp_path, urdf(link("x"), link("y"), joint("a", "x", "y")), "b.urdf")
    load_model(first)
    (kept,) = kept_robots()
    right = load_model(second)
    (other,) = kept_robots() - {kept}
    other.write_bytes(kept.read_bytes())
    assert load_model(second) == right


def test_altering_a_robot_leaves_the_robot_as_it_was():
    robot = load_robot("ur5")
    held = with_group(robot, robot.group[:2], {"elbow_joint": 1.0})
    narrow = with_limits(held, {"shoulder_pan_joint": (-1, 1)})
    assert (narrow.joints[0].lower, narrow.joints[0].upper) == (-1, 1)
    assert narrow.held == {"elbow_joint": 1.0}
    assert robot == load_robot("ur5")


def test_a_continuous_joint_that_gets_limits_is_a_revolute_one(tmp_path):
    robot = load_robot(write(tmp_path, urdf(link("x"), link("y"), joint("a", "x", "y", "continuous", ""))))
    assert with_limits(robot, {"a": (0, 1)}).joints[0].kind == "revolute"


def test_a_scene_can_only_narrow_a_joints_range():
    robot = load_robot("ur5")
    scene = Scene((), name="s", limits={"elbow_joint": (-1.0, 9.0)})
    elbow = in_scene(robot, scene).joints[2]
    assert (elbow.lower, elbow.upper) == (-1.0, np.pi)
    with pytest.raises(InvalidValue, match="limits of joint 'elbow_joint' must satisfy lower < upper"):
        in_scene(robot, Scene((), name="s", limits={"elbow_joint": (4.0, 9.0)}))


@pytest.mark.parametrize(("held", "says"), [
    ({"elbow_joint": 99.0}, "puts joint 'elbow_joint' at 99 rad, 95.9 rad outside its limits"),
    ({"elbow_joint": np.nan}, "at nan; it must be a finite number"),
    ({"shoulder_pan_joint": 0.5}, "'shoulder_pan_joint' is in the group: .* cannot be held"),
])  # fmt: skip
def test_a_joint_that_cannot_be_held_is_refused(held, says):
    robot = load_robot("ur5")
    refused(InvalidValue, says, with_group, robot, robot.group[:2], held)


@pytest.mark.parametrize(
    "alter", [lambda robot: with_group(robot, ["knee"]), lambda robot: with_limits(robot, {"knee": (0, 1)})]
)
def test_altering_a_joint_that_is_not_there_is_refused(alter):
    refused(UnknownName, "'knee'", alter, load_robot("ur5"))


@pytest.mark.parametrize("huge", ["1e10", "1e155", "1e308"])
@pytest.mark.parametrize("attribute", ["radius", "length", "xyz"])
def test_a_length_whose_powers_are_no_numbers_is_refused(tmp_path, monkeypatch, attribute, huge):
    monkeypatch.setenv("EVENROAD_CACHE", str(tmp_path / "cache"))
    text = (resources.files("evenroad.loading") / "data" / "ur5.urdf").read_text()
    (tmp_path / "huge.urdf").write_text(re.sub(rf'{attribute}="[^" ]*', f'{attribute}="{huge}', text, count=1))
    refused(InvalidValue, r"must (be at most|lie between -1e\+09 and) 1e\+09", load_robot, tmp_path / "huge.urdf")
