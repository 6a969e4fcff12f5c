"""A scene that is written is the same when it is read."""

import numpy as np
import pytest

import evenroad as er
from evenroad.errors import NotAvailable, UnknownName
from evenroad.robots.held import HeldObject
from evenroad.scenes.scene import Obstacle, Seen

TETRAHEDRON = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]), [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def a_scene():
    turned = er.Pose((0.3, 1e-7, -2.5e-9), rpy=(0.1, -0.2, 3.0))
    cloud = er.PointCloud(np.random.default_rng(2).random((20, 3)), 0.01, xyz=(0, 0, 1))
    return er.Scene(
        [
            er.Box((0.8, 1.2, 0.04), pose=turned, name="a table: 'large'"),
            er.Sphere(0.1, xyz=(0.5, 0, 0.5), name="ball"),
            er.Cylinder(0.05, 1.0, xyz=(0, 0.6, 0.5), name="post"),
            Obstacle("bar", er.Capsule((0, 0, 0), (0.3, 0.2, 0.1), 0.02), cell=True, clearance=0.03),
            Obstacle("scan", cloud, seen=Seen("home", 0.03)),
            er.Mesh(TETRAHEDRON, (1, 2, 3), xyz=(1, 1, 0), name="wedge"),
        ],
        name="cell 7",
        allowed=frozenset({("base_link", "post"), ("tool0", "ball")}),
        near_ends=frozenset({("tool0", "scan", 0.02)}),
        states={"home": {"elbow_joint": 1.25}, "no": {}},
        limits={"elbow_joint": (-3.0, 0.5)},
        attached=(HeldObject("crate", er.Box((0.1, 0.1, 0.2), xyz=(0, 0, 0.1)), "tool0", ("wrist_3_link",)),),
    )


def test_everything_of_a_scene_comes_back(tmp_path):
    scene = a_scene()
    scene.save(tmp_path / "cell.yaml")
    read = er.load_scene(tmp_path / "cell.yaml")
    assert read.names == scene.names
    for one, other in zip(read.obstacles, scene.obstacles, strict=True):
        assert (one.cell, one.clearance, one.seen) == (other.cell, other.clearance, other.seen)
        assert one.body.size == other.body.size
        np.testing.assert_allclose(one.body.pose.matrix, other.body.pose.matrix, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(read.obstacles[4].body.points, scene.obstacles[4].body.points)
    triangles = [each.obstacles[5].body.triangles for each in (read, scene)]
    np.testing.assert_array_equal(*(each.vertices[each.triangles] for each in triangles))
    for name in ("name", "allowed", "near_ends", "states", "limits"):
        assert getattr(read, name) == getattr(scene, name), name
    (held,) = read.attached
    assert (held.name, held.link, held.touches, held.body.size) == (
        "crate",
        "tool0",
        ("wrist_3_link",),
        (0.1, 0.1, 0.2),
    )


@pytest.mark.parametrize("name", ["box-reach", "shelf", "empty"])
def test_a_shipped_scene_keeps_its_fingerprint(name, tmp_path):
    er.load_scene(name).save(tmp_path / "again.yml")
    assert er.load_scene(tmp_path / "again.yml").fingerprint() == er.load_scene(name).fingerprint()


def test_what_cannot_be_written_is_refused(tmp_path):
    with pytest.raises(UnknownName, match=r"kind of file for a scene, .*\.json'"):
        er.Scene().save(tmp_path / "scene.json")
    text = "world: {collision_objects: [{id: a, header: {frame_id: tool0}, primitives: [{type: 2, dimensions: [0.1]}],"
    text += " primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}]}"
    (tmp_path / "moveit.yaml").write_text(text)
    with pytest.warns(UserWarning, match="frame 'tool0'"):
        scene = er.load_scene(tmp_path / "moveit.yaml")
    with pytest.raises(NotAvailable, match=r"er.ArmWorld\(robot, scene\).scene"):
        scene.save(tmp_path / "scene.yaml")
