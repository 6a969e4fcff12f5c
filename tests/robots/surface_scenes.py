"""Scenes of clouds and meshes to test with: walls of points, closed and open balls and boxes, soups of triangles."""

from dataclasses import replace

import numpy as np
import trimesh

from evenroad.geometry import Mesh, PointCloud, Pose, TriangleMesh, rotation_from_rpy
from evenroad.scenes.scene import Obstacle, Scene

TURNED = Pose((0.1, -0.2, 0.05), rotation_from_rpy(0.3, -0.5, 1.1))


def cloud_scene(seed, n, radius=0.02, spread=0.9, clear=0.35, pose=Pose()):
    """Points of a few walls and blobs, none near the origin."""
    rng = np.random.default_rng(seed)
    points = np.zeros((0, 3))
    while len(points) < n:
        place, angles = rng.uniform(-spread, spread, 3), rng.uniform(-3, 3, 3)
        turn = np.reshape(rotation_from_rpy(*angles), (3, 3))
        some = place + rng.uniform(-0.5, 0.5, (max(n // 8, 4), 3)) * rng.uniform(0.0, 0.4, 3) @ turn
        points = np.concatenate([points, some[np.linalg.norm(some, axis=1) > clear]])
    turn, shift = np.reshape(pose.rotation, (3, 3)), np.array(pose.xyz)
    cloud = PointCloud((points[:n] - shift) @ turn, radius, pose=pose)
    return Scene((Obstacle("cloud", cloud),), name=f"cloud{seed}")


def from_trimesh(mesh, *move):
    return TriangleMesh(np.asarray(mesh.vertices) + (move or (0.0, 0.0, 0.0)), np.asarray(mesh.faces))


def ball(x, y, z, radius=0.25, finer=1):
    return from_trimesh(trimesh.creation.icosphere(finer, radius), x, y, z)


def box(size, x, y, z, turn=0.0):
    mesh = trimesh.creation.box(size, trimesh.transformations.rotation_matrix(turn, (1, 2, 3)))
    return from_trimesh(mesh, x, y, z)


def half_open(mesh):
    return TriangleMesh(mesh.vertices, mesh.triangles[::2])


def half_turned(mesh):
    triangles = mesh.triangles.copy()
    triangles[::3] = triangles[::3, ::-1]
    return TriangleMesh(mesh.vertices, triangles)


def soup(seed, n, size=0.3):
    """Triangles of all forms, slivers and such without an area among them."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-0.8, 0.8, (n, 1, 3)) + rng.uniform(-size, size, (n, 3, 3))
    corners[: n // 8, 2] = corners[: n // 8, 1] + rng.normal(0.0, 1e-4, (n // 8, 3))
    corners[n // 8 : n // 6, 2] = corners[n // 8 : n // 6, 1]
    return _mesh_of(corners)


def all_sorts(seed):
    """Triangles large and small, slivers, such without an area, and some along planes between cells of a grid."""
    rng = np.random.default_rng(seed)
    sizes = np.repeat([0.6, 0.3, 0.01], [20, 100, 400])[:, None, None]
    corners = rng.uniform(-0.8, 0.8, (520, 1, 3)) + sizes * rng.uniform(-1, 1, (520, 3, 3))
    corners[:40, 2] = corners[:40, 1] + rng.normal(0.0, 1e-12, (40, 3))
    corners[40:80, 2] = 0.5 * (corners[40:80, 0] + corners[40:80, 1])
    corners[80:120, :, 1] = 0.5
    corners[120:130] = corners[120:130, :1]
    corners[130:160] = np.round(corners[130:160], 1)
    return _mesh_of(corners)


def _mesh_of(corners):
    corners = corners[np.linalg.norm(corners, axis=2).min(axis=1) > 0.35]
    return TriangleMesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))


def thin(robot, radius=0.004):
    """The robot with bodies that fit into others."""
    return replace(robot, capsules=tuple(replace(c, radius=radius) for c in robot.capsules), pairs=())


def scene_of(*meshes, pose=Pose()):
    return Scene(tuple(Obstacle(f"mesh{i}", Mesh(mesh, pose=pose)) for i, mesh in enumerate(meshes)), name="meshes")


BALLS = (ball(0.6, 0.2, 0.4), ball(-0.4, 0.5, 0.3, 0.3, 0), ball(0.1, -0.6, 0.7, 0.2, 2))
BOXES = (
    box((0.5, 0.4, 0.3), 0.6, 0.1, 0.4, 0.4),
    box((0.3, 0.7, 0.2), 0.5, 0.2, 0.5, 1.0),
    box((0.2, 0.2, 1.5), -0.5, 0, 0),
)
