"""MapFrame: the transform between the pixels of a map and the plane."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_count, require_positive
from evenroad.errors import InvalidValue
from evenroad.space import Rectangle


@dataclass(frozen=True, kw_only=True)
class MapFrame:
    """The transform between pixels and map coordinates.

    Pixel (column c, row r), row 0 on top, is the square [c, c+1] x [r, r+1] of the pixel plane.  Two conventions map
    that plane to the map:

    * ``y_up=False``, a bare image: x to the right, y DOWN, `origin` is the image's top-left corner;
    * ``y_up=True``, a ROS map: `origin` is the lower-left corner of the lower-left pixel, y up along the
      image's left side, the whole image rotated by `yaw` (anticlockwise, radians) about `origin`.

    `rows` and `cols` are the image's size in pixels, `resolution` the side of a pixel in map units (metres in a ROS
    map), as `origin` is.  InvalidValue if a size is not positive, or a number is not finite.
    """

    rows: int
    cols: int
    resolution: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)
    yaw: float = 0.0
    y_up: bool = False

    def __post_init__(self) -> None:
        require_count("rows", self.rows)
        require_count("cols", self.cols)
        require_positive("resolution", self.resolution)
        if len(self.origin) != 2 or not all(math.isfinite(value) for value in (*self.origin, self.yaw)):
            raise InvalidValue(f"origin and yaw must be finite, got {self.origin!r} and {self.yaw!r}")
        if self.yaw != 0.0 and not self.y_up:
            raise InvalidValue(f"a frame with y down cannot be rotated: yaw must be 0, got {self.yaw!r}")

    @cached_property
    def rectangle(self) -> Rectangle:
        """The image's outline in the map: the cube's origin goes to `origin`, its axes along the image's."""
        width, height = self.cols * self.resolution, self.rows * self.resolution
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        return Rectangle(
            corner=self.origin,
            edge_u=(width * cosine, width * sine),
            edge_v=(-height * sine, height * cosine),
        )

    def coefficients(self) -> Floats:
        """Return the origin, the map directions of increasing column and row, the resolution, and the origin's row.

        A point's column is ``(q - origin) . direction / resolution``.  Subtracting first and dividing last keeps round
        numbers exact, so that a disk that just touches an obstacle is recognised as free.
        """
        cosine, sine = math.cos(self.yaw), math.sin(self.yaw)
        if not self.y_up:
            return np.array([*self.origin, 1.0, 0.0, 0.0, 1.0, self.resolution, 0.0])
        return np.array([*self.origin, cosine, sine, sine, -cosine, self.resolution, float(self.rows)])

    def to_pixels(self, q: Floats) -> Floats:
        """Return the pixel coordinates (column, row), (n, 2), of the map points `q`, (n, 2)."""
        x0, y0, column_x, column_y, row_x, row_y, scale, first_row = self.coefficients()
        # Points that are extremely far away may overflow. Infinite or NaN coordinates also mean outside.
        with np.errstate(over="ignore", invalid="ignore"):
            x, y = q[:, 0] - x0, q[:, 1] - y0
            column = (column_x * x + column_y * y) / scale
            row = first_row + (row_x * x + row_y * y) / scale
        return np.column_stack([column, row])

    def to_map(self, pixels: Floats) -> Floats:
        """Return the map points, (n, 2), at pixel coordinates (column, row), (n, 2)."""
        x0, y0, column_x, column_y, row_x, row_y, scale, first_row = self.coefficients()
        column, row = pixels[:, 0] * scale, (pixels[:, 1] - first_row) * scale
        return np.column_stack([x0 + column_x * column + row_x * row, y0 + column_y * column + row_y * row])
