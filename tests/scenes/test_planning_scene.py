"""MoveIt's planning scenes in YAML: what is honoured, and that nothing in one is dropped without a word."""

import copy

import pytest

import evenroad as er
from evenroad.errors import EvenroadError, InvalidValue, UnknownName
from evenroad.robot import in_scene
from tests.scenes.planning_scenes import IDENTITY, at, box, places, scene_of

FULL = {
    "name": "bench",
    "robot_model_name": "ur5",
    "is_diff": False,
    "object_colors": [{"id": "can", "color": {"r": 1.0}}],
    "fixed_frame_transforms": [
        {
            "header": {"frame_id": "base_link"},
            "child_frame_id": "table_frame",
            "transform": {"translation": {"x": 1.0, "y": 0.0, "z": 0.0}, "rotation": IDENTITY["orientation"]},
        }
    ],
    "link_padding": [{"link_name": "wrist_3_link", "padding": 0.0}],
    "link_scale": [{"link_name": "wrist_3_link", "scale": 1.0}],
    "allowed_collision_matrix": {
        "entry_names": ["base_link", "can"],
        "entry_values": [{"enabled": [False, True]}, {"enabled": [True, False]}],
        "default_entry_names": [],
        "default_entry_values": [],
    },
    "robot_state": {
        "joint_state": {"header": {"frame_id": ""}, "name": ["elbow_joint"], "position": [0.1], "velocity": []},
        "multi_dof_joint_state": {
            "joint_names": ["base"],
            "transforms": [{"translation": {"x": 0.0, "y": 0.0, "z": 0.0}, "rotation": IDENTITY["orientation"]}],
        },
        "attached_collision_objects": [
            {"link_name": "tool0", "object": box("crate", at(0.0, 0.0, 0.1), "tool0"), "touch_links": ["wrist_3_link"]}
        ],
    },
    "world": {
        "collision_objects": [
            box("can", at(0.5), subframe_names=["lid"], subframe_poses=[at(0.0, 0.0, 0.2)]),
            {
                "id": "flag",
                "header": {"frame_id": "base_link"},
                "meshes": [{"vertices": [[0, 0, 0], [1, 0, 0], {"x": 0, "y": 1, "z": 0}],
                            "triangles": [{"vertex_indices": [0, 1, 2]}]}],
                "mesh_poses": [IDENTITY],
            },
        ],
        "octomap": {"header": {"frame_id": "world"}, "octomap": {"data": [], "resolution": 0.0}, "origin": IDENTITY},
    },
}  # fmt: skip


def test_attached_objects_and_allowed_contacts_are_honoured():
    scene = er.Scene(FULL)
    assert [each.name for each in scene.obstacles] == ["can", "flag"]
    assert scene.allowed == {("base_link", "can")}
    (crate,) = scene.attached
    assert (crate.name, crate.link, crate.touches, crate.body.pose.xyz) == (
        "crate",
        "tool0",
        ("wrist_3_link",),
        (0, 0, 0.1),
    )
    robot = in_scene(er.load_robot("ur5"), scene)
    assert robot.holds == ("crate",)


def test_objects_are_added_moved_grown_and_removed_in_their_order():
    assert places(scene_of(box("a"), box("b"), {"id": "a", "operation": 1})) == {"b": (0, 0, 0)}
    assert places(scene_of(box("a"), {"id": "", "operation": "REMOVE"}, box("b"))) == {"b": (0, 0, 0)}
    assert places(scene_of(box("a"), {"id": "a", "operation": 3, "pose": at(2.0)})) == {"a": (2, 0, 0)}
    grown = scene_of(box("a", at(1.0)), box("a", at(3.0), operation="append"))
    assert places(grown) == {"a/0": (1, 0, 0), "a/1": (3, 0, 0)}
    for wrong in ({"id": "c", "operation": 3}, box("a", operation=3)):
        with pytest.raises(InvalidValue, match="is moved: it must be there before"):
            scene_of(box("a"), wrong)
    with pytest.raises(UnknownName, match="operation of object 'a' .* 9; known: add, append, move, remove"):
        scene_of(box("a", operation=9))


def test_frames_that_the_file_places_are_honoured_and_others_refused():
    fixed = FULL["fixed_frame_transforms"]
    assert places(scene_of(box("a", at(0.5), "table_frame"), fixed_frame_transforms=fixed)) == {"a": (1.5, 0, 0)}
    lid = box("can", at(0.5), subframe_names=["lid"], subframe_poses=[at(0.0, 0.0, 0.2)])
    assert places(scene_of(lid, box("b", frame="can/lid"), box("c", frame="can")))["b"] == (0.5, 0, 0.2)
    elsewhere = scene_of(box("a", frame="camera"), fixed_frame_transforms=fixed)
    with pytest.raises(UnknownName, match="frame of object 'a' .*'camera'.* fixed_frame_transforms"):
        er.ArmWorld("ur5", elsewhere)
    with pytest.warns(UserWarning, match="frame 'panda_link0' is taken as the robot's root link"):
        rooted = scene_of(box("a", at(2.0), "panda_link0"), box("b", at(3.0), "panda_link0"))
    assert places(er.ArmWorld("ur5", rooted).scene) == {"a": (2, 0, 0), "b": (3, 0, 0)}
    with pytest.raises(UnknownName, match="frame of object 'b'"):
        er.ArmWorld("ur5", scene_of(box("a", frame="tool0"), box("b", frame="camera")))


def test_what_could_be_an_obstacle_and_is_not_read_is_refused():
    for more, said in (
        ({"world": {"octomap": {"octomap": {"data": [1, 2]}}}}, "has an octomap"),
        ({"is_diff": True}, "is_diff: true"),
        ({"link_scale": [{"link_name": "a", "scale": 1.2}]}, r"link_scale 1.2 of link 'a', .* --padding"),
        ({"link_padding": [{"link_name": "a", "padding": 1.3}]}, "padding of link 'a' .* must be at most 1"),
        ({"world": {"colision_objects": []}}, "did you mean 'collision_objects'"),
        ({"world": {"collision_objects": [box("a", planes=[{"coef": [0, 0, 1, 0]}])]}}, "it has a plane"),
        ({"world": {"collision_objects": {"a": 1}}}, "key of collision_objects|must have an 'id'"),
        ({"world": {"collision_objects": [3]}}, "'collision_objects' in .* 'key: value'"),
        ({"robot_state": {"attached_collision_objects": [{"object": box("c", frame="tool0")}]}}, "link_name"),
        ({"robot_state": {"joint_state": {"name": ["a", "b"], "position": [0.0]}}}, "joint_state .* 2 finite numbers"),
        ({"allowed_collision_matrix": {"entry_names": ["a"], "entry_values": []}}, "a row and a column"),
    ):
        with pytest.raises(EvenroadError, match=said):
            er.Scene({"world": {"collision_objects": []}} | more)


def test_an_unknown_key_at_any_level_is_refused_by_its_name():
    free = ("stamp", "object_colors", "origin")
    levels = list(_levels(FULL, (), free))
    assert len(levels) > 30
    for way in levels:
        changed = copy.deepcopy(FULL)
        part = changed
        for step in way:
            part = part[step]
        part["gadget"] = 1
        with pytest.raises(UnknownName, match="'gadget'"):
            er.Scene(changed)


def _levels(part, way, free):
    """Yield the ways to all mappings of a document that are read."""
    if isinstance(part, dict):
        yield way
    for key, value in part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ():
        if key not in free:
            yield from _levels(value, (*way, key), free)
