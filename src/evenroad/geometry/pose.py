"""Poses: one convention for the whole package.

A rotation is the nine numbers of its matrix, row by row (four in the plane).  Quaternions are (x, y, z, w) as in SciPy
and ROS, angles radians, lengths metres.  A pose maps points of its own frame to its parent frame.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_row
from evenroad._hints import KnowsElsewhere
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.rotation import (
    BY_KEYWORD,
    NO_ROTATION,
    as_rotation,
    rotation_from_quaternion,
    rotation_from_rpy,
)

Vector = tuple[float, float, float]


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
class Pose(metaclass=KnowsElsewhere):
    """A rotation, then a translation: ``p -> R p + xyz``.

    Parameters
    ----------
    xyz : sequence of 3 floats
        Origin of the pose's own frame [m].
    rotation : sequence of 9 floats, or ndarray, shape (3, 3)
        Rotation of that frame, row by row.
    rpy : sequence of 3 floats
        In place of `rotation`: roll, pitch and yaw as in URDF [rad].
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
            raise InvalidValue("xyz must be 3 finite numbers; a 4x4 matrix is taken by Pose.from_matrix(matrix)")
        if rotation is not NO_ROTATION and np.size(rotation) == 4:
            raise InvalidValue(BY_KEYWORD)
        if rpy is not None:
            rotation = rotation_from_rpy(*as_row("rpy", rpy, 3))
        elif xyzw is not None:
            rotation = rotation_from_quaternion(xyzw=xyzw)
        elif rotation is not NO_ROTATION:
            rotation = as_rotation(rotation.ravel().tolist() if isinstance(rotation, np.ndarray) else rotation)
        set_fields(self, xyz=_three(xyz), rotation=rotation)

    def __repr__(self) -> str:
        roll, pitch, yaw = self.rpy
        turned = "" if self.rotation == NO_ROTATION else f", rpy=({roll:.6g}, {pitch:.6g}, {yaw:.6g})"
        return f"{type(self).__name__}(({', '.join(f'{value:.6g}' for value in self.xyz)}){turned})"

    @classmethod
    def from_rpy(cls, xyz: Sequence[float], rpy: Sequence[float]) -> Pose:
        """Return the pose of an origin, and roll, pitch and yaw.

        Parameters
        ----------
        xyz, rpy : sequences of 3 floats
            The origin [m], and the angles as in URDF [rad].

        Returns
        -------
        Pose

        Examples
        --------
        >>> import evenroad as er
        >>> er.Pose.from_rpy((0, 0, 1), (0, 0, 1.5))
        Pose((0, 0, 1), rpy=(0, 0, 1.5))
        """
        roll, pitch, yaw = as_row("rpy", rpy, 3)
        return cls._made(xyz, rotation_from_rpy(roll, pitch, yaw))

    @classmethod
    def from_quaternion(cls, xyz: Sequence[float], *guessed: object, xyzw: Sequence[float] = ()) -> Pose:
        """Return the pose of an origin and a quaternion.

        Parameters
        ----------
        xyz : sequence of 3 floats
            The origin [m].
        xyzw : sequence of 4 floats
            A quaternion of any norm > 0, in the order of SciPy and ROS.

        Returns
        -------
        Pose

        Raises
        ------
        InvalidValue
            If the quaternion is given without its keyword, or is not four numbers.

        Examples
        --------
        >>> import evenroad as er
        >>> er.Pose.from_quaternion((0, 0, 1), xyzw=(0, 0, 1, 1)).apply((1, 0, 0)).round(6).tolist()
        [0.0, 1.0, 1.0]
        """
        return cls._made(xyz, rotation_from_quaternion(*guessed, xyzw=xyzw))

    @classmethod
    def from_matrix(cls, matrix: npt.ArrayLike) -> Pose:
        """Return the pose of a homogeneous matrix.

        Parameters
        ----------
        matrix : array_like, shape (4, 4)
            A rotation and an origin [m]; the last row is 0, 0, 0, 1.

        Returns
        -------
        Pose

        Raises
        ------
        InvalidValue
            If it is no such matrix.

        Examples
        --------
        >>> import numpy as np
        >>> import evenroad as er
        >>> er.Pose.from_matrix(np.eye(4))
        Pose((0, 0, 0))
        """
        try:
            array = np.asarray(matrix, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidValue(f"a pose must be a 4x4 matrix of numbers, got {matrix!r}") from None
        if array.shape != (4, 4) or not np.array_equal(array[3], [0.0, 0.0, 0.0, 1.0]):
            raise InvalidValue(f"a pose must be a 4x4 matrix with the last row 0, 0, 0, 1, got {matrix!r}")
        return cls(_three(array[:3, 3].tolist()), tuple(array[:3, :3].ravel().tolist()))

    @classmethod
    def _made(cls, xyz: Sequence[float], rotation: tuple[float, ...]) -> Pose:
        """Return a pose without checking its rotation, which takes longest."""
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
        # Four times the squares of x, y, z and w. Division by the largest loses no digits.
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
        """Return points of the pose's own frame in its parent frame.

        Parameters
        ----------
        points : array_like, shape (3,) or (n, 3)
            In metres.

        Returns
        -------
        ndarray, shape (3,) or (n, 3)

        Examples
        --------
        >>> import evenroad as er
        >>> er.Pose((0, 0, 1)).apply((1, 0, 0)).tolist()
        [1.0, 0.0, 1.0]
        """
        p: Floats = _rows_of_three(points)
        if self.rotation != NO_ROTATION:
            p = self.rotation_matrix @ p if p.ndim == 1 else p @ self.rotation_matrix.T
        moved: Floats = p + np.array(self.xyz)
        return moved

    def local(self, points: npt.ArrayLike) -> Floats:
        """Return points in the pose's own frame, the inverse of :meth:`apply`.

        Parameters
        ----------
        points : array_like, shape (3,) or (n, 3)
            In metres.

        Returns
        -------
        ndarray, shape (3,) or (n, 3)

        Examples
        --------
        >>> import evenroad as er
        >>> er.Pose((0, 0, 1)).local((1, 0, 1)).tolist()
        [1.0, 0.0, 0.0]
        """
        p: Floats = _rows_of_three(points) - np.array(self.xyz)
        own: Floats = self.rotation_matrix.T @ p if p.ndim == 1 else p @ self.rotation_matrix
        return own

    def inverse(self) -> Pose:
        """Return the inverse pose."""
        rotation = self.rotation_matrix.T
        return Pose(_three((-rotation @ np.array(self.xyz)).tolist()), tuple(rotation.ravel().tolist()))

    def __matmul__(self, other: Pose) -> Pose:
        """Return the pose that applies `other` first, then this one."""
        if not isinstance(other, Pose):
            raise InvalidValue(
                f"a pose is multiplied with a Pose, such as Pose.from_matrix(matrix), got {shown(other)}"
            )
        rotation = self.rotation_matrix @ other.rotation_matrix
        return Pose(_three(self.apply(other.xyz).tolist()), tuple(rotation.ravel().tolist()))


IDENTITY = Pose()
