"""Whether a body of boxes meets obstacles, slowly: by the corners of all boxes, and by linear programs.

Nothing is shared with the kernel.
"""

from itertools import product

import numpy as np
from scipy.optimize import linprog

from evenroad.geometry import rotation_from_heading, rotation_from_quaternion
from evenroad.space import SE2, SE3, BoxSpace
from evenroad_studies.worlds.rigid import OrientedBox, SolidWorld


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


def a_turn(random):
    return rotation_from_quaternion(xyzw=random.normal(size=4))


def some_boxes(random, m, dim, flat=()):
    """Random boxes in the cube of side 10; those numbered in `flat` are rectangles."""
    boxes = []
    for i in range(m):
        half = random.uniform(0.3, 1.5, dim)
        if i in flat:
            half[random.integers(dim)] = 0.0
        turn = a_turn(random) if dim == 3 else rotation_from_heading(random.uniform(0, 7))
        boxes.append(OrientedBox(random.uniform(0, 10, dim), half, turn, name=f"crate {i}"))
    return boxes


RANDOM = np.random.default_rng(5)
ELL = (OrientedBox.spanning((-1, -0.2, -0.2), (1, 0.2, 0.2)), OrientedBox.spanning((0.6, 0, -0.2), (1, 1, 0.2)))
FLAT_ELL = (OrientedBox.spanning((-1, -0.2), (1, 0.2)), OrientedBox.spanning((0.6, 0), (1, 1)))
IN_SPACE = SolidWorld(SE3([0, 0, 0], [10, 10, 10]), ELL, some_boxes(RANDOM, 25, 3, flat=range(0, 25, 2)), (0.1, 0.05))
IN_THE_PLANE = SolidWorld(SE2([0, 0], [10, 10]), FLAT_ELL, some_boxes(RANDOM, 12, 2), (0.1, 0.05))
SHIFTED = SolidWorld(BoxSpace([0, 0, 0], [10, 10, 10]), ELL, some_boxes(RANDOM, 25, 3), 0.1)
SHIFTED_IN_THE_PLANE = SolidWorld(BoxSpace([0, 0], [10, 10]), FLAT_ELL, some_boxes(RANDOM, 12, 2), 0.1)
WORLDS = [IN_SPACE, IN_THE_PLANE, SHIFTED, SHIFTED_IN_THE_PLANE]


def penetration(centre, matrix, half, obstacle):
    """By how much both boxes can shrink on all sides and still have a point in common; < 0 if they are apart."""
    rows, limits = [], []
    for middle, axes, extents in (
        (centre, matrix, half),
        (np.array(obstacle.centre), obstacle.matrix, np.array(obstacle.half_extents)),
    ):
        for axis, extent in zip(axes.T, extents, strict=True):
            rows += [[*axis, 1.0], [*-axis, 1.0]]
            limits += [extent + axis @ middle, extent - axis @ middle]
    dim = len(centre)
    best = linprog([0.0] * dim + [-1.0], rows, limits, bounds=[(None, None)] * (dim + 1))
    return -best.fun


def deepest(world, q):
    """The largest penetration; boxes whose balls are apart are apart."""
    dim = len(world.body[0].centre)
    (matrix,), (position,) = placed(np.asarray(q, dtype=float)[np.newaxis], dim)
    found = [-1.0]
    for part, obstacle in product(world.body, world.obstacles):
        centre = position + matrix @ np.array(part.centre)
        reach = np.linalg.norm(part.half_extents) + np.linalg.norm(obstacle.half_extents)
        if np.linalg.norm(centre - np.array(obstacle.centre)) < reach:
            found.append(penetration(centre, matrix @ part.matrix, part.half_extents, obstacle))
    return max(found)
