"""Whether a body of boxes meets obstacles, slowly, from the corners of all boxes: nothing is shared with the kernel."""

from itertools import product

import numpy as np


def corners(box):
    """Corners of a box, (2^dim, dim)."""
    dim = len(box.centre)
    axes = np.array(box.rotation).reshape(dim, dim)
    signs = np.array(list(product((-1.0, 1.0), repeat=dim)))
    return np.array(box.centre) + (signs * np.array(box.half_extents)) @ axes.T


def placed(q, dim):
    """Rotations (n, dim, dim) and places (n, dim) of configurations of SE2, SE3 or a Box."""
    n = len(q)
    if q.shape[1] == dim:
        return np.broadcast_to(np.eye(dim), (n, dim, dim)), q
    if dim == 2:
        c, s = np.cos(q[:, 2]), np.sin(q[:, 2])
        return np.stack([c, -s, s, c], axis=1).reshape(n, 2, 2), q[:, :2]
    w, x, y, z = (q[:, 3:] / np.linalg.norm(q[:, 3:], axis=1, keepdims=True)).T
    cross = np.zeros((n, 3, 3))
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= cross.transpose(0, 2, 1)
    # Rodrigues' formula of half the angle: R = 1 + 2 w K + 2 K K, K the cross product with the vector part.
    return np.eye(3) + 2.0 * w[:, None, None] * cross + 2.0 * cross @ cross, q[:, :3]


def gap(world, q):
    """By how much the body stays apart from obstacles along the best of the separating axes, (n,); < 0: it meets.

    Of obstacles whose balls are far, the distance of the balls.
    """
    dim = len(world.body[0].centre)
    rotation, place = placed(np.asarray(q, dtype=float), dim)
    least = np.full(len(q), np.inf)
    for part in world.body:
        middle = place + rotation @ np.array(part.centre)
        for obstacle in world.obstacles:
            between = np.linalg.norm(middle - np.array(obstacle.centre), axis=1)
            between -= np.linalg.norm(part.half_extents) + np.linalg.norm(obstacle.half_extents)
            close = between < 1e-3
            between[close] = _along_axes(part, obstacle, rotation[close], place[close])
            least = np.minimum(least, between)
    return least


def _along_axes(part, obstacle, rotation, place):
    dim = len(part.centre)
    own = np.einsum("nij,cj->nci", rotation, corners(part)) + place[:, None]
    own_axes = np.einsum("nij,jk->nki", rotation, np.array(part.rotation).reshape(dim, dim))
    other = corners(obstacle)
    other_axes = np.array(obstacle.rotation).reshape(dim, dim).T
    axes = [own_axes, np.broadcast_to(other_axes, own_axes.shape)]
    if dim == 3:
        across = np.cross(own_axes[:, :, None], other_axes[None, None]).reshape(-1, 9, 3)
        length = np.linalg.norm(across, axis=2, keepdims=True)
        axes.append(np.where(length > 1e-6, across / np.maximum(length, 1e-6), own_axes[:, :1]))
    axes = np.concatenate(axes, axis=1)
    mine, theirs = axes @ own.transpose(0, 2, 1), axes @ other.T
    return np.maximum(mine.min(2) - theirs.max(2), theirs.min(2) - mine.max(2)).max(axis=1)
