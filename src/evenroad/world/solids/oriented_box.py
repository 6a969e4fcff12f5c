"""OrientedBox: a box or rectangle, turned as one likes, in the plane or in space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.space.axes import as_row
from evenroad.world.solids.turns import as_turn


@dataclass(frozen=True)
class OrientedBox:
    """All points ``centre + rotation x`` with ``|x_i| <= half_extents_i``.

    A half extent of zero is allowed: in space the box is then a rectangle, a piece of a surface.

    Parameters
    ----------
    centre : sequence of 2 or 3 floats
        Its middle; as many numbers as the plane or space has dimensions.
    half_extents : sequence of as many floats
        Half of its lengths along its own axes, >= 0.
    rotation : sequence of 4 or 9 floats, optional
        From the box's own axes to those of the frame that `centre` is in, the rows of the matrix one after the
        other (:func:`heading_turn` and :func:`quaternion_turn` make them); default: not turned.
    name : str
        What explanations call it.

    Raises
    ------
    InvalidValue
        If the numbers are not such.
    """

    centre: Sequence[float]
    half_extents: Sequence[float]
    rotation: Sequence[float] | None = None
    name: str = ""

    def __post_init__(self) -> None:
        centre = as_row("centre", self.centre)
        if len(centre) not in (2, 3):
            raise InvalidValue(f"centre must be 2 or 3 finite numbers, got {self.centre!r}")
        half_extents = as_row("half_extents", self.half_extents, len(centre))
        if min(half_extents) < 0.0:
            raise InvalidValue(f"half_extents must be >= 0, got {self.half_extents!r}")
        rotation = as_turn(self.rotation, len(centre))
        for field, value in (("centre", centre), ("half_extents", half_extents), ("rotation", rotation)):
            object.__setattr__(self, field, value)

    @classmethod
    def spanning(cls, low: Sequence[float], high: Sequence[float], name: str = "") -> OrientedBox:
        """Return the box, not turned, that reaches from `low` to `high`; equal numbers make it flat.

        Raises
        ------
        InvalidValue
            If the two are not 2 or 3 finite numbers each with ``low <= high``.
        """
        lows = as_row("low", low)
        highs = as_row("high", high, len(lows))
        if any(least > most for least, most in zip(lows, highs, strict=True)):
            raise InvalidValue(f"low must not exceed high, got {low!r} and {high!r}")
        centre = [(least + most) / 2.0 for least, most in zip(lows, highs, strict=True)]
        half_extents = [(most - least) / 2.0 for least, most in zip(lows, highs, strict=True)]
        return cls(centre, half_extents, name=name)

    @property
    def dim(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.centre)

    @property
    def matrix(self) -> npt.NDArray[np.float64]:
        """The rotation as a matrix, (dim, dim)."""
        return np.array(self.rotation).reshape(self.dim, self.dim)

    @property
    def corners(self) -> npt.NDArray[np.float64]:
        """The corners, (2^dim, dim)."""
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * self.dim, indexing="ij")).reshape(self.dim, -1).T
        return np.array(self.centre) + (signs * np.array(self.half_extents)) @ self.matrix.T


def shell(box: OrientedBox) -> tuple[OrientedBox, ...]:
    """Return the surface of a box in space, as six rectangles: a body that fits may be inside.

    Raises
    ------
    InvalidValue
        If the box lies in the plane.
    """
    if box.dim != 3:
        raise InvalidValue("only boxes in space have a shell of rectangles")
    rectangles = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            centre = np.array(box.centre) + sign * box.half_extents[axis] * box.matrix[:, axis]
            half_extents = [0.0 if k == axis else extent for k, extent in enumerate(box.half_extents)]
            rectangles.append(OrientedBox(centre.tolist(), half_extents, box.rotation, box.name))
    return tuple(rectangles)
