"""Circle: SO(2), one angle that wraps."""

from __future__ import annotations

import math
from dataclasses import dataclass

from evenroad.space.flat_space import FlatSpace


@dataclass(frozen=True)
class Circle(FlatSpace):
    """The directions of the plane, SO(2), as (n, 1) angles in radians; the metric is the angle between two.

    Any angle is taken; given back are angles in [-pi, pi).
    """

    def __post_init__(self) -> None:
        self._set_axes((-math.pi,), (math.pi,), (True,), (1.0,))
