"""Objects of a scene from a URDF, glTF, heights and planes stand where their files put them."""

import numpy as np
import pytest
import trimesh

import evenroad as er
from evenroad.errors import EvenroadError

CABINET = """<robot name="cabinet">
  <link name="body"><collision><origin xyz="0 0 0.5"/><geometry><box size="0.4 0.6 1"/></geometry></collision>
    <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="door"><visual><origin xyz="0 0.3 0"/><geometry><box size="0.02 0.6 1"/></geometry></visual></link>
  <joint name="hinge" type="revolute"><parent link="body"/><child link="door"/><origin xyz="0.2 -0.3 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="0" velocity="1" effort="1"/></joint>
</robot>"""


def scene_of(tmp_path, entry):
    """Return the obstacles, by name, of a scene whose only entry is `entry`."""
    (tmp_path / "scene.yaml").write_text(f"obstacles:\n  it: {entry}\nallowed: {{it: [base_link]}}\n")
    scene = er.load_scene(tmp_path / "scene.yaml")
    assert scene.allowed == {("base_link", name) for name in scene.names}, "what is allowed holds for all of its bodies"
    return {each.name: each.body for each in scene.obstacles}


def test_a_urdf_gives_its_links_at_the_joints_values_in_the_pose_of_the_entry(tmp_path):
    (tmp_path / "cabinet.urdf").write_text(CABINET)
    bodies = scene_of(tmp_path, "{include: cabinet.urdf, joints: {hinge: -1.5707963}, xyz: [1, 0, 0]}")
    assert list(bodies) == ["it/body", "it/body 1", "it/door"]
    # Opened by a quarter turn, the door's middle lies in front of the hinge, along x.
    np.testing.assert_allclose([*bodies["it/body"].pose.xyz, *bodies["it/door"].pose.xyz], [1, 0, 0.5, 1.5, -0.3, 0.5])
    closed = er.load_scene(tmp_path / "cabinet.urdf")
    assert closed.names == ("body", "body 1", "door")
    np.testing.assert_allclose(closed.obstacles[2].body.pose.xyz, (0.2, 0.0, 0.5))


def test_a_gltf_gives_its_objects_and_its_up_is_up(tmp_path):
    scene = trimesh.Scene()
    for name, extents, middle in (("table", (1.0, 0.1, 0.5), (0, 0.7, 0)), ("lamp", (0.1, 0.4, 0.1), (0.3, 1.0, 0.2))):
        scene.add_geometry(
            trimesh.creation.box(extents), node_name=name, transform=trimesh.transformations.translation_matrix(middle)
        )
    scene.export(tmp_path / "room.glb")
    bodies = scene_of(tmp_path, "{include: room.glb, convex: true}")
    assert set(bodies) == {"it/table", "it/lamp"}
    corners = bodies["it/lamp"].pose.apply(bodies["it/lamp"].triangles.vertices)
    # y of the file is z here, z of the file is -y.
    np.testing.assert_allclose([corners.min(axis=0), corners.max(axis=0)], [(0.25, -0.25, 0.8), (0.35, -0.15, 1.2)])
    assert set(er.load_scene(tmp_path / "room.glb").names) == {"table", "lamp"}


def test_a_plane_and_heights_are_in_the_way_of_an_arm_that_reaches_below_them(tmp_path):
    robot = er.load_robot("ur5")
    np.save(tmp_path / "ground.npy", np.full((60, 60), -0.3))
    low, high = np.deg2rad([0, 40, 20, 0, 0, 0]), np.deg2rad([0, -60, 20, 0, 0, 0])
    for entry in (
        "{shape: plane, xyz: [0, 0, -0.3]}",
        "{shape: height_map, file: ground.npy, spacing: 0.05, xyz: [-1.5, -1.5, 0]}",
    ):
        bodies = scene_of(tmp_path, entry)
        world = er.ArmWorld(robot, er.Scene([*bodies.values()]))
        assert world.valid(high)
        assert not world.valid(low)


def test_a_hollow_mesh_is_filled_by_its_convex_hull(tmp_path):
    room = trimesh.creation.box((1, 1, 1))
    room.update_faces(np.arange(len(room.faces)) > 1)
    room.export(tmp_path / "room.stl")
    open_, hull = (
        scene_of(tmp_path, f"{{shape: mesh, file: room.stl, convex: {text}}}")["it"] for text in ("false", "true")
    )
    assert len(open_.triangles.triangles) < len(hull.triangles.triangles)
    assert hull.volume == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("{include: cabinet.urdf, joints: {hinge: 1}}", "'hinge' at 1 rad, 1 rad outside"),
        ("{include: cabinet.urdf, joints: {lid: 1}}", "unknown joint of .*'lid'; known: hinge"),
        ("{include: room.stl, joints: {lid: 1}}", "unknown joint of .*room.stl: 'lid'"),
        ("{include: cabinet.urdf, convex: true}", "convex goes with a mesh's file"),
        ("{include: none.glb}", "none.glb of obstacle 'it' in .* is missing"),
        ("{include: cabinet.urdf, scale: 2}", "scale"),
        ("{include: cabinet.urdf, convex: 1}", "convex of obstacle 'it' in .* must be true or false, got 1"),
        ("{shape: height_map, file: room.stl, spacing: 1}", "room.stl is no text, not a .npy of heights"),
        ("{shape: height_map, file: ground.npy, spacing: 0}", "spacing"),
    ],
)
def test_what_is_wrong_in_an_included_file_is_said_in_one_line(tmp_path, entry, says):
    (tmp_path / "cabinet.urdf").write_text(CABINET)
    np.save(tmp_path / "ground.npy", np.zeros((2, 2)))
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "room.stl")
    with pytest.raises(EvenroadError, match=says) as caught:
        scene_of(tmp_path, entry)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("entry", ["{include: %s}", "{shape: mesh, file: %s}", "{shape: mesh, file: %s, convex: true}"])
def test_a_gltf_has_one_orientation_in_a_scene_and_that_of_its_file_on_a_link(tmp_path, entry):
    tall = trimesh.creation.box((0.2, 0.8, 0.1))
    tall.apply_translation((0.0, 0.4, 0.05))
    tall.export(tmp_path / "tall.glb")
    (tmp_path / "s.yaml").write_text("obstacles:\n  tall: " + entry % "tall.glb" + "\n")

    def span(body):
        corners = body.pose.apply(body.triangles.vertices)
        return corners.min(axis=0), corners.max(axis=0)

    (obstacle,) = er.load_scene(tmp_path / "s.yaml").obstacles
    for body in (obstacle.body, er.Mesh(tmp_path / "tall.glb")):
        np.testing.assert_allclose(span(body), [(-0.1, -0.1, 0.0), (0.1, 0.0, 0.8)], atol=1e-6)
    on_a_link = er.Mesh(tmp_path / "tall.glb", link="arm")
    np.testing.assert_allclose(span(on_a_link), [(-0.1, 0.0, 0.0), (0.1, 0.8, 0.1)], atol=1e-6)
