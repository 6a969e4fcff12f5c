import math
import re

import numpy as np
import pytest
import trimesh

from evenroad.collision.coal_world import original_shapes
from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.loading.robot_file import RobotFile, find_mesh
from evenroad.loading.urdf import read_urdf
from evenroad.robot import ArmWorld, Scene, in_scene, load_model
from tests.refused import refused
from tests.robots.urdf_texts import LIMIT, SPHERE, joint, link, two_joints, urdf, write


def test_links_come_root_first_and_joints_lead_to_them_whatever_the_files_order(tmp_path):
    text = urdf(
        joint("b", "upper", "lower"),
        link("lower"),
        joint("side", "base", "camera", "fixed", ""),
        link("camera"),
        link("upper"),
        joint("a", "base", "upper"),
        link("base"),
    )
    arm = read_urdf(write(tmp_path, text))
    assert arm.links[0] == "base"
    assert [each.child for each in arm.joints] == list(arm.links[1:])
    for i, each in enumerate(arm.joints):
        assert each.parent in arm.links[: i + 1]
    assert arm.order == ("b", "side", "a")


def test_numbers_are_read_as_they_stand(tmp_path):
    text = urdf(
        link("base"),
        link("tool"),
        "<joint name='j' type='prismatic'><parent link='base'/><child link='tool'/>"
        "<origin xyz='1 2 3' rpy='0 0 1.5707963267948966'/><axis xyz='0 0 2'/>"
        "<limit lower='-0.1' upper='0.4' velocity='0.5' effort='1'/></joint>",
    )
    (each,) = read_urdf(write(tmp_path, text)).joints
    assert (each.kind, each.xyz, each.axis) == ("prismatic", (1.0, 2.0, 3.0), (0.0, 0.0, 1.0))
    assert (each.lower, each.upper, each.velocity) == (-0.1, 0.4, 0.5)
    np.testing.assert_allclose(each.rotation, [0, -1, 0, 1, 0, 0, 0, 0, 1], atol=1e-15)


def test_an_axis_that_is_not_given_is_x(tmp_path):
    axisless = f"<joint name='j' type='revolute'><parent link='base'/><child link='tool'/>{LIMIT}</joint>"
    text = urdf(link("base"), link("tool"), axisless)
    assert read_urdf(write(tmp_path, text)).joints[0].axis == (1.0, 0.0, 0.0)


def test_a_continuous_joint_has_no_limits_and_a_velocity_of_0_means_not_given(tmp_path):
    inside = "<limit lower='-1' upper='1' velocity='0' effort='0'/>"
    text = urdf(link("base"), link("tool"), joint("j", "base", "tool", "continuous", inside))
    (each,) = read_urdf(write(tmp_path, text)).joints
    assert (each.lower, each.upper, each.velocity) == (-math.inf, math.inf, math.inf)


def test_a_mimic_of_a_mimic_follows_the_first_directly(tmp_path):
    text = urdf(
        *(link(name) for name in "wxyz"),
        joint("a", "w", "x"),
        joint("b", "x", "y", inside=LIMIT + "<mimic joint='a' multiplier='2' offset='0.1'/>"),
        joint("c", "y", "z", inside=LIMIT + "<mimic joint='b' multiplier='-3' offset='1'/>"),
    )
    mimic = read_urdf(write(tmp_path, text)).joints[2].mimic
    assert mimic.joint == "a"
    assert (mimic.multiplier, mimic.offset) == pytest.approx((-6.0, 0.7))


def test_every_shape_is_read_and_the_capsule_is_not_taken_for_a_cylinder(tmp_path):
    shapes = (
        "<box size='1 2 3'/>",
        "<sphere radius='0.5'/>",
        "<cylinder radius='0.1' length='2'/>",
        "<capsule radius='0.2' length='4'/>",
    )
    body = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in shapes)
    shapes = read_urdf(write(tmp_path, urdf(link("base", body)))).shapes
    assert [(each.kind, each.size) for each in shapes] == [
        ("box", (1.0, 2.0, 3.0)),
        ("sphere", (0.5,)),
        ("cylinder", (0.1, 2.0)),
        ("capsule", (0.2, 4.0)),
    ]


def test_what_is_not_for_collision_is_not_looked_at(tmp_path):
    body = SPHERE + "<visual><geometry><teapot/></geometry></visual><inertial><mass value='much'/></inertial>"
    text = urdf(link("base", body), "<transmission name='t'/>", "<gazebo><mesh/></gazebo>")
    assert len(read_urdf(write(tmp_path, text)).shapes) == 1


def test_commas_between_numbers_are_blanks(tmp_path):
    body = "<collision><origin xyz='1,2, 3'/><geometry><box size='1, 2,3'/></geometry></collision>"
    text = urdf(link("x", body), link("y"), joint("a", "x", "y", xyz="0.1,0.2,0.3", axis="0,1,0"))
    arm = read_urdf(write(tmp_path, text))
    assert (arm.shapes[0].size, arm.shapes[0].pose.xyz) == ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0))
    assert (arm.joints[0].xyz, arm.joints[0].axis) == ((0.1, 0.2, 0.3), (0.0, 1.0, 0.0))


def test_links_that_are_drawn_and_nothing_more_are_known(tmp_path):
    drawn = "<visual><origin xyz='nowhere'/><geometry><teapot/></geometry></visual>"
    text = urdf(
        link("x", SPHERE + drawn),
        link("camera", drawn + drawn),
        link("frame", ""),
        joint("a", "x", "camera"),
        joint("b", "camera", "frame"),
    )
    assert read_urdf(write(tmp_path, text)).drawn_only == ("camera",)


def _box(size):
    return f"<collision><geometry><box size='{size}'/></geometry></collision>"


def test_a_body_that_is_a_point_is_a_placeholder_left_out_and_said(tmp_path):
    ball = "<collision><geometry><sphere radius='0.0'/></geometry></collision>"
    text = urdf(link("x", SPHERE + ball), link("y", _box("0 0 0")), joint("a", "x", "y"))
    robot = read_urdf(write(tmp_path, text))
    assert [shape.link for shape in robot.shapes] == ["x"]
    assert robot.notes == (
        "the <sphere> of link 'x' with radius 0 is left out: a placeholder; --bodies gives the link a body",
        "the <box> of link 'y' with size 0 0 0 is left out: a placeholder; --bodies gives the link a body",
    )


def test_a_body_that_is_flat_is_thin_and_not_left_out(tmp_path):
    disk = "<collision><geometry><cylinder radius='0.2' length='0'/></geometry></collision>"
    robot = read_urdf(write(tmp_path, urdf(link("x", _box("1 0 2") + disk))))
    assert [shape.size for shape in robot.shapes] == [(1.0, 1e-6, 2.0), (0.2, 1e-6)]
    assert [note.partition(" is ")[2] for note in robot.notes] == ["taken as 1e-06 m thick"] * 2


@pytest.mark.parametrize(("inside", "limits", "says"), [
    ("<limit effort='1' velocity='1'/>", (0.0, 0.0), "has no lower and upper limit: 0 by .*, so that it cannot"),
    ("<limit lower='-1' effort='1' velocity='1'/>", (-1.0, 0.0), "has no upper limit: 0 by the specification$"),
])  # fmt: skip
def test_limits_that_are_not_given_are_0_as_the_specification_says(tmp_path, inside, limits, says):
    text = urdf(link("x"), link("y"), joint("a", "x", "y", inside=inside))
    robot = read_urdf(write(tmp_path, text))
    assert (robot.joints[0].lower, robot.joints[0].upper) == limits
    assert re.match(f"joint 'a' {says}", robot.notes[0])


def test_a_robot_whose_joints_cannot_move_is_refused_with_the_reason(tmp_path):
    text = urdf(link("x"), link("y"), joint("a", "x", "y", inside="<limit effort='1' velocity='1'/>"))
    with pytest.raises(InvalidValue, match="no joint that could be planned for; joint 'a' has no lower and upper"):
        load_model(write(tmp_path, text))
    locked = text.replace("<limit ", "<limit lower='0' upper='0' ")
    with pytest.raises(InvalidValue, match="could be planned for; limits that are equal lock a$"):
        load_model(write(tmp_path, locked))


@pytest.mark.parametrize("limit", ["1e6", "1e16"])
def test_a_joint_of_huge_limits_turns_without_end(tmp_path, limit):
    inside = f"<limit lower='-{limit}' upper='{limit}' velocity='1' effort='1'/>"
    path = write(tmp_path, urdf(link("x"), link("y"), joint("a", "x", "y", inside=inside)))
    model = load_model(path)
    assert model.robot.joints[0].kind == "continuous"
    assert model.notes == (f"joint 'a' with the limits -{float(limit):g}, {float(limit):g} turns without end",)
    assert ArmWorld(model.robot, Scene(name="s")).space.wrapping == (True,)
    limited = in_scene(model.robot, Scene(name="s", limits={"a": (-1.0, 2.0)}))
    assert ArmWorld(limited, Scene(name="s")).bounds[:2].tolist() == [[-1.0], [2.0]]


def test_a_slide_of_huge_limits_is_held_until_a_scene_limits_it(tmp_path):
    inside = "<limit lower='-1e6' upper='1e6' velocity='1' effort='1'/>"
    text = urdf(*map(link, "xyz"), joint("a", "x", "y"), joint("b", "y", "z", "prismatic", inside))
    model = load_model(write(tmp_path, text))
    assert model.robot.group == ("a",)
    assert "joint 'b' with the limits -1e+06, 1e+06 slides without end: it is held" in model.notes[0]
    both = load_model(write(tmp_path, text), group="a,b").robot
    assert ArmWorld(in_scene(both, Scene(name="s", limits={"b": (0.0, 0.5)})), Scene(name="s")).space.dim == 2


@pytest.mark.parametrize("text", [
    "\n\n<?xml version='1.0'?>" + two_joints(),
    two_joints().replace("<link", "<sensor:camera><sensor:x/></sensor:camera><link", 1),
    two_joints().replace("<link", "<link xlink:href='somewhere'", 1),
    two_joints() + "\n\0",
    two_joints().replace("<axis xyz='0 1 0'/>", "<axis xyz='0 1 0'/><axis xyz='0 1 0'/>"),
], ids=["blanks first", "a prefix of nobody", "an attribute of nobody", "a zero last", "an axis twice"])  # fmt: skip
def test_xml_is_read_that_other_readers_of_urdfs_take(tmp_path, text):
    assert read_urdf(write(tmp_path, text)).order == ("a", "b")


def test_what_is_drawn_is_the_body_where_that_is_wanted(tmp_path):
    drawn = "<visual><origin xyz='0 0 1'/><geometry><box size='1 2 3'/></geometry></visual>"
    path = write(tmp_path, urdf(link("x", SPHERE + drawn), link("y", drawn), joint("a", "x", "y")))
    model = load_model(path, use_visuals=True)
    assert [(body.link, body.shapes) for body in model.bodies] == [("x", ("sphere",)), ("y", ("box",))]
    assert model.drawn_only == ()
    assert model.notes == ("what is drawn of a link is its body: y",)
    (box,) = [shape for shape in original_shapes(model.file, model.robot) if shape.link == "y"]
    assert (box.size, box.pose.xyz) == ((1.0, 2.0, 3.0), (0.0, 0.0, 1.0))


def test_a_link_s_gltf_is_turned_only_where_that_is_wanted_and_then_as_one_of_a_scene(tmp_path):
    corners = np.array([(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.3)])
    trimesh.Trimesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]).export(tmp_path / "part.glb")
    geometry = "<geometry><mesh filename='part.glb' scale='1 2 3'/></geometry>"
    part = f"<collision><origin xyz='0 0 1' rpy='0 0 {math.pi / 2}'/>{geometry}</collision>"
    path = write(tmp_path, urdf(link("x", part), link("y"), joint("a", "x", "y")))
    # By hand: y up becomes z up, then the scale, then a quarter turn about z, and 1 m up.
    as_it_stands = {(0, 0, 1), (0, 0.1, 1), (-0.4, 0, 1), (0, 0, 1.9)}
    turned = {(0, 0, 1), (0, 0.1, 1), (0, 0, 1.6), (0.6, 0, 1)}
    for upright, expected in ((False, as_it_stands), (True, turned)):
        model = load_model(path, upright_meshes=upright)
        (mesh,) = [shape for shape in original_shapes(model.file, model.robot) if shape.link == "x"]
        found = mesh.pose.apply(mesh.triangles.vertices).round(6) + 0.0
        assert set(map(tuple, found.tolist())) == expected


def test_a_robot_that_is_only_drawn_is_refused_with_what_would_help(tmp_path):
    drawn = "<visual><geometry><box size='1 2 3'/></geometry></visual>"
    path = write(tmp_path, urdf(link("x", drawn), link("y", drawn), joint("a", "x", "y")))
    refused(BrokenFile, "no collision geometry at all: .*--use-visuals takes what is drawn", load_model, path)
    assert len(load_model(path, use_visuals=True).bodies) == 2


def test_a_package_is_where_it_is_said_to_be(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "part.stl").write_bytes(b"")
    file = RobotFile(tmp_path / "arm.urdf", packages=(("parts", str(tmp_path / "elsewhere")),))
    assert find_mesh("package://parts/part.stl", file, "x") == tmp_path / "elsewhere" / "part.stl"
    with pytest.raises(BrokenFile, match="--package parts=FOLDER says where that package is"):
        find_mesh("package://parts/part.stl", RobotFile(tmp_path / "arm.urdf"), "x")


def of(*joints, links="xy", more=""):
    """A robot of these joints, and of links of one letter each."""
    return urdf(*map(link, links), *joints, more)


def a(inside=LIMIT, **changes):
    """A robot of two links and a joint between them."""
    return of(joint("a", "x", "y", inside=inside, **changes))


def shaped(element):
    """A robot of one link with this geometry."""
    return urdf(link("x", f"<collision><geometry>{element}</geometry></collision>"))


AXB, AYB = joint("a", "x", "y"), joint("b", "y", "x")
TWO_ORIGINS = SPHERE.replace("<geometry>", "<origin/><origin xyz='0 0 1'/><geometry>")
MIMIC = LIMIT + "<mimic joint='{}'/>"
FOLLOWS_FIXED = joint("a", "x", "y", "fixed", ""), joint("b", "y", "z", inside=MIMIC.format("a"))
IN_A_CIRCLE = joint("a", "x", "y", inside=MIMIC.format("b")), joint("b", "y", "z", inside=MIMIC.format("a"))
CYCLE = "form a cycle: (a -> b -> a|b -> a -> b)"
BROKEN = {
    # Files and trees.
    "no XML": ("<robot name='a'><link", BrokenFile, "is not XML"),
    "an empty file": ("", BrokenFile, "is empty, not XML"),
    "another kind of XML": ("<sdf/>", BrokenFile, "not a URDF: its outermost element is <sdf>"),
    "no links": (urdf(), BrokenFile, "has no links"),
    "a cycle": (of(AXB, AYB), BrokenFile, CYCLE),
    "a cycle beside the tree": (of(joint("t", "w", "z"), AXB, AYB, links="wxyz"), BrokenFile, CYCLE),
    "a link that hangs on itself": (of(joint("a", "x", "x"), links="x"), BrokenFile, "form a cycle: a -> a"),
    "a loop": (of(AXB, joint("b", "x", "z"), joint("c", "y", "z"), links="xyz"), BrokenFile,
        "link 'z' in .* hangs on two joints, 'b' and 'c'"),
    "two roots": (of(), BrokenFile, "more than one root: no joint leads to 'x', 'y'"),
    "two links of one name": (of(links="xx"), BrokenFile, "more than one link named 'x'"),
    "two joints of one name": (of(AXB, joint("a", "y", "z"), links="xyz"), BrokenFile, "one joint named 'a'"),
    "a child that is not there": (of(joint("a", "x", "ghost"), links="x"), BrokenFile,
        "joint 'a' in .* has the child 'ghost', which is no link; links: x"),
    "no parent": (of(more="<joint name='a' type='fixed'><child link='x'/></joint>", links="x"), BrokenFile,
        "joint 'a' in .* lacks <parent>"),
    "no name": (urdf("<link/>"), BrokenFile, "<link> lacks 'name'"),
    # Joints.
    "no type": (of(more="<joint name='a'><parent link='x'/><child link='y'/></joint>"), BrokenFile,
        "joint 'a' in .*: <joint> lacks 'type'"),
    "a type that is not supported": (a(kind="ball"), UnknownName,
        "type of joint 'a' in .*: 'ball'; known: continuous, fixed, floating, planar, prismatic, revolute"),
    "two origins of a joint": (a(LIMIT + "<origin/>"), BrokenFile, "joint 'a' .*: <joint> has more than one <origin>"),
    "two limits": (a(LIMIT + LIMIT.replace("1", "2")), BrokenFile, "joint 'a' .*: <joint> has more than one <limit>"),
    "no limits": (a(""), BrokenFile,
        "joint 'a' in .* has no limits: a revolute joint needs <limit lower=... upper=...>; one that rotates"),
    "half a limit": (a("<limit lower='1' velocity='1' effort='1'/>"), InvalidValue,
        "lower <= upper, got 1, 0 .upper is not given: 0 by the specification"),
    "limits the wrong way round": (a("<limit lower='1' upper='-1'/>"), InvalidValue,
        "limits of joint 'a' in .* must satisfy lower <= upper, got 1, -1"),
    "a limit that is no number": (a("<limit lower='low' upper='1'/>"), InvalidValue,
        "joint 'a' in .*: lower of <limit> must be a finite number, got 'low'"),
    "a limit that is not finite": (a("<limit lower='nan' upper='1'/>"), InvalidValue, "got 'nan'"),
    "a negative velocity": (a("<limit lower='0' upper='1' velocity='-1'/>"), InvalidValue,
        "velocity limit of joint 'a' in .* must be >= 0, got -1"),
    "an axis of zero": (a(axis="0 0 0"), InvalidValue, "axis of joint 'a' in .* must not be zero"),
    "an origin of two numbers": (a(xyz="0 1"), InvalidValue,
        "joint 'a' in .*: xyz of <origin> must be 3 finite numbers, got '0 1'"),
    "a mimic of nobody": (a(MIMIC.format("b")), BrokenFile, "joint 'a' in .* mimics 'b', which is no joint"),
    "a mimic of a joint that does not move": (of(*FOLLOWS_FIXED, links="xyz"), BrokenFile,
        "joint 'b' in .* mimics 'a', which is fixed"),
    "mimics in a circle": (of(*IN_A_CIRCLE, links="xyz"), BrokenFile, "mimic each other in a circle: a -> b -> a"),
    # Bodies.
    "two origins of a body": (urdf(link("x", TWO_ORIGINS)), BrokenFile,
        "link 'x' in .*: <collision> has more than one <origin>"),
    "a number as only Python writes it": (shaped("<sphere radius='1_0'/>"), InvalidValue,
        "link 'x' in .*: radius of <sphere> must be a finite number, got '1_0'"),
    "geometry that is missing": (urdf(link("x", "<collision/>")), BrokenFile,
        "link 'x' in .*: the geometry of a <collision> is empty"),
    "geometry that is empty": (urdf(link("x", "<collision><geometry/></collision>")), BrokenFile,
        "the geometry of a <collision> is empty; it must be one of box, sphere"),
    "an unknown shape": (shaped("<cone/>"), BrokenFile, "has <cone>; it must be one of"),
    "a sphere without radius": (shaped("<sphere/>"), BrokenFile, "link 'x' in .*: <sphere> lacks 'radius'"),
    "a box turned inside out": (shaped("<box size='1 -1 1'/>"), InvalidValue, "<box> must be >= 0, got '1 -1 1'"),
    "a mesh that is missing": (shaped("<mesh filename='no.stl'/>"), BrokenFile,
        "the mesh 'no.stl' of link 'x' in .* is missing; looked for .*no.stl"),
    "a mesh without a file name": (shaped("<mesh/>"), BrokenFile, "<mesh> lacks 'filename'"),
    "a mesh in pieces": (shaped("<mesh filename='a.GLTF'/>"), BrokenFile,
        "link 'x' in .*: 'a.GLTF' has its triangles in other files; make a .glb of it"),
    "a mesh scaled to a point": (shaped("<mesh filename='a.stl' scale='0 0 0'/>"), InvalidValue,
        "link 'x' in .*: scale of <mesh> must not be 0, got '0 0 0'"),
    "a mesh scaled flat": (shaped("<mesh filename='a.stl' scale='1 -1 -0.0'/>"), InvalidValue, "got '1 -1 -0.0'"),
    "a mesh scaled by one 0": (shaped("<mesh filename='a.stl' scale='0'/>"), InvalidValue, "must not be 0, got '0'"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_broken_is_named_in_one_line(case, tmp_path):
    text, kind, says = BROKEN[case]
    with pytest.raises(EvenroadError, match=says) as caught:
        read_urdf(write(tmp_path, text))
    assert isinstance(caught.value, kind)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_missing_is_named(tmp_path):
    refused(BrokenFile, "cannot read the robot .*nowhere.urdf: No such file", read_urdf, tmp_path / "nowhere.urdf")


@pytest.mark.parametrize(("name", "place"), [
    ("part.stl", "my_robot/urdf/part.stl"), ("../meshes/part.stl", "my_robot/meshes/part.stl"),
    ("package://my_robot/meshes/part.stl", "my_robot/meshes/part.stl"),
    ("package://other/part.stl", "other/part.stl"), ("package://in_ros/part.stl", "ros/in_ros/part.stl"),
    ("package://my%20own/part.stl", "my own/part.stl"), ("file://{}/far/part.stl", "far/part.stl"),
])  # fmt: skip
def test_meshes_are_found_where_urdfs_and_ros_put_them(tmp_path, monkeypatch, name, place):
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    (tmp_path / "my_robot" / "urdf").mkdir(parents=True)
    (tmp_path / "my_robot" / "meshes").mkdir()
    (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / place).write_bytes(b"")
    found = find_mesh(name.format(tmp_path), RobotFile(tmp_path / "my_robot" / "urdf" / "arm.urdf"), "x")
    assert found.resolve() == (tmp_path / place).resolve()
