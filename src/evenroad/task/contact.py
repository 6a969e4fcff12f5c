"""How near a gripper is to an object, and what of an object must stay free where contacts of it are allowed."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np
from scipy.spatial.distance import cdist

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
"""Share of its size that is left of an object however deep its contacts may be."""
_NEAREST, _FARTHEST, _HALVINGS = 1e-4, 1.0, 12
"""Shifts of an obstacle that are tried to free a configuration: the least and the largest one [m], and the number of
times that the range between the last two is halved."""
_SAMPLES = 9
"""Number of points on each capsule from which an object is looked for."""


def core_of(body: Shape, depth: float, *, as_capsule: bool) -> Shape | None:
    """Return what lies at least `depth` [m] inside of a body; None where nothing is known to.

    A mesh is scaled towards its middle.  With `as_capsule` the result is one capsule: for robots whose
    bodies are capsules, where a body held has capsules around it.
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
    """Return how far a body is from the nearest of some links at a configuration, (dim,): no less than it is [m].

    Links are their frames and capsules; meshes and clouds are their corners and points.
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
        corners = body.points if isinstance(body, PointCloud) else body.triangles.vertices
        away = cdist(sampled, body.pose.apply(corners)).min(axis=1)
    else:
        away = point_distance(body, sampled)
    return max(0.0, float((away - np.concatenate(radii)).min()))


def depth_in(world: ArmWorld, q: Floats) -> float | None:
    """Return how far the obstacles that the robot touches at a configuration, (dim,), had to be moved along the axis of
    the root that needs least, so that it is free of each [m]; None where a metre does not free it, or it touches
    itself.
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
    """Return how far the obstacle of a scene is to be moved in a direction until a configuration is free [m]."""
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
