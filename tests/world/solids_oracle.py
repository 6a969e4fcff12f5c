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
    """By how much the body stays apart from obstacles along the best of the separating axes, (n,); < 0: it meets."""
    dim = len(world.body[0].centre)
    rotation, place = placed(np.asarray(q, dtype=float), dim)
    least = np.full(len(q), np.inf)
    for part in world.body:
        own = np.einsum("nij,cj->nci", rotation, corners(part)) + place[:, None]
        own_axes = np.einsum("nij,jk->nki", rotation, np.array(part.rotation).reshape(dim, dim))
        for obstacle in world.obstacles:
            other = corners(obstacle)
            other_axes = np.array(obstacle.rotation).reshape(dim, dim).T
            candidates = [own_axes, np.broadcast_to(other_axes, (len(q), dim, dim))]
            if dim == 3:
                across = np.cross(own_axes[:, :, None], other_axes[None, None]).reshape(len(q), 9, 3)
                length = np.linalg.norm(across, axis=2, keepdims=True)
                candidates.append(np.where(length > 1e-6, across / np.maximum(length, 1e-6), own_axes[:, :1]))
            axes = np.concatenate(candidates, axis=1)
            mine, theirs = np.einsum("nci,nai->nac", own, axes), np.einsum("ci,nai->nac", other, axes)
            between = np.maximum(mine.min(2) - theirs.max(2), theirs.min(2) - mine.max(2))
            least = np.minimum(least, between.max(axis=1))
    return least
