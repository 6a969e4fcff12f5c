"""Our boxes and coal's agree, on both puzzles and on random scenes; worlds of meshes keep the contract of worlds."""

from __future__ import annotations

import coal
import numpy as np
import pytest

from evenroad.geometry import TriangleMesh, load_mesh
from evenroad.geometry.mesh import merged
from evenroad.geometry.rotation import rotation_from_quaternion, rotations_from_quaternions
from evenroad.space import SE3, BoxSpace
from evenroad.testing import WorldContract
from evenroad_studies.problems import source_named
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld, shell, surface_of
from evenroad_studies.worlds.rigid.solid_world import as_poses
from tests_peers.engines.mesh_world import Collider, MeshWorld

NEAR = 1e-5
"""Poses this near to contact may be judged differently: coal's tolerance is 1e-6."""


def as_one_mesh(boxes):
    return merged(tuple(surface_of(box) for box in boxes))


def solid_boxes_meet(world, q):
    """Coal's own boxes against one another, pair after pair."""
    poses = as_poses(q, world.space)
    met = np.zeros(len(q), dtype=bool)
    obstacles = [(coal.Box(*(2 * np.array(box.half_extents))), transform(box)) for box in world.obstacles]
    for row, (pose, turn) in enumerate(zip(poses, rotations_from_quaternions(poses[:, 3:]), strict=True)):
        here = coal.Transform3s.Identity()
        here.setRotation(turn)
        here.setTranslation(pose[:3])
        for part in world.body:
            shape = coal.Box(*(2 * np.array(part.half_extents)))
            place = here * transform(part)
            met[row] |= any(
                coal.collide(shape, place, other, there, coal.CollisionRequest(), coal.CollisionResult())
                for other, there in obstacles
            )
    return met


def transform(box):
    there = coal.Transform3s.Identity()
    there.setRotation(box.matrix)
    there.setTranslation(np.array(box.centre))
    return there


def resized(world, by):
    """The world with a body whose boxes are that much larger on all sides."""
    body = [
        OrientedBox(box.centre, [max(half + by, 0.0) for half in box.half_extents], box.rotation)
        for box in world.body
    ]
    return SolidWorld(world.space, body, world.obstacles, world.resolution)


def assert_coal_agrees(world, q):
    ours = world.valid(q)
    # The surfaces of all boxes as one mesh: fast, and blind only to a body that is inside of a solid.
    surfaces = Collider(as_one_mesh(world.body), as_one_mesh(world.obstacles))
    theirs = surfaces.first_triangles(as_poses(q, world.space)) < 0
    differ = np.flatnonzero(ours != theirs)
    theirs[differ] = ~solid_boxes_meet(world, q[differ])
    differ = np.flatnonzero(ours != theirs)
    near = resized(world, -NEAR).valid(q[differ]) & ~resized(world, NEAR).valid(q[differ])
    assert near.all(), q[differ[~near]]
    return ours, len(differ)


@pytest.mark.parametrize("name", ["cubicles", "twistycool"])
def test_coal_agrees_on_a_hundred_thousand_poses_of_a_puzzle(name):
    world = source_named(name).make(0).world
    q = world.space.from_cube(np.random.default_rng(0).random((100_000, 6)))
    free, near_contact = assert_coal_agrees(world, q)
    assert 0.3 < free.mean() < 0.8
    assert near_contact < 10


@pytest.mark.parametrize("seed", range(6))
def test_coal_agrees_on_random_boxes_and_rectangles(seed):
    random = np.random.default_rng(seed)

    def some_box(reach):
        half = random.uniform(0.1, 1.0, 3)
        if random.random() < 0.4:
            half[random.integers(3)] = 0.0
        return OrientedBox(
            random.uniform(-reach, reach, 3), half, rotation_from_quaternion(xyzw=random.normal(size=4))
        )

    body, obstacles = [some_box(1.0) for _ in range(3)], [some_box(6.0) for _ in range(40)]
    world = SolidWorld(SE3([-7] * 3, [7] * 3), body, obstacles, (0.1, 0.1))
    free, _ = assert_coal_agrees(world, world.space.from_cube(random.random((20_000, 6))))
    assert 0.05 < free.mean() < 0.95


ELL = [
    OrientedBox.spanning((-1, -0.2, -0.2), (1, 0.2, 0.2)),
    OrientedBox.spanning((0.6, 0, -0.2), (1, 1, 0.2)),
]
CRATES = [
    OrientedBox(centre, half, rotation_from_quaternion(xyzw=turn), name=f"crate {i}")
    for i, (centre, half, turn) in enumerate(
        zip(
            np.random.default_rng(1).uniform(0, 10, (25, 3)),
            np.random.default_rng(2).uniform(0.3, 0.45, (25, 3)),
            np.random.default_rng(3).normal(size=(25, 4)),
            strict=True,
        )
    )
]


class TestMeshWorldInSpace(WorldContract):
    world = MeshWorld(
        SE3([0, 0, 0], [10, 10, 10]), as_one_mesh(ELL), [surface_of(box) for box in CRATES], (0.1, 0.05)
    )
    free_between = False


class TestMeshWorldWithoutTurns(WorldContract):
    world = MeshWorld(
        BoxSpace([0, 0, 0], [10, 10, 10]), as_one_mesh(ELL), [surface_of(box) for box in CRATES], 0.1
    )
    free_between = False


def test_meshes_and_boxes_of_one_scene_agree_on_motions():
    meshes = TestMeshWorldInSpace.world
    # The crates are too small for the body to be inside, so that surfaces are as good as solids.
    boxes = SolidWorld(meshes.space, ELL, CRATES, meshes.resolution)
    q = meshes.space.from_cube(np.random.default_rng(4).random((1200, 6)))
    a, b = q[:600], meshes.space.interpolate(q[:600], q[600:], np.random.default_rng(5).random(600))
    verdicts = meshes.motion_valid(a, b)
    np.testing.assert_array_equal(verdicts, boxes.motion_valid(a, b))
    assert 0 < verdicts.sum() < 600


def test_meshes_are_hollow():
    room = OrientedBox.spanning((2, 2, 2), (8, 8, 8), name="room")
    body = OrientedBox([0, 0, 0], [0.5, 0.5, 0.5])
    space = BoxSpace([0, 0, 0], [10, 10, 10])
    meshes = MeshWorld(space, surface_of(body), [surface_of(room)], 0.1)
    boxes = SolidWorld(space, [body], shell(room), 0.1)
    q = space.from_cube(np.random.default_rng(6).random((5000, 3)))
    np.testing.assert_array_equal(meshes.valid(q), boxes.valid(q))
    assert meshes.valid([[5.0, 5.0, 5.0]]).all()


def test_the_explanation_names_the_mesh():
    world = TestMeshWorldInSpace.world
    q = world.space.from_cube(np.random.default_rng(7).random((200, 6)))
    boxes = SolidWorld(world.space, ELL, CRATES, world.resolution)
    for row in q[~world.valid(q)]:
        met = int(world.explain(row).split("obstacle ")[1].split(" ")[0])
        assert f"(crate {met})" in world.explain(row)
        assert not SolidWorld(boxes.space, ELL, [CRATES[met]], boxes.resolution).valid(row[np.newaxis])[0]
    assert "bounds" in world.explain([-1.0, 0, 0, 1, 0, 0, 0])


def test_a_world_of_files_is_that_of_its_meshes(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    for name, mesh in (("body.stl", as_one_mesh(ELL)), ("crates.obj", as_one_mesh(CRATES))):
        trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).export(tmp_path / name)
    world = MeshWorld(
        SE3([0, 0, 0], [10, 10, 10]),
        load_mesh(tmp_path / "body.stl"),
        [load_mesh(tmp_path / "crates.obj")],
        (0.1, 0.05),
    )
    q = world.space.from_cube(np.random.default_rng(8).random((3000, 6)))
    np.testing.assert_array_equal(world.valid(q), TestMeshWorldInSpace.world.valid(q))
    assert "crates.obj" in world.explain(q[~world.valid(q)][0])


def test_one_triangle_is_a_mesh():
    triangle = TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    needle = TriangleMesh([[0, 0, -1], [0, 0, 1], [0.01, 0, 1]], [[0, 1, 2]])
    world = MeshWorld(BoxSpace([-5] * 3, [5] * 3), needle, [triangle], 0.1)
    assert world.valid([[0.2, 0.2, 0.0], [0.8, 0.8, 0.0], [0.2, 0.2, 1.5]]).tolist() == [False, True, True]
