"""Rotations and poses: one convention for the whole package.

A rotation is the nine numbers of its matrix, row by row (four in the plane).  Quaternions are (x, y, z, w), as
SciPy and ROS have them, angles radians, lengths metres.  A pose takes points of its own frame to the frame that it is
given in.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from operator import mul
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_row
from evenroad.errors import InvalidValue, shown

Vector = tuple[float, float, float]
NO_ROTATION = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_ORTHONORMAL = 1e-6
"""Largest error of the products of a rotation's rows: a margin for matrices read from text."""
_BY_KEYWORD = "a quaternion must be given as xyzw=(x, y, z, w), by its keyword: others have w first"


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
    """Return the rotation of a quaternion `xyzw`, which need not be of norm 1, as (9,) rows.

    It goes by its keyword, since others have w first.  Raises InvalidValue if it does not, is not four finite numbers
    x, y, z, w, or its norm is 0.
    """
    if guessed:
        raise InvalidValue(_BY_KEYWORD)
    x, y, z, w = as_row("quaternion xyzw", xyzw, 4)
    norm = math.hypot(w, x, y, z)
    if norm == 0.0:
        raise InvalidValue("quaternion must have a norm > 0, got zeros")
    return _of_unit_quaternion(w / norm, x / norm, y / norm, z / norm)


def rotations_from_quaternions(quaternions: Floats) -> Floats:
    """Return the matrices, (n, 3, 3), of rows of SO3, (n, 4): quaternions with w first, here of any norm > 0."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    return np.stack(_of_unit_quaternion(w, x, y, z), axis=1).reshape(-1, 3, 3)


def _of_unit_quaternion(w: Any, x: Any, y: Any, z: Any) -> tuple[Any, ...]:
    """Return the nine numbers of the rotation, row by row; of numbers or of arrays."""
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


def rotation_from_z(axis: Sequence[float]) -> Floats:
    """Return a rotation (3, 3) that takes the z axis to `axis`; InvalidValue if that has no direction."""
    z = np.array(axis, dtype=np.float64)
    length = float(np.linalg.norm(z))
    if not (math.isfinite(length) and length > 0.0):
        raise InvalidValue(f"an axis must be a direction, got {axis!r}")
    z /= length
    if z[0] == 0.0 and z[1] == 0.0 and z[2] > 0.0:
        return np.eye(3)
    # The coordinate axis farthest from z: never near parallel to it.
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


def _three(xyz: Sequence[float]) -> Vector:
    x, y, z = as_row("xyz", xyz, 3, within=FARTHEST)
    return x, y, z


def _rows_of_three(points: npt.ArrayLike) -> Floats:
    try:
        array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim not in (1, 2) or array.shape[-1] != 3:
        raise InvalidValue(f"points must be numbers of shape (3,) or (n, 3), got {shown(points)}")
    return array


@explains_calls
@dataclass(frozen=True, init=False, repr=False)
class Pose:
    """A rotation, then a translation: ``p -> R p + xyz``.

    Parameters
    ----------
    xyz : sequence of 3 floats
        Origin of the pose's own frame [m].
    rotation : sequence of 9 floats, or ndarray, shape (3, 3)
        From that frame, row by row.
    rpy : sequence of 3 floats
        In place of `rotation`: roll, pitch and yaw [rad] as URDF has them.
    xyzw : sequence of 4 floats
        In place of `rotation`: a quaternion of any norm > 0, in the order of SciPy and ROS.

    Raises
    ------
    InvalidValue
        If these are not finite numbers, the rotation is none, or it is given twice.

    Examples
    --------
    >>> import evenroad as er
    >>> er.Pose((0.5, 0.2, 0.4), rpy=(3.14159, 0, 0))
    Pose((0.5, 0.2, 0.4), rpy=(3.14159, 0, 0))
    """

    xyz: Vector
    rotation: tuple[float, ...]

    def __init__(
        self,
        xyz: Sequence[float] = (0.0, 0.0, 0.0),
        rotation: Sequence[float] | Floats = NO_ROTATION,
        *,
        rpy: Sequence[float] | None = None,
        xyzw: Sequence[float] | None = None,
    ) -> None:
        if (rotation is not NO_ROTATION) + (rpy is not None) + (xyzw is not None) > 1:
            raise InvalidValue("a pose must have one of rotation, rpy and xyzw, got more than one")
        if isinstance(xyz, np.ndarray) and xyz.ndim == 2:
            raise InvalidValue(
                "xyz must be 3 finite numbers; a 4x4 matrix is taken by Pose.from_matrix(matrix)"
            )
        if rotation is not NO_ROTATION and np.size(rotation) == 4:
            raise InvalidValue(_BY_KEYWORD)
        if rpy is not None:
            rotation = rotation_from_rpy(*as_row("rpy", rpy, 3))
        elif xyzw is not None:
            rotation = rotation_from_quaternion(xyzw=xyzw)
        elif rotation is not NO_ROTATION:
            rotation = as_rotation(
                rotation.ravel().tolist() if isinstance(rotation, np.ndarray) else rotation
            )
        set_fields(self, xyz=_three(xyz), rotation=rotation)

    def __repr__(self) -> str:
        roll, pitch, yaw = self.rpy
        turned = "" if self.rotation == NO_ROTATION else f", rpy=({roll:.6g}, {pitch:.6g}, {yaw:.6g})"
        return f"{type(self).__name__}(({', '.join(f'{value:.6g}' for value in self.xyz)}){turned})"

    @classmethod
    def from_rpy(cls, xyz: Sequence[float], rpy: Sequence[float]) -> Pose:
        """Return the pose of an origin [m], and roll, pitch and yaw [rad] as URDF has them."""
        roll, pitch, yaw = as_row("rpy", rpy, 3)
        return cls._made(xyz, rotation_from_rpy(roll, pitch, yaw))

    @classmethod
    def from_quaternion(cls, xyz: Sequence[float], *guessed: object, xyzw: Sequence[float] = ()) -> Pose:
        """Return the pose of an origin [m] and a quaternion `xyzw`, by its keyword, of any norm > 0.

        The order is that of SciPy and ROS.  Raises as :func:`rotation_from_quaternion`.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Pose.from_quaternion((0, 0, 1), xyzw=(0, 0, 1, 1)).apply((1, 0, 0)).round(6).tolist()
        [0.0, 1.0, 1.0]
        """
        return cls._made(xyz, rotation_from_quaternion(*guessed, xyzw=xyzw))

    @classmethod
    def from_matrix(cls, matrix: npt.ArrayLike) -> Pose:
        """Return the pose of a 4x4 matrix, whose last row must be 0, 0, 0, 1."""
        try:
            array = np.asarray(matrix, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidValue(f"a pose must be a 4x4 matrix of numbers, got {matrix!r}") from None
        if array.shape != (4, 4) or not np.array_equal(array[3], [0.0, 0.0, 0.0, 1.0]):
            raise InvalidValue(f"a pose must be a 4x4 matrix with the last row 0, 0, 0, 1, got {matrix!r}")
        return cls(_three(array[:3, 3].tolist()), tuple(array[:3, :3].ravel().tolist()))

    @classmethod
    def _made(cls, xyz: Sequence[float], rotation: tuple[float, ...]) -> Pose:
        """Return a pose whose rotation is one: to check that takes longest."""
        pose = object.__new__(cls)
        set_fields(pose, xyz=_three(xyz), rotation=rotation)
        return pose

    @property
    def rotation_matrix(self) -> Floats:
        """The rotation as a matrix, (3, 3)."""
        return np.array(self.rotation).reshape(3, 3)

    @property
    def rpy(self) -> Vector:
        """Roll, pitch and yaw of the rotation [rad]; at a pitch of ±pi/2 the roll is 0."""
        (xx, xy, _), (yx, yy, _), (zx, zy, zz) = (self.rotation[i : i + 3] for i in (0, 3, 6))
        flat = math.hypot(xx, yx)
        if flat < 1e-9:
            return 0.0, math.atan2(-zx, flat), math.atan2(-xy, yy)
        return math.atan2(zy, zz), math.atan2(-zx, flat), math.atan2(yx, xx)

    @property
    def xyzw(self) -> tuple[float, float, float, float]:
        """The rotation as a quaternion of norm 1, in the order of SciPy and ROS; w >= 0."""
        (a, b, c), (d, e, f), (g, h, i) = (self.rotation[k : k + 3] for k in (0, 3, 6))
        # Four times the squares of x, y, z and w: the largest is divided by, which loses nothing.
        squares = (1.0 + a - e - i, 1.0 - a + e - i, 1.0 - a - e + i, 1.0 + a + e + i)
        rows = (
            (squares[0], b + d, c + g, h - f),
            (b + d, squares[1], f + h, c - g),
            (c + g, f + h, squares[2], d - b),
            (h - f, c - g, d - b, squares[3]),
        )
        row = rows[squares.index(max(squares))]
        norm = math.copysign(math.hypot(*row), row[3])
        x, y, z, w = (value / norm for value in row)
        return x, y, z, w

    @property
    def matrix(self) -> Floats:
        """The pose as a matrix, (4, 4)."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.rotation_matrix, self.xyz
        return matrix

    def apply(self, points: npt.ArrayLike) -> Floats:
        """Return points of the own frame, (3,) or (n, 3), in the frame that the pose is given in."""
        p = _rows_of_three(points)
        return (self.rotation_matrix @ p if p.ndim == 1 else p @ self.rotation_matrix.T) + np.array(self.xyz)

    def local(self, points: npt.ArrayLike) -> Floats:
        """Return points, (3,) or (n, 3), in the pose's own frame: what undoes :meth:`apply`."""
        p = _rows_of_three(points) - np.array(self.xyz)
        return self.rotation_matrix.T @ p if p.ndim == 1 else p @ self.rotation_matrix

    def inverse(self) -> Pose:
        """Return the pose that undoes this one."""
        rotation = self.rotation_matrix.T
        return Pose(_three((-rotation @ np.array(self.xyz)).tolist()), tuple(rotation.ravel().tolist()))

    def __matmul__(self, other: Pose) -> Pose:
        """Return the pose that applies `other` first, then this one."""
        if not isinstance(other, Pose):
            raise InvalidValue(
                f"a pose times a Pose, as Pose.from_matrix(matrix), is a pose, got {shown(other)}"
            )
        rotation = self.rotation_matrix @ other.rotation_matrix
        return Pose(_three(self.apply(other.xyz).tolist()), tuple(rotation.ravel().tolist()))


IDENTITY = Pose()
