"""Rotations of space and of the plane, from angles, quaternions and matrices, as the rows of a matrix."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from operator import mul

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import as_row
from evenroad.errors import InvalidValue

NO_ROTATION = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_ORTHONORMAL = 1e-6
"""Largest error of the products of a rotation's rows: a margin for matrices read from text."""
BY_KEYWORD = "a quaternion must be given as xyzw=(x, y, z, w), by its keyword: others have w first"
"""Message about a quaternion without its keyword."""


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> tuple[float, ...]:
    """Return ``Rz(yaw) Ry(pitch) Rx(roll)``, the convention of URDF, for angles in radians."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(angle), math.cos(angle)) for angle in (roll, pitch, yaw))
    return (
        *(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        *(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        *(-sp, cp * sr, cp * cr),
    )


def rotation_from_heading(heading: float) -> tuple[float, ...]:
    """Return the rotation of the plane by `heading` radians, counter-clockwise, as (4,) rows.

    Raises InvalidValue if `heading` is not a finite number.
    """
    (angle,) = as_row("heading", [heading])
    return (math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle))


def rotation_from_quaternion(*guessed: object, xyzw: Sequence[float] = ()) -> tuple[float, ...]:
    """Return the rotation of a quaternion `xyzw` of any norm > 0, as (9,) rows.

    Raises InvalidValue if it has no keyword, since others have w first, or is not four finite numbers x, y, z, w.
    """
    if guessed:
        raise InvalidValue(BY_KEYWORD)
    x, y, z, w = as_row("quaternion xyzw", xyzw, 4)
    norm = math.hypot(w, x, y, z)
    if norm == 0.0:
        raise InvalidValue("quaternion must have a norm > 0, got zeros")
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


def rotation_from_z(axis: Sequence[float]) -> Floats:
    """Return a rotation (3, 3) that takes the z axis to `axis`; InvalidValue if that has no direction."""
    return _from_z(tuple(map(float, axis))).copy()


@lru_cache(maxsize=1024)
def _from_z(axis: tuple[float, ...]) -> Floats:
    z = np.array(axis, dtype=np.float64)
    length = float(np.linalg.norm(z))
    if not (math.isfinite(length) and length > 0.0):
        raise InvalidValue(f"an axis must be a direction, got {axis!r}")
    z /= length
    if z[0] == 0.0 and z[1] == 0.0 and z[2] > 0.0:
        return np.eye(3)
    # The coordinate axis farthest from z is never nearly parallel to it.
    x = np.cross(np.eye(3)[np.abs(z).argmin()], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def as_rotation(rotation: Sequence[float] | None, dim: int = 3) -> tuple[float, ...]:
    """Return `rotation` as the (dim * dim,) rows of a rotation matrix, up to 1e-6; None is the identity.

    Raises InvalidValue if it is no rotation, or a reflection.
    """
    if rotation is None:
        return tuple(1.0 if i == j else 0.0 for i in range(dim) for j in range(dim))
    numbers = as_row("rotation", rotation, dim * dim)
    rows = [numbers[i * dim : (i + 1) * dim] for i in range(dim)]
    for i, row in enumerate(rows):
        for j in range(i, dim):
            if abs(sum(map(mul, row, rows[j])) - (i == j)) > _ORTHONORMAL:
                raise InvalidValue(f"rotation must have perpendicular rows of length 1, got {rotation!r}")
    if _determinant(rows) < 0.0:
        raise InvalidValue(f"rotation must not be a reflection, got {rotation!r}")
    return numbers


def _determinant(rows: list[tuple[float, ...]]) -> float:
    if len(rows) == 2:
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
