"""A judge beside coal, which misses contacts: points of one body in another one, and a linear program for two boxes."""

import numpy as np
from scipy.optimize import linprog

from evenroad.collision.coal_world import tests_of as pairs_of
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Sphere

DEEP = 2e-6
"""Bodies are in contact beyond doubt where one reaches so deep into the other [m]: coal's tolerance is 1e-6."""


def free_for_both(world, q):
    """Return what coal calls free, (n,), where the second judge sees no contact in any of these."""
    free = world.valid(q)
    np.testing.assert_array_equal(q[free][in_contact(world, q[free])], np.zeros((0, q.shape[1])))
    return free


def in_contact(world, q):
    """Return in which configurations, (n, dim), of a world of coal's two bodies are surely in contact, (n,)."""
    poses, shapes = world._poses(q), world.shapes
    found = np.zeros(len(q), dtype=bool)
    for first, second, is_obstacle in pairs_of(world.robot, world.scene, shapes):
        other = world.scene.obstacles[second].body if is_obstacle else shapes[second]
        there = np.broadcast_to(other.pose.matrix, poses[first].shape) if is_obstacle else poses[second]
        found |= _reaches_into(shapes[first], poses[first], other, there)
        found |= _reaches_into(other, there, shapes[first], poses[first])
        if isinstance(other, Box) and isinstance(shapes[first], Box):
            near = np.linalg.norm(poses[first][:, :3, 3] - there[:, :3, 3], axis=1) < _reach(other) + _reach(
                shapes[first]
            )
            for row in np.flatnonzero(near & ~found):
                found[row] = boxes_meet(shapes[first].size, poses[first][row], other.size, there[row])
    return found


def boxes_meet(size, pose, other, there):
    """Return whether a point is in two boxes, deeper than the tolerance: a linear program over where it is."""
    sides = []
    for extents, at in ((size, pose), (other, there)):
        turn, half = at[:3, :3], 0.5 * np.array(extents) - DEEP
        along = turn.T @ at[:3, 3]
        sides += [(turn.T, half + along), (-turn.T, half - along)]
    rows, most = (np.concatenate(each) for each in zip(*sides, strict=True))
    return linprog(np.zeros(3), A_ub=rows, b_ub=most, bounds=[(None, None)] * 3).status == 0


def _reaches_into(shape, poses, other, there):
    """Return where a point of a body, or a ball around it, is in the other one, (n,)."""
    points, radius = _points(shape)
    turn = there[:, :3, :3]
    at = points @ poses[:, :3, :3].swapaxes(1, 2) + (poses[:, np.newaxis, :3, 3] - there[:, np.newaxis, :3, 3])
    return (distance_to(other, at @ turn) < radius - DEEP).any(axis=1)


def _points(shape):
    """Return points of a body in its own frame, (p, 3), and by how much it is wider."""
    if isinstance(shape, Box):
        signs = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(8, 3)
        return signs * shape.size, 0.0
    if isinstance(shape, Mesh):
        return shape.triangles.vertices[np.unique(shape.triangles.triangles)], 0.0
    if isinstance(shape, Sphere):
        return np.zeros((1, 3)), shape.radius
    z = 0.5 * shape.length * np.linspace(-1.0, 1.0, 9)
    return np.column_stack([0.0 * z, 0.0 * z, z]), shape.radius if isinstance(shape, Capsule) else 0.0


def distance_to(shape, points):
    """Return how far points, (..., 3), are from a body in its own frame, < 0 inside; inf from a mesh."""
    if isinstance(shape, Sphere):
        return np.linalg.norm(points, axis=-1) - shape.radius
    if isinstance(shape, Capsule):
        z = np.clip(points[..., 2], -0.5 * shape.length, 0.5 * shape.length)
        return np.hypot(np.hypot(points[..., 0], points[..., 1]), points[..., 2] - z) - shape.radius
    if isinstance(shape, Cylinder):
        round_ = np.hypot(points[..., 0], points[..., 1]) - shape.radius
        beyond = np.stack([round_, np.abs(points[..., 2]) - 0.5 * shape.length], axis=-1)
    elif isinstance(shape, Box):
        beyond = np.abs(points) - 0.5 * np.array(shape.size)
    else:
        return np.full(points.shape[:-1], np.inf)
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) + np.minimum(beyond.max(axis=-1), 0.0)


def _reach(box):
    return 0.5 * float(np.linalg.norm(box.size))
