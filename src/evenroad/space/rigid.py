"""SE2 and SE3: rigid bodies in the plane and in space, as products of a box and rotations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from evenroad.errors import InvalidValue
from evenroad.space.box import Box
from evenroad.space.circle import Circle
from evenroad.space.product import Product
from evenroad.space.so3 import SO3


def SE2(
    low: Sequence[float],
    high: Sequence[float],
    *,
    weights: Sequence[float] = (1.0, 1.0),
    combine: Literal["sum", "l2"] = "l2",
) -> Product:
    """Return the poses (x, y, heading) of a body in the plane.

    Parameters
    ----------
    low, high : sequence of two floats
        Bounds of the position.
    weights : sequence of two floats
        What a unit of length and a radian count, > 0.
    combine : {"sum", "l2"}
        How the two distances make one; with "l2" the metric is flat, so that neighbours are found in a tree.

    Raises
    ------
    InvalidValue, UnknownName
        As `Box` and `Product`.
    """
    return Product((_position(low, high, 2), Circle()), weights, combine)


def SE3(
    low: Sequence[float],
    high: Sequence[float],
    *,
    weights: Sequence[float] = (1.0, 1.0),
    combine: Literal["sum", "l2"] = "sum",
) -> Product:
    """Return the poses (x, y, z, qw, qx, qy, qz) of a body in space; points of the cube have 6 coordinates.

    Parameters
    ----------
    low, high : sequence of three floats
        Bounds of the position.
    weights : sequence of two floats
        What a unit of length and a radian of ``arccos |q . q'|`` count, > 0.
    combine : {"sum", "l2"}
        How the two distances make one; "sum" is OMPL's.

    Raises
    ------
    InvalidValue, UnknownName
        As `Box` and `Product`.
    """
    return Product((_position(low, high, 3), SO3()), weights, combine)


def _position(low: Sequence[float], high: Sequence[float], dim: int) -> Box:
    box = Box(low, high)
    if box.dim != dim:
        raise InvalidValue(f"low and high must have {dim} numbers, got {low!r} and {high!r}")
    return box
