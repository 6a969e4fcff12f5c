from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import Pose
from evenroad.geometry.rotation import rotation_from_rpy
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, PointCloud, Sphere
from evenroad.robot import ArmWorld, Obstacle, Scene, load_robot, load_scene
from evenroad.scenes.scene_file import SCENES, is_scene
from tests.refused import refused
from tests.robots.urdf_texts import write

GOOD = """
name: cell
obstacles:
  table: {shape: box, size: [1, 2, 0.1], xyz: [0, 0, -0.05], rpy: [0, 0, 0.3], cell: true}
  ball: {shape: sphere, radius: 0.1, xyz: [0.5, 0, 0.5]}
  post: {shape: cylinder, radius: 0.05, length: 1.0}
  pipe: {shape: capsule, radius: 0.02, length: 0.4, rpy: [1.0, 0, 0]}
allowed:
  table: [base_link]
states:
  home: {elbow_joint: 0.5, shoulder_pan_joint: -1}
limits:
  elbow_joint: [-1, 2.5]
"""


def test_everything_in_a_scene_is_read(tmp_path):
    scene = load_scene(write(tmp_path, GOOD, "a.yaml"))
    table, ball, post, pipe = scene.obstacles
    assert (table.name, table.shape, table.size) == ("table", "box", (1, 2, 0.1))
    assert (table.xyz, table.cell) == ((0, 0, -0.05), True)
    assert table.rotation == rotation_from_rpy(0, 0, 0.3)
    assert (ball.shape, ball.size, ball.xyz, ball.cell) == ("sphere", (0.1,), (0.5, 0, 0.5), False)
    assert (post.shape, post.size, post.xyz) == ("cylinder", (0.05, 1.0), (0, 0, 0))
    assert pipe.rotation == rotation_from_rpy(1.0, 0, 0)
    assert scene.name == "cell"
    assert scene.allowed == {("base_link", "table")}
    assert scene.states == {"home": {"elbow_joint": 0.5, "shoulder_pan_joint": -1.0}}
    assert scene.limits == {"elbow_joint": (-1.0, 2.5)}


def test_a_scene_without_a_name_has_that_of_its_file_and_may_be_empty(tmp_path):
    scene = load_scene(write(tmp_path, "obstacles: {}\n", "empty.yaml"))
    assert (scene.name, scene.obstacles, scene.states, scene.limits) == ("empty", (), {}, {})


def test_a_scene_is_told_from_a_map(tmp_path):
    assert is_scene(write(tmp_path, GOOD, "a.yaml"))
    assert is_scene("box-reach.yaml")
    assert not is_scene(write(tmp_path, "image: a.png\n", "map.yaml"))
    assert not is_scene(tmp_path / "none.yaml")


def a(entry):
    """A scene of one obstacle."""
    return f"obstacles: {{a: {{{entry}}}}}"


BROKEN = {
    "an unknown key": (GOOD + "colour: red\n", UnknownName,
        "key of the scene .*'colour'; known: allowed, attach, limits, name, obstacles, states"),
    "an unknown key of an obstacle": (a("shape: sphere, radius: 1, size: 2"), UnknownName,
        "key of obstacle 'a' in .*'size'; known: cell, clearance, radius, rpy, shape, xyz, xyzw"),
    "an unknown shape": (a("shape: cone"), UnknownName,
        "shape of obstacle 'a' in .*'cone'; known: box, capsule, cloud, cylinder, height_map, mesh, plane, sphere"),
    "a shape that is no name": (a("shape: [box]"), UnknownName, r"shape of obstacle 'a' in .*\['box'\]; known: box"),
    "two obstacles of one name": (
        "obstacles:\n  wall: {shape: sphere, radius: 1}\n  wall: {shape: sphere, radius: 2}\n",
        BrokenFile,
        "a.yaml has the key 'wall' twice, in lines 2 and 3",
    ),
    "two obstacles of one name, as a number and as text": (
        "obstacles:\n  1: {shape: sphere, radius: 1}\n\n  '1': {shape: sphere, radius: 2}\n",
        BrokenFile,
        "has the key '1' twice, in lines 2 and 4",
    ),
    "keys that are one to Python": ("obstacles:\n  true: {shape: sphere, radius: 1}\n  1: {shape: sphere, radius: 2}\n",
        BrokenFile, "has the key '1' twice, in lines 2 and 3"),
    "nested too deep": ("a: " + 100_000 * "[", BrokenFile, "nested more than 100 levels deep"),
    "a tag that does not fit": ("obstacles: !!bool q", BrokenFile, "is not YAML"),
    "a section given twice": (GOOD + "states: {}\n", BrokenFile, "has the key 'states' twice"),
    "a size given twice": (a("shape: sphere, radius: 1, radius: 0.1"), BrokenFile,
        "has the key 'radius' twice, in lines 1 and 1"),
    "a number of 400 digits": (f"obstacles: {{a: {{shape: sphere, radius: 1{'0' * 400}}}}}", InvalidValue,
        "radius of obstacle 'a' in .* must be a finite number"),
    "no shape": (a("radius: 1"), BrokenFile, "obstacle 'a' in .* lacks its shape, one of box, capsule, "),
    "a half space": (a("shape: half_space"), UnknownName, "'half_space'; shape: plane is all that is below"),
    "a hull": (a("shape: hull"), UnknownName, "'hull'; shape: mesh with convex: true is the hull of a file"),
    "no obstacles": ("states: {}", BrokenFile, "the scene .* lacks obstacles"),
    "a length that is missing": (a("shape: cylinder, radius: 1"), BrokenFile, "obstacle 'a' in .* lacks length"),
    "a mesh that there is not": (a("shape: mesh, file: no.stl"), BrokenFile, "no.stl of obstacle 'a' in .* is missing"),
    "a key that nothing held has": (
        "obstacles: {}\nattach: {a: {shape: sphere, radius: 1, link: b, touch: [c]}}", UnknownName,
        "key of attached 'a' in .*: 'touch'; .*did you mean 'touches'"),
    "a clearance of what is held": (
        "obstacles: {}\nattach: {a: {shape: sphere, radius: 1, link: b, clearance: 1}}", UnknownName,
        "key of attached 'a' in .*: 'clearance'; known: "),
    "a size of two numbers": (a("shape: box, size: [1, 2]"), InvalidValue,
        r"size of obstacle 'a' in .* 3 finite numbers, got \[1, 2\]"),
    "a size of zero": (a("shape: box, size: [1, 0, 1]"), InvalidValue, "size of obstacle 'a' .* > 0, got 0.0"),
    "a place that is not finite": (a("shape: sphere, radius: 1, xyz: [.nan, 0, 0]"), InvalidValue,
        "xyz of obstacle 'a'"),
    "a number as text": (a("shape: sphere, radius: 1e-1"), InvalidValue, "got '1e-1' .*decimal point"),
    "a cell that is no bool": (a("shape: sphere, radius: 1, cell: 2"), InvalidValue,
        "cell of obstacle 'a' .* true or false, got 2"),
    "an obstacle that is no mapping": ("obstacles: {a: 3}", BrokenFile,
        "obstacle 'a' in .* 'key: value' entries, got 3"),
    "a contact with nothing": ("obstacles: {}\nallowed: {a: [b]}", UnknownName, "obstacle in 'allowed' of .*'a'"),
    "a contact that is no list": ("obstacles: {a: {shape: sphere, radius: 1}}\nallowed: {a: b}", InvalidValue,
        "must be a list of links, got 'b'"),
    "a state that is no number": ("obstacles: {}\nstates: {home: {a: b}}", InvalidValue,
        "joint 'a' of state 'home' in .* a finite number, got 'b'"),
    "limits the wrong way round": ("obstacles: {}\nlimits: {a: [2, 1]}", InvalidValue,
        "limits of joint 'a' in .* lower < upper"),
    "no YAML": ("a: [", BrokenFile, "is not YAML"),
    "a list": ("- a", BrokenFile, "is not a scene"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_wrong_in_a_scene_is_named_in_one_line(case, tmp_path):
    text, kind, says = BROKEN[case]
    with pytest.raises(EvenroadError, match=says) as caught:
        load_scene(write(tmp_path, text, "a.yaml"))
    assert isinstance(caught.value, kind)
    assert "\n" not in str(caught.value)


def test_what_is_merged_into_an_obstacle_may_be_said_again(tmp_path):
    text = (
        "obstacles:\n  a: &first {shape: sphere, radius: 1, cell: true}\n"
        "  b: &second\n    <<: *first\n    radius: 2\n"
        "  c: {<<: [*second, *first], xyz: [1, 0, 0]}\n"
    )
    a, b, c = load_scene(write(tmp_path, text, "a.yaml")).obstacles
    assert [(each.size, each.cell) for each in (a, b, c)] == [((1,), True), ((2,), True), ((2,), True)]


def test_a_file_goes_before_a_shipped_scene_and_a_missing_one_gets_their_list(tmp_path, monkeypatch):
    with pytest.raises(BrokenFile, match=r"no scene file nowhere.yaml; shipped: box-reach.yaml, box-reach-narr"):
        load_scene("nowhere.yaml")
    monkeypatch.chdir(tmp_path)
    assert load_scene("box-reach.yaml") == load_scene("box-reach")
    write(tmp_path, "obstacles: {}\n", "box-reach.yaml")
    assert load_scene("box-reach.yaml").obstacles == ()


@pytest.mark.parametrize(("name", "width", "centre"), [("box-reach", 0.36, 0.191), ("box-reach-narrow", 0.30, 0.161)])
def test_the_shipped_box_leaves_the_cavity_that_its_numbers_say(name, width, centre):
    """Just inside of the cavity's faces is no obstacle, just outside is; the front is open."""
    obstacles = [each for each in load_scene(name).obstacles if each.name != "table"]

    def taken(point):
        return any((np.abs(np.array(point) - each.xyz) <= np.array(each.size) / 2).all() for each in obstacles)

    middle = np.array([0.70, 0.0, centre])
    half = np.array([0.20, width / 2, width / 2])
    for axis in range(3):
        for side in (-1, 1):
            face = middle.copy()
            face[axis] += side * half[axis]
            step = np.eye(3)[axis] * side * 1e-4
            assert not taken(face - step)
            assert taken(face + step) == (axis != 0 or side == 1)
            assert not taken(face + step * 101) or (axis == 0 and side == -1)
    assert min(each.xyz[2] - each.size[2] / 2 for each in obstacles) == pytest.approx(0.001)


@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("box")])
def test_start_and_goal_of_the_shipped_scenes_are_free_and_the_way_between_is_not(name):
    robot, scene = load_robot("ur5"), load_scene(name)
    world = ArmWorld(robot, scene)
    home, inside = ([[scene.states[state][joint] for joint in robot.group]] for state in ("home", "inside"))
    assert world.valid(np.array(home + inside)).all()
    assert not world.motion_valid(np.array(home), np.array(inside))[0]


BALL = Obstacle("ball", Sphere(0.1))
QUARTER = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]


def test_a_scene_with_and_without_an_obstacle_is_another_scene():
    scene = Scene((BALL,), name="s", allowed=frozenset({("base", "ball")}), states={"home": {"a": 1.0}})
    wall = Obstacle("wall", Box((1, 1, 0.1)), cell=True)
    both = scene.with_(wall, allowed=[("base", "wall")])
    assert both.obstacles == (BALL, wall)
    assert both.allowed == {("base", "ball"), ("base", "wall")}
    assert both.without("wall") == scene
    assert both.without("wall", "ball") == Scene(name="s", states=scene.states)
    refused(InvalidValue, r"twice: \['ball'\]", scene.with_, BALL)
    refused(UnknownName, "obstacle of scene 's': 'table'; known: ball", scene.without, "table")


@pytest.mark.parametrize("pose", [
    Pose.from_matrix(QUARTER),
    Pose.from_quaternion((1, 2, 3), xyzw=(0, 0, 1, 1)),
    Pose.from_rpy((1, 2, 3), (0, 0, np.pi / 2)),
], ids=["matrix", "quaternion", "rpy"])  # fmt: skip
def test_an_obstacle_takes_its_pose_as_people_have_it(pose):
    post = Obstacle("post", Cylinder(0.1, 2.0)).at(pose)
    assert post.xyz == (1, 2, 3)
    np.testing.assert_allclose(np.reshape(post.rotation, (3, 3)), np.array(QUARTER)[:3, :3], atol=1e-15)


def test_a_quaternion_in_a_file_has_w_last_and_stands_in_the_place_of_rpy(tmp_path):
    text = "obstacles: {a: {shape: box, size: [1, 2, 3], xyzw: [0, 0, 1, 1]%s}}"
    (a,) = load_scene(write(tmp_path, text % "", "a.yaml")).obstacles
    np.testing.assert_allclose(a.rotation, rotation_from_rpy(0, 0, np.pi / 2), atol=1e-15)
    with pytest.raises(InvalidValue, match="obstacle 'a' in .* must have one of rpy and xyzw"):
        load_scene(write(tmp_path, text % ", rpy: [0, 0, 1]", "a.yaml"))
    with pytest.raises(UnknownName, match=r"obstacle 'a' in .* as xyzw: \[x, y, z, w\], in this order"):
        load_scene(write(tmp_path, text.replace("xyzw", "quaternion") % "", "a.yaml"))


def test_a_capsule_as_an_obstacle_is_along_z_whatever_its_ends():
    pipe = Obstacle("pipe", Capsule((1, 0, 0), (3, 0, 0), 0.1))
    assert (pipe.shape, pipe.size, pipe.xyz) == ("capsule", (0.1, 2.0), (2, 0, 0))
    np.testing.assert_allclose(np.reshape(pipe.rotation, (3, 3))[:, 2], (1, 0, 0), atol=1e-15)
    assert Obstacle("ball", Capsule((1, 0, 0), (1, 0, 0), 0.1)).shape == "sphere"


@pytest.mark.parametrize(("make", "error", "says"), [
    (lambda: Obstacle.of("x", "cone", (1.0,)), UnknownName, "box, capsule, cylinder, sphere"),
    (lambda: Obstacle.of("x", "box", (1.0, 1.0)), InvalidValue, "obstacle 'x': a box must have 3"),
    (lambda: Obstacle.of("x", "sphere", (-1.0,)), InvalidValue, "obstacle 'x': .* > 0, got -1"),
    (lambda: Obstacle.of("x", "sphere", (1.0,), (0, np.inf, 0)), InvalidValue, "'x': xyz .*inf"),
    (lambda: Obstacle.of("x", "sphere", (1.0,), (0, 0, 0), (2.0,) * 9), InvalidValue, "'x': rotation"),
    (lambda: Obstacle("x", PointCloud(np.zeros((1, 3)), 0.0)), InvalidValue,
        "radius of a cloud must be a finite number > 0"),
    (lambda: Obstacle("x", Mesh("part.stl")), BrokenFile, "mesh part.stl is missing"),
    (lambda: Obstacle("x", "box"), InvalidValue, "cylinder, capsule, cloud, mesh, got a box"),
    (lambda: Obstacle("x", Sphere(1.0, link="hand")), InvalidValue, "not to a link, got 'hand'"),
])  # fmt: skip
def test_an_obstacle_that_is_not_sound_is_refused(make, error, says):
    with pytest.raises(error, match=says) as caught:
        make()
    assert "\n" not in str(caught.value)


TABLE = Box((0.8, 1.2, 0.04), xyz=(0.5, 0, -0.02), name="table")


def test_a_scene_is_made_of_shapes_which_get_names_where_they_have_none():
    scene = Scene([TABLE, Sphere(0.1), Box((1, 1, 1)), Sphere(0.2), Box((2, 1, 1), name="box 0")])
    assert [each.name for each in scene.obstacles] == ["table", "sphere 0", "box 1", "sphere 1", "box 0"]
    assert scene.obstacles[0] == Obstacle("table", TABLE)
    more = scene.with_(Box((3, 1, 1))).with_([Box((4, 1, 1)), Obstacle("o", TABLE)])
    assert [each.name for each in more.obstacles[5:]] == ["box 2", "box 3", "o"]


def test_a_scene_is_made_of_shapes_of_obstacles_or_of_a_mapping():
    obstacle, allowed = Obstacle("table", TABLE), frozenset([("base_link", "table")])
    scenes = [
        Scene((obstacle,), name="cell", allowed=allowed),
        Scene([TABLE], name="cell", allowed=allowed),
        Scene(obstacles=(obstacle,), name="cell", allowed=allowed),
        Scene({"name": "cell", "obstacles": MAPPING, "allowed": {"table": ["base_link"]}}),
        Scene({"obstacles": [LISTED], "allowed": {"table": ["base_link"]}}, name="cell"),
    ]
    assert all(each == scenes[0] and each.fingerprint() == scenes[0].fingerprint() for each in scenes)
    assert replace(scenes[0], limits={"a": (0, 1)}).obstacles == scenes[0].obstacles
    assert Scene().obstacles == Scene([]).obstacles == Scene(name="nothing").obstacles == ()


MAPPING = {"table": {"shape": "box", "size": (0.8, 1.2, 0.04), "xyz": np.array([0.5, 0, -0.02])}}
LISTED = {"name": "table", "box": {"size": (0.8, 1.2, 0.04)}, "xyz": [0.5, 0, -0.02]}
BALLS = {"obstacles": [{"sphere": 0.1}, {"shape": "sphere", "radius": 0.1, "xyz": [1, 0, 0]}]}


def test_obstacles_of_a_list_without_names_get_one_and_two_scenes_share_nothing():
    assert [each.name for each in Scene(BALLS).obstacles] == ["sphere 0", "sphere 1"]
    twice = {"obstacles": [LISTED, LISTED]}
    refused(InvalidValue, "of their own, twice: 'table'", Scene, twice)
    first, second = Scene([TABLE]), Scene([TABLE])
    first.states["home"] = {}
    assert second.states == {}


def test_a_planning_scene_of_moveit_is_a_scene_without_a_file():
    box = {"type": "box", "dimensions": [0.8, 1.2, 0.04]}
    pose = {"position": [0.5, 0, -0.02], "orientation": [0, 0, 0, 1]}
    scene = Scene({"world": {"collision_objects": [{"id": "table", "primitives": [box], "primitive_poses": [pose]}]}})
    assert scene.obstacles == Scene([TABLE]).obstacles


def test_capsules_meshes_and_scenes_are_made_of_what_people_have_and_show_themselves_in_one_line():
    assert Capsule(0.1, 0.4) == Capsule(radius=0.1, length=0.4) == Capsule((0, 0, -0.2), (0, 0, 0.2), 0.1)
    vertices, triangles = np.eye(3), [[0, 1, 2]]
    theirs = SimpleNamespace(vertices=vertices, faces=triangles)
    for mesh in (Mesh((vertices, triangles), scale=2), Mesh(theirs, 2, name="m")):
        assert mesh.triangles == TriangleMesh(2 * vertices, triangles)
    assert repr(TABLE) == "Box((0.8, 1.2, 0.04), pose=Pose((0.5, 0, -0.02)), name='table')"
    assert repr(Sphere(0.1)) == "Sphere(radius=0.1)"
    assert repr(Scene([TABLE])) == "Scene('scene', 1 obstacle: table)"
    assert repr(PointCloud(np.zeros((9, 3)), 0.1)) == "PointCloud(9 points, radius=0.1)"


def test_boxes_given_as_arrays_are_the_boxes_that_objects_make():
    rng = np.random.default_rng(5)
    size, xyz, xyzw = rng.uniform(0.05, 0.3, (9, 3)), rng.uniform(-0.8, 0.8, (9, 3)), rng.normal(size=(9, 4))
    objects = [Box(*each, xyz=place) for each, place in zip(size[:, None], xyz, strict=True)]
    assert Scene.of_boxes(size, xyz) == Scene(objects)
    turned = Scene.of_boxes(size, xyz, xyzw=xyzw, names=[f"b{i}" for i in range(9)], allowed={("base_link", "b3")})
    for i, each in enumerate(turned.obstacles):
        assert each.name == f"b{i}"
        assert each.size == tuple(size[i])
        np.testing.assert_allclose(each.rotation, Pose(xyzw=xyzw[i]).rotation, atol=1e-15)
    for listed in (xyzw.tolist(), xyzw * 1e150):  # what compiled code leaves to NumPy
        np.testing.assert_allclose(Scene.of_boxes(size, xyz, xyzw=listed).rows, turned.rows, atol=1e-15)
    again = Scene(turned.obstacles, allowed=turned.allowed)
    assert turned.fingerprint() == again.fingerprint()
    robot = load_robot("ur5")
    q = ArmWorld(robot, turned).space.from_cube(rng.random((2000, 6)))
    assert 0 < np.count_nonzero(ArmWorld(robot, turned).valid(q)) < 2000
    np.testing.assert_array_equal(ArmWorld(robot, turned).valid(q), ArmWorld(robot, again).valid(q))


@pytest.mark.parametrize(
    ("says", "arrays", "more"),
    [
        (r"size must have shape \(n, 3\)", ([1.0, 1.0, 1.0], [(0, 0, 0)]), {}),
        ("one row a box, got 1 and 2", ([(1, 1, 1)], [(0, 0, 0), (1, 1, 1)]), {}),
        ("size must be > 0", ([(1, 0, 1)], [(0, 0, 0)]), {}),
        ("xyz must be finite", ([(1, 1, 1)], [(0, np.nan, 0)]), {}),
        ("xyz must lie between", ([(1, 1, 1)], [(0, -1e12, 0)]), {}),
        ("one quaternion a box", ([(1, 1, 1)], [(0, 0, 0)]), {"xyzw": [(0, 0, 0, 0)]}),
        ("one quaternion a box", (np.ones((2, 3)), np.ones((2, 3))), {"xyzw": np.ones((1, 4))}),
        ("size must be > 0", (-np.ones((2, 3)), np.ones((2, 3))), {}),
        ("names must be 1", ([(1, 1, 1)], [(0, 0, 0)]), {"names": ["a", "b"]}),
        ("twice: .'a'", ([(1, 1, 1)] * 2, [(0, 0, 0)] * 2), {"names": ["a", "a"]}),
    ],
)
def test_boxes_given_as_arrays_are_refused_where_they_are_none(says, arrays, more):
    refused(InvalidValue, says, Scene.of_boxes, *arrays, **more)
