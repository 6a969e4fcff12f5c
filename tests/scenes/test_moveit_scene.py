import numpy as np
import pytest

from evenroad.errors import BrokenFile, EvenroadError, InvalidValue, UnknownName
from evenroad.geometry import Pose
from evenroad.robot import load_scene
from evenroad.scenes.scene_file import is_scene
from tests.robots.urdf_texts import write

OLD = """(noname)
* my table
1
box
1 2 0.1
0.5 0 -0.05
0 0 0.7071067811865476 0.7071067811865476
0 0 0 0
* can
2
cylinder
0.05 0.2
0 0 0.1
0 0 0 1
1 0 0 1
sphere
0.03
0 0 0.3
0 0 0 1
1 0 0 1
.
"""
NEW = """kitchen
* shelf
1 0 0
0 0 0.7071067811865476 0.7071067811865476
1
box
1 2 3
0 1 0
0 0 0 1
0 0 0 0
1
handle
0 0 0
0 0 0 1
.
"""
YAML = """
name: bench
world:
  collision_objects:
    - id: Can1
      primitives: [{type: cylinder, dimensions: [0.2, 0.05]}]
      primitive_poses: [{position: [1, 2, 3], orientation: [0, 0, 1, 1]}]
    - id: shelf
      pose: {position: {x: 1}, orientation: {z: 1, w: 1}}
      primitives:
        - {type: 1, dimensions: [1, 2, 3]}
        - {type: SPHERE, dimensions: [0.1]}
      primitive_poses:
        - {position: {x: 0, y: 1, z: 0}, orientation: {x: 0, y: 0, z: 0, w: 1}}
        - {position: [0, 0, 1], orientation: [0, 0, 0, 1]}
"""


def test_an_older_scene_file_has_objects_without_a_pose(tmp_path):
    path = write(tmp_path, OLD, "table.scene")
    assert is_scene(path)
    scene = load_scene(path)
    table, can, lid = scene.obstacles
    assert scene.name == "(noname)"
    assert [each.name for each in scene.obstacles] == ["my table", "can/0", "can/1"]
    assert (table.shape, table.size, table.xyz) == ("box", (1, 2, 0.1), (0.5, 0, -0.05))
    np.testing.assert_allclose(np.reshape(table.rotation, (3, 3)), [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)
    assert (can.shape, can.size, can.xyz) == ("cylinder", (0.05, 0.2), (0, 0, 0.1))
    assert (lid.shape, lid.size, lid.xyz) == ("sphere", (0.03,), (0, 0, 0.3))


def test_a_newer_scene_file_has_shapes_in_the_objects_frame_and_subframes(tmp_path):
    (shelf,) = load_scene(write(tmp_path, NEW, "kitchen.scene")).obstacles
    np.testing.assert_allclose(shelf.xyz, (0, 0, 0), atol=1e-15)
    np.testing.assert_allclose(np.reshape(shelf.rotation, (3, 3))[:, 0], (0, 1, 0), atol=1e-15)


def test_a_planning_scene_has_quaternions_with_w_last_and_cylinders_with_their_height_first(tmp_path):
    path = write(tmp_path, YAML, "scene0001.yaml")
    assert is_scene(path)
    scene = load_scene(path)
    can, shelf, ball = scene.obstacles
    assert (scene.name, can.name, shelf.name, ball.name) == ("bench", "Can1", "shelf/0", "shelf/1")
    assert (can.shape, can.size) == ("cylinder", (0.05, 0.2))
    quarter = Pose.from_quaternion((1, 2, 3), xyzw=(0, 0, 1, 1))
    assert can.body.pose == quarter
    np.testing.assert_allclose(shelf.xyz, (0, 0, 0), atol=1e-15)
    assert (ball.shape, ball.size) == ("sphere", (0.1,))
    np.testing.assert_allclose(ball.xyz, (1, 0, 1))


def _yaml(text):
    return f"world:\n  collision_objects:\n    - {{{text}}}\n"


POSE = "primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]"
BROKEN = {
    "an end that is missing": ("a.scene", OLD[:-2], BrokenFile, "ends where '\\*' or '.' must be"),
    "an end in a shape": ("a.scene", NEW[:40], BrokenFile, "ends where a number must be"),
    "nothing": ("a.scene", "", BrokenFile, "ends where"),
    "a word for a number": ("a.scene", OLD.replace("0.5 0 -0.05", "0.5 zero 0"), BrokenFile, "0.5 zero 0"),
    "a number that is not finite": ("a.scene", OLD.replace("0.5 0", "nan 0"), InvalidValue, "xyz .* finite"),
    "a negative size": ("a.scene", OLD.replace("1 2 0.1", "1 -2 0.1"), InvalidValue, "'my table' in .* > 0, got -2"),
    "a quaternion of zeros": ("a.scene", OLD.replace("0 0 0 1\n", "0 0 0 0\n", 1), InvalidValue, "norm > 0"),
    "a cone": ("a.scene", OLD.replace("box", "cone"), UnknownName, "'my table' in .*'cone'; known: box, cyl"),
    "a mesh": ("a.scene", OLD.replace("box", "mesh"), UnknownName, "'my table' in .*'mesh'; known: box, cyl"),
    "shapes without a number": ("a.scene", OLD.replace("\n2\n", "\ntwo\n"), BrokenFile, "number of shapes, got 'two'"),
    "no object": ("a.yaml", "world: 3", BrokenFile, "'world' in .* got 3"),
    "no id": ("a.yaml", _yaml("primitives: []"), BrokenFile, "must have an 'id'"),
    "a mesh in YAML": ("a.yaml", _yaml(f"id: cup, meshes: [{{resource: a.stl}}], mesh{POSE[9:]}"), InvalidValue,
        "mesh of object 'cup' .* must have vertices"),
    "a cone in YAML": ("a.yaml", _yaml(f"id: hat, primitives: [{{type: 4, dimensions: [1, 1]}}], {POSE}"),
        UnknownName, "'hat' .*'cone'"),
    "too few dimensions": ("a.yaml", _yaml(f"id: a, primitives: [{{type: box, dimensions: [1]}}], {POSE}"),
        InvalidValue, "dimensions of object 'a'"),
    "no pose": ("a.yaml", _yaml("id: a, primitives: [{type: box, dimensions: [1, 1, 1]}]"), BrokenFile, "1 and 0"),
}  # fmt: skip


@pytest.mark.parametrize("case", BROKEN)
def test_what_is_wrong_in_a_scene_of_moveits_is_named_in_one_line(case, tmp_path):
    name, text, kind, says = BROKEN[case]
    with pytest.raises(EvenroadError, match=says) as caught:
        load_scene(write(tmp_path, text, name))
    assert isinstance(caught.value, kind)
    assert "\n" not in str(caught.value)


def test_two_objects_of_one_name_are_no_scene(tmp_path):
    body = NEW[NEW.index("*") :]
    with pytest.raises(InvalidValue, match=r"twice: \['shelf'\]"):
        load_scene(write(tmp_path, NEW.rstrip(".\n") + "\n" + body, "a.scene"))


CUP = (
    "id: cup, pose: {position: [1, 0, 0], orientation: [0, 0, 0, 1]}, meshes: [{vertices: [[0, 0, 0],"
    " {x: 1, y: 0, z: 0}, [0, 1, 0]], triangles: [{vertex_indices: [0, 1, 2]}]}], mesh_poses: [{position:"
    " [0, 2, 0], orientation: [0, 0, 0, 1]}]"
)


def test_a_planning_scene_has_meshes(tmp_path):
    (tmp_path / "a.yaml").write_text(_yaml(CUP))
    (cup,) = load_scene(tmp_path / "a.yaml").obstacles
    assert (cup.name, cup.shape) == ("cup", "mesh")
    assert cup.body.pose.xyz == (1, 2, 0)
    np.testing.assert_array_equal(cup.body.triangles.vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize(("old", "new", "says"), [
    ("[0, 1, 2]}", "[0, 1, 9]}", "name rows"),
    ("[0, 1, 2]}", "[0, 1, 1.7]}", "mesh of object 'cup' .* must have whole vertex_indices, got 1.7"),
    ("triangles: [{vertex_indices: [0, 1, 2]}]", "triangles: []", "one triangle or more"),
    ("[0, 1, 0]]", "[0, 1]]", "a vertex of a mesh of object 'cup'"),
    ("mesh_poses: [{", "mesh_poses: [], subframe_poses: [{", "a pose for each (mesh|subframe), got [01] and [01]"),
])  # fmt: skip
def test_a_mesh_of_a_planning_scene_that_is_none_is_refused(tmp_path, old, new, says):
    text = _yaml(CUP)
    assert old in text
    (tmp_path / "a.yaml").write_text(text.replace(old, new))
    with pytest.raises(EvenroadError, match=says):
        load_scene(tmp_path / "a.yaml")
