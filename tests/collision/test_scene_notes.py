"""Notes about scenes that seem to have another unit than metres, and about meshes with gaps."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import evenroad as er
from evenroad._native.robot import are_usual
from evenroad.collision import scene_notes
from evenroad.geometry.rotation import NO_ROTATION
from evenroad.geometry.shapes import Mesh, PointCloud
from evenroad.loading.units import UNLIKE
from evenroad.robot import ArmWorld, Obstacle, load_model, load_robot, load_scene
from evenroad.robots.planes import Plane
from tests.robots.urdf_texts import two_joints

FAR, HUGE = "is within the robot's reach", "m long, the robot reaches"


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    file = tmp_path_factory.mktemp("robot") / "arm.urdf"
    file.write_text(two_joints())
    return load_robot(file)


def block(side, **where):
    made = trimesh.creation.box((side, side, side))
    return Mesh(er.geometry.TriangleMesh(np.array(made.vertices), np.array(made.faces), "block"), **where)


@pytest.mark.parametrize(
    ("obstacles", "said"),
    [
        ([er.Box((50, 50, 50), xyz=(500, 0, 250)), er.Sphere(20, xyz=(0, 300, 0))], FAR),
        ([er.Cylinder(30, 1000, xyz=(600, 0, 0)), er.Capsule((0, 300, 0), (0, 300, 90), 25)], FAR),
        ([PointCloud(np.full((20, 3), 300.0), 5.0), block(200, xyz=(700, 0, 0))], FAR),
        # A large side is near though its middle is far, and a corner of a turned box far though its middle is near.
        ([er.Box((1.0, 9.0, 9.0), xyz=(0.9, 4.5, 4.5))], ""),
        ([er.Box((900, 0.05, 0.05), xyz=(0, 3, 0), rpy=(0, 0, 0.001))], FAR),
        ([er.Box((2000, 2000, 60), xyz=(900, 0, -30.5))], HUGE),
        ([er.Sphere(1500, xyz=(0, 0, -1600)), er.Box((0.1, 0.1, 0.1), xyz=(0.5, 0, 0))], HUGE),
        ([block(2000, xyz=(0, 0, -1000.2)), er.Box((0.1, 0.1, 0.1), xyz=(0.5, 0, 0))], HUGE),
        ([block(0.0004, xyz=(0.3, 0, 0))], HUGE),
        ([er.Box((0.0004, 0.0008, 0.0001), xyz=(0.5, 0, 0.1)), er.Sphere(2e-4, xyz=(0.5, 0, 0))], HUGE),
        ([er.Box((2000, 2000, 0.1), xyz=(0, 0, -0.3))], ""),
        ([Obstacle("floor", Plane("floor", (0, 0, -0.3), tuple(np.eye(3).ravel())).body, cell=True)], ""),
        ([er.Sphere(2e-4, xyz=(0.5, 0, 0)), er.Box((0.1, 0.1, 0.1), xyz=(0.5, 0, 0.3))], ""),
        ([PointCloud(np.full((20, 3), 0.3), 1e-4)], ""),
        ([], ""),
    ],
)
def test_a_world_notes_obstacles_out_of_reach_and_sizes_that_do_not_fit(robot, obstacles, said):
    notes = ArmWorld(robot, er.Scene(obstacles)).notes
    assert len(notes) == bool(said)
    assert all(said in note and note.endswith("metres are expected") for note in notes)


def test_shipped_scenes_are_of_usual_sizes():
    for name in ("box-reach", "box-reach-narrow", "empty", "shelf"):
        scene = load_scene(name)
        assert ArmWorld("arm7" if name == "shelf" else "ur5", scene).notes == ()


@pytest.mark.parametrize("seed", range(60))
def test_sizes_are_usual_natively_where_nothing_is_noted(seed):
    """Obstacles of all kinds and sizes, near and far, and planes."""
    rng = np.random.default_rng(seed)
    bodies = []
    for _ in range(int(rng.integers(1, 4))):
        size, xyz = 10.0 ** rng.uniform(-5, 5, 3), rng.choice([0.3, 30.0, 3000.0]) * rng.uniform(-1, 1, 3)
        kinds = [er.Box(size, xyz=xyz, rpy=rng.uniform(-3, 3, 3)), er.Sphere(size[0], xyz=xyz)]
        kinds += [
            er.Cylinder(*size[:2], xyz=xyz),
            er.Capsule(*size[:2], xyz=xyz),
            Plane("p", tuple(xyz.tolist()), NO_ROTATION).body,
        ]
        bodies.append(kinds[int(rng.integers(5))])
    scene, reach = er.Scene(bodies), float(rng.uniform(0.2, 3.0))
    limits = UNLIKE * reach, scene_notes._THICK * reach, min(reach, 1.0) / UNLIKE
    usual = are_usual(scene.rows, scene_notes._PLANE, reach, *limits)
    assert usual == (scene_notes._size_notes(scene, reach) == ())


def test_a_plan_hands_on_the_note_about_its_scene(robot, tmp_path):
    (tmp_path / "arm.urdf").write_text(two_joints())
    (tmp_path / "far.yaml").write_text("obstacles:\n  desk: {shape: box, size: [50, 50, 50], xyz: [400, 0, 250]}\n")
    (note,) = er.plan(tmp_path / "far.yaml", [0.0, 0.0], [0.5, 0.5], robot=tmp_path / "arm.urdf").notes
    assert FAR in note
    assert "'far'" in note
    world = ArmWorld(robot, load_scene(tmp_path / "far.yaml"))
    assert er.plan(world, [0.0, 0.0], [0.5, 0.5]).notes == (note,)


def test_boxes_of_arrays_have_the_notes_of_boxes(robot):
    for size, xyz in (([(1.0, 2.0, 1.0)], [(300.0, 0.0, 0.0)]), ([(2000.0, 2000.0, 60.0)], [(900.0, 0.0, -30.5)])):
        (note,) = er.plan(er.Scene.of_boxes(size, xyz, names=("box1",)), [0.0, 0.0], [0.1, 0.1], robot=robot).notes
        assert note == ArmWorld(robot, er.Scene([Obstacle.of("box1", "box", size[0], xyz[0])])).notes[0]


def ball(without=0, apart=()):
    """A ball of 1280 triangles around (0.5, 0, 0.5); without the first ones, and with corners that come apart there."""
    made = trimesh.creation.icosphere(subdivisions=3, radius=0.2)
    made.apply_translation((0.5, 0.0, 0.5))
    vertices, faces = np.array(made.vertices), np.array(made.faces)[without:]
    for row in apart:
        vertices = np.concatenate([vertices, vertices[faces[row, :1]] + 1e-6])
        faces[row, 0] = len(vertices) - 1
    return er.geometry.TriangleMesh(vertices, faces, "ball")


SHEET = er.geometry.mesh.height_map(np.add.outer(np.arange(150.0), np.sin(np.arange(150.0))) / 150.0, 0.01)


@pytest.mark.parametrize(
    ("mesh", "has_gaps"),
    [
        (ball(), False),
        (ball(without=2), True),
        (ball(apart=(3, 500)), True),
        # Half a ball, and a sheet whose rim is 1.3 % of its edges, are meant to be open.
        (ball(without=640), False),
        (SHEET, False),
    ],
    ids=["closed", "two triangles lost", "corners apart", "half", "sheet"],
)
def test_a_mesh_that_is_closed_but_for_small_gaps_is_a_note_of_scene_and_robot(robot, mesh, has_gaps, tmp_path):
    for scale in (1.0, 0.5):
        notes = ArmWorld(robot, er.Scene([Mesh(mesh, scale, name="crate")])).notes
        assert [("gaps" in note, "obstacle crate" in note) for note in notes] == [(True, True)] * has_gaps
    trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).export(tmp_path / "body.obj")
    file = tmp_path / "arm.urdf"
    file.write_text(two_joints("<collision><geometry><mesh filename='body.obj'/></geometry></collision>"))
    assert sum("gaps" in note and "link lower" in note for note in load_model(file).notes) == has_gaps
