"""Rotation matrices, as rows one after the other, of headings and quaternions."""

from __future__ import annotations

import math
from collections.abc import Sequence

from evenroad.errors import InvalidValue
from evenroad.space.axes import as_row

_ORTHONORMAL = 1e-6
"""How far products of rows may be from those of a rotation: room for matrices read from text."""


def heading_turn(heading: float) -> tuple[float, ...]:
    """Return the turn of the plane by `heading` radians, counter-clockwise, as (4,) rows.

    Raises
    ------
    InvalidValue
        If `heading` is not a finite number.
    """
    (angle,) = as_row("heading", [heading])
    return (math.cos(angle), -math.sin(angle), math.sin(angle), math.cos(angle))


def quaternion_turn(quaternion: Sequence[float]) -> tuple[float, ...]:
    """Return the turn of space by a quaternion (w, x, y, z), which need not be of norm 1, as (9,) rows.

    Raises
    ------
    InvalidValue
        If it is not four finite numbers, or its norm is 0.
    """
    row = as_row("quaternion", quaternion, 4)
    norm = math.hypot(*row)
    if norm == 0.0:
        raise InvalidValue("quaternion must have a norm > 0, got zeros")
    w, x, y, z = (number / norm for number in row)
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip


def as_turn(rotation: Sequence[float] | None, dim: int) -> tuple[float, ...]:
    """Return `rotation` as the (dim * dim,) rows of a rotation matrix; None stands for no turn.

    Raises
    ------
    InvalidValue
        If it is not so many finite numbers, its rows are not perpendicular and of length 1 up to 1e-6, or it
        is a reflection.
    """
    if rotation is None:
        return tuple(1.0 if i == j else 0.0 for i in range(dim) for j in range(dim))
    numbers = as_row("rotation", rotation, dim * dim)
    rows = [numbers[i * dim : (i + 1) * dim] for i in range(dim)]
    for i in range(dim):
        for j in range(dim):
            product = sum(a * b for a, b in zip(rows[i], rows[j], strict=True))
            if abs(product - (1.0 if i == j else 0.0)) > _ORTHONORMAL:
                raise InvalidValue(f"rotation must have perpendicular rows of length 1, got {rotation!r}")
    if _determinant(rows) < 0.0:
        raise InvalidValue(f"rotation must not be a reflection, got {rotation!r}")
    return numbers


def _determinant(rows: list[tuple[float, ...]]) -> float:
    if len(rows) == 2:
        return rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
