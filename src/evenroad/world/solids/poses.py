"""Poses: configurations of the spaces that a rigid body can move in, as translation and unit quaternion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.geometry.mesh import TriangleMesh
from evenroad.space import SO3, Box, Circle, Product, Space
from evenroad.world.solids.oriented_box import OrientedBox

RigidSpace: TypeAlias = Product | Box
"""``SE2(..)``, ``SE3(..)``, or a `Box` of 2 or 3 axes for a body that does not rotate."""


def body_dimension(space: Space) -> int:
    """Return 2 or 3: the dimension of the bodies that move in `space`.

    Raises InvalidValue if `space` is none of ``SE2(..)``, ``SE3(..)`` and a `Box` of 2 or 3 axes.
    """
    if isinstance(space, Box) and space.dim in (2, 3):
        return space.dim
    if isinstance(space, Product) and len(space.parts) == 2 and isinstance(space.parts[0], Box):
        position, rotation = space.parts
        for dim, kind in ((2, Circle), (3, SO3)):
            if position.dim == dim and isinstance(rotation, kind):
                return dim
    raise InvalidValue(f"space must be SE2(..), SE3(..) or a Box of 2 or 3 axes, got {space!r}")


def contact_with(obstacles: Sequence[OrientedBox | TriangleMesh], number: int) -> str:
    """Say which obstacle a body meets."""
    name = obstacles[number].name
    return f"the body meets obstacle {number}{f' ({name})' if name else ''}"


def as_poses(q: Floats, space: Space) -> Floats:
    """Return configurations (n, dim) of such a space as (n, 7): x, y, z, then the quaternion's w, x, y, z.

    The quaternions of a space that contains `q` are of norm 1; others are not, and are not looked at.
    """
    dim = body_dimension(space)
    poses = np.zeros((len(q), 7))
    poses[:, :dim] = q[:, :dim]
    poses[:, 3] = 1.0
    if isinstance(space, Product) and dim == 3:
        poses[:, 3:] = q[:, 3:]
    elif isinstance(space, Product):
        half = _heading(q) / 2.0
        poses[:, 3], poses[:, 6] = np.cos(half), np.sin(half)
    return poses


def as_pose_pair(a: Floats, b: Floats, space: Space) -> tuple[Floats, Floats]:
    """Return start and end poses whose quaternions have signs such that the shorter arc is the space's path."""
    first, second = as_poses(a, space), as_poses(b, space)
    if not isinstance(space, Product):
        return first, second
    if body_dimension(space) == 3:
        p, q = first[:, 3:].T, second[:, 3:].T
        other_sign = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0.0
    else:
        # Exactly opposite headings: their quaternions' product is zero up to rounding and decides nothing.
        other_sign = np.abs(_heading(b) - _heading(a)) > np.pi
    second[other_sign, 3:] *= -1.0
    return first, second


def _heading(q: Floats) -> Floats:
    """Return the headings of planar poses in [-pi, pi)."""
    return Circle().wrapped(q[:, 2:])[:, 0]
