"""State: where something flies, and how fast."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._arrays import set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_row
from evenroad.geometry.pose import Vector


@explains_calls
@dataclass(frozen=True)
class State:
    """A position and a velocity; to NumPy the six numbers x, y, z and those of the velocity.

    Parameters
    ----------
    xyz : sequence of 3 floats
        Position [m].
    velocity : sequence of 3 floats
        Velocity [m/s].  Default: at rest.

    Raises
    ------
    InvalidValue
        If these are not three finite numbers each.

    Examples
    --------
    >>> import evenroad as er
    >>> er.State((0, 0, 1.5), velocity=(2, 0, 0))
    State(xyz=(0.0, 0.0, 1.5), velocity=(2.0, 0.0, 0.0))
    """

    xyz: Vector
    velocity: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        set_fields(
            self,
            xyz=as_row("the position of a state", self.xyz, 3, within=FARTHEST),
            velocity=as_row("the velocity of a state", self.velocity, 3, within=FARTHEST),
        )

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.array((*self.xyz, *self.velocity), dtype=dtype)
