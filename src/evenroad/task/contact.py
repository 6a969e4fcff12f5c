"""The distance of a gripper from an object, and the core of an object that must stay free when contacts are allowed."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.distance import point_distance
from evenroad.geometry.inner import capsules_inside
from evenroad.geometry.mesh import TriangleMesh
from evenroad.geometry.pose import Pose
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, PointCloud, Shape, Sphere
from evenroad.robots.kinematics import link_poses
from evenroad.robots.robot import Robot
from evenroad.scenes.scene import Scene

_LEAST = 0.2
"""Least size of an object's core, as a share of the object, for any allowed depth of contacts."""
_NEAREST, _FARTHEST, _HALVINGS = 1e-4, 1.0, 12
"""Shifts of an obstacle to try to free a configuration: the least and the largest one [m], and the number of times that
the range between the last two is halved."""
_SAMPLES = 9
"""Number of points on each capsule for the distance to an object."""


def core_of(body: Shape, depth: float, *, as_capsule: bool) -> Shape | None:
    """Return the part of a body that is at least `depth` [m] inside; None if no part is known.

    A mesh is scaled towards its middle.  With `as_capsule` the result is one capsule.  This is for robots whose bodies
    are capsules, where a held body has capsules around it.
    """
    if as_capsule or isinstance(body, PointCloud):
        inside = max(capsules_inside(body), key=lambda each: each.radius, default=None)
        if inside is None:
            return None
        radius, a, b = _less(inside.radius, depth), np.array(inside.a), np.array(inside.b)
        length = float(np.linalg.norm(b - a))
        left = length - _less(length, 2.0 * (depth - inside.radius + radius))
        inward = 0.5 * left / max(length, 1e-12) * (b - a)
        return Capsule(tuple((a + inward).tolist()), tuple((b - inward).tolist()), radius, link=inside.link)
    match body:
        case Box():
            x, y, z = (_less(side, 2.0 * depth) for side in body.size)
            return replace(body, size=(x, y, z))
        case Sphere() | Capsule():
            return replace(body, radius=_less(body.radius, depth))
        case Cylinder():
            return replace(body, radius=_less(body.radius, depth), length=_less(body.length, 2.0 * depth))
        case Mesh():
            mesh = body.triangles
            low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
            share = np.maximum(1.0 - 2.0 * depth / np.maximum(high - low, 1e-9), _LEAST)
            middle = 0.5 * (low + high)
            drawn = TriangleMesh(middle + share * (mesh.vertices - middle), mesh.triangles, mesh.name)
            return replace(body, source=drawn, scale=(1.0, 1.0, 1.0))
    return None


def distance_of(body: Shape, robot: Robot, q: Floats, links: Collection[str]) -> float:
    """Return an upper bound of a body's distance from the nearest of some links at a configuration, (dim,) [m].

    It is measured from the frames and capsules of links, and to corners of meshes and points of clouds.
    """
    poses = link_poses(robot, q[np.newaxis])[0]
    shares = np.linspace(0.0, 1.0, _SAMPLES)[:, np.newaxis]
    points, radii = [poses[robot.links.index(link), :3, 3][np.newaxis] for link in links], [np.zeros(len(links))]
    for capsule in robot.capsules:
        if capsule.link in links:
            pose = poses[robot.links.index(capsule.link)]
            along = np.array(capsule.a) + shares * np.subtract(capsule.b, capsule.a)
            points.append(along @ pose[:3, :3].T + pose[:3, 3])
            radii.append(np.full(_SAMPLES, capsule.radius))
    sampled = np.concatenate(points)
    if isinstance(body, PointCloud | Mesh):
        # Imported late: it loads half of SciPy, for a fifth of a second, and few tasks grip a mesh.
        from scipy.spatial.distance import cdist

        corners = body.points if isinstance(body, PointCloud) else body.triangles.vertices
        away = cdist(sampled, body.pose.apply(corners)).min(axis=1)
    else:
        away = point_distance(body, sampled)
    return max(0.0, float((away - np.concatenate(radii)).min()))


def depth_in(world: ArmWorld, q: Floats) -> float | None:
    """Return the depth of a configuration, (dim,), in obstacles [m]; None if a metre does not free it.

    Each obstacle that the robot touches is moved along an axis of the root until the robot is free of it.  The depth is
    that of the axis with the shortest move.  It is also None if the robot touches itself.
    """
    deep, scene = 0.0, world.scene
    for each in scene.obstacles:
        alone = replace(scene, obstacles=(each,), allowed=frozenset(a for a in scene.allowed if a[1] == each.name))
        if replace(world, scene=alone).valid(q):
            continue
        needs = [_free_from(world, alone, q, sign * axis) for axis in np.eye(3) for sign in (-1.0, 1.0)]
        if min(needs) > _FARTHEST:
            return None
        deep = max(deep, min(needs))
    return deep or None


def _free_from(world: ArmWorld, alone: Scene, q: Floats, direction: Floats) -> float:
    """Return the distance to move the obstacle of a scene in a direction until a configuration is free [m]."""
    (obstacle,) = alone.obstacles

    def frees(metres: float) -> bool:
        pose = Pose(tuple((metres * direction).tolist())) @ obstacle.body.pose
        return bool(replace(world, scene=alone.moved({obstacle.name: pose})).valid(q))

    high = _NEAREST
    while not frees(high):
        high *= 2.0
        if high > _FARTHEST:
            return math.inf
    low = 0.5 * high
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if frees(middle) else (middle, high)
    return high


def _less(length: float, by: float) -> float:
    return max(length - by, _LEAST * length)
