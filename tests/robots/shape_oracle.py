"""How far true shapes are from obstacles, by quadratic programs over the corners of convex solids: slow and readable.

A solid is the corners of its hull, (n, 3), and a radius by which it is widened.  A cylinder is a prism within it, of
so many sides that it lacks less than `SHORT` of the radius.
"""

import itertools

import numpy as np
from scipy.optimize import nnls

from evenroad.geometry import Box, Capsule, Cylinder, Mesh, PointCloud, Sphere
from tests.robots.mesh_arms import FORK
from tests.robots.oracle import link_poses

SIDES = 160
SHORT = 2e-4
"""A prism of so many sides is nowhere farther inside of its cylinder, in parts of the radius."""
_HEAVY = 1e3
_CUBE = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))


def solids_of(shape):
    """The convex solids that make a shape, in the frame of its link, as (corners, radius).

    A mesh must be the fork; triangles alone, (n, 3, 3), are one each.
    """
    match shape:
        case np.ndarray():
            return [(corners, 0.0) for corners in shape]
        case Box():
            return [(shape.pose.apply(_CUBE * shape.size), 0.0)]
        case Sphere():
            return [(shape.pose.apply(np.zeros((1, 3))), shape.radius)]
        case Capsule():
            return [(shape.pose.apply(np.array([shape.a, shape.b])), shape.radius)]
        case Cylinder():
            turn = np.arange(SIDES) * 2.0 * np.pi / SIDES
            ring = shape.radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
            ends = [np.c_[ring, np.full(SIDES, side * shape.length)] for side in (-0.5, 0.5)]
            return [(shape.pose.apply(np.concatenate(ends)), 0.0)]
        case PointCloud():
            return [(point[np.newaxis], shape.radius) for point in shape.pose.apply(shape.points)]
        case Mesh():
            return [(shape.pose.apply(_CUBE * size + centre), 0.0) for size, centre in FORK]
    raise AssertionError(shape)


def distance(first, second):
    """The distance of two hulls of corners, 0 where they meet: weights >= 0 that add up to one, of both, decide it."""
    middle = first.mean(axis=0)
    rows = np.zeros((5, len(first) + len(second)))
    rows[:3] = np.concatenate([first - middle, middle - second]).T
    rows[3, : len(first)] = rows[4, len(first) :] = _HEAVY
    return nnls(rows, np.array([0.0, 0.0, 0.0, _HEAVY, _HEAVY]))[1]


def shape_clearance(robot, shapes, scene, q):
    """By how much the nearest link is clear of the nearest obstacle, (n,); 0 or less where they touch."""
    poses = link_poses(robot, q)
    solids = [(shape.link, *solid) for shape in shapes for solid in solids_of(shape)]
    there = [solid for obstacle in scene.obstacles for solid in solids_of(obstacle.body)]
    centres = np.array([corners.mean(axis=0) for corners, _ in there])
    sizes = np.array([np.linalg.norm(corners - corners.mean(axis=0), axis=1).max() + more for corners, more in there])
    apart = np.full(len(q), np.inf)
    for link, corners, radius in solids:
        rotation, origin = (np.broadcast_to(each, (len(q), *each.shape[1:])) for each in poses[link])
        for row in range(len(q)):
            here = corners @ rotation[row].T + origin[row]
            middle = here.mean(axis=0)
            size = np.linalg.norm(here - middle, axis=1).max() + radius
            # The balls around two solids are no farther apart than these: the nearest come first.
            bounds = np.linalg.norm(centres - middle, axis=1) - sizes - size
            for number in np.argsort(bounds):
                if bounds[number] >= apart[row]:
                    break
                others, other = there[number]
                apart[row] = min(apart[row], distance(here, others) - radius - other)
    return apart
