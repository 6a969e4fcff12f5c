"""Hexagonal pillars, of three boxes each."""

from __future__ import annotations

import math

from evenroad.geometry import rotation_from_heading
from evenroad.world.solids import OrientedBox

Range = tuple[float, float]

_ANGLES = 600
"""Headings among which the best is looked for; a hexagon looks the same after 60 degrees."""


def pillar(x: Range, y: Range, z: Range) -> tuple[OrientedBox, ...]:
    """Return the regular hexagon that fills the ranges of x and y best, over the range of z, as three boxes.

    A regular hexagon is the union of the three rectangles that two opposite sides span.
    """
    side, heading = _hexagon(x[1] - x[0], y[1] - y[0])
    middle = [(low + high) / 2.0 for low, high in (x, y, z)]
    half = [side * math.sqrt(3.0) / 2.0, side / 2.0, (z[1] - z[0]) / 2.0]
    boxes = []
    for k in range(3):
        a, b, c, d = rotation_from_heading(heading + (k + 0.5) * math.pi / 3.0)
        boxes.append(OrientedBox(middle, half, (a, b, 0.0, c, d, 0.0, 0.0, 0.0, 1.0), name="pillar"))
    return tuple(boxes)


def _hexagon(width: float, depth: float) -> tuple[float, float]:
    """Return the side of the regular hexagon that is so wide and deep, and the heading of one of its corners.

    A corner with the heading h is ``side cos h`` to the right, so that each heading asks for one side to be as wide
    and for another to be as deep; the heading where the two agree best is taken, and their mean.
    """
    best = (math.inf, 0.0, 0.0)
    for number in range(_ANGLES + 1):
        heading = number / _ANGLES * math.pi / 3.0
        corners = [heading + k * math.pi / 3.0 for k in range(6)]
        side_x = width / 2.0 / max(math.cos(corner) for corner in corners)
        side_y = depth / 2.0 / max(math.sin(corner) for corner in corners)
        best = min(best, (abs(side_x - side_y), (side_x + side_y) / 2.0, heading))
    return best[1], best[2]
