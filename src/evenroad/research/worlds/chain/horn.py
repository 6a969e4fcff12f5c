"""The horn: two bent walls, between which the chain has to fold itself."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt


def horn(links: int) -> npt.NDArray[np.float64]:
    """Return the walls for a chain of so many links, (4, 2 (links - 1)): a column x, y, dx, dy for each segment.

    The scene "horn" of OMPL's kinematic chain benchmark.  With ``eps = ln(10) / links`` and s = 1, then -1: a chain of
    segments from ``(1 / links, -s eps)``, of length ``(1 / links) (1 + s pi eps)`` and headings ``i pi / links``,
    i = 1 .. links - 1.
    """
    eps = math.log(10.0) / links
    segments = []
    for side in (1.0, -1.0):
        x, y = 1.0 / links, -side * eps
        length = (1.0 + side * math.pi * eps) / links
        for i in range(1, links):
            heading = i * math.pi / links
            along_x, along_y = length * math.cos(heading), length * math.sin(heading)
            segments.append((x, y, along_x, along_y))
            x, y = x + along_x, y + along_y
    return np.ascontiguousarray(np.array(segments).T)
