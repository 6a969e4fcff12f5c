"""A sheet of views side by side, drawn with Pillow, which loads and draws in a fifth of Matplotlib's time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from evenroad._arrays import Floats

FINER = 2
"""Factor by which bodies are drawn larger, then shrunk, so that their edges are smooth."""
TEXT, GRID = "#000000", "#e3e9ee"
_LEFT, _BETWEEN, _TOP, _BOTTOM = 95, 105, 105, 125
"""Margins in pixels; ticks and labels of a view are left of it and below."""
Faint = tuple[int, int, int, int]
Colour = tuple[int, int, int] | Faint | str


class View:
    """What is seen along one axis, between the corners `low` and `high`, (2,) each, in metres or map units.

    It has `scale` pixels a metre; y points up, or down.  Its ``image`` is `FINER` times as large as it is shown.
    """

    def __init__(self, low: Floats, high: Floats, scale: float, *, up: bool = True) -> None:
        self.low, self.high, self.up, self.shown_scale = low, high, up, scale
        self.scale = FINER * scale
        width, height = (FINER * max(1, round(side / FINER)) for side in self.scale * (high - low))
        self.image = Image.new("RGB", (width, height), "white")
        self._draw = ImageDraw.Draw(self.image, "RGBA")
        for axis in (0, 1):
            for tick in ticks(low[axis], high[axis]):
                endpoints = np.array([low, high])
                endpoints[:, axis] = tick
                self.line(endpoints, GRID, 1)

    def pixels(self, points: Floats) -> list[tuple[float, float]]:
        """Return where points, (n, 2), lie in the image, whose y points down."""
        x, y = (self.scale * (points - self.low)).T
        return list(zip(x.tolist(), (self.image.height - y if self.up else y).tolist(), strict=True))

    def positions(self, pixels: Floats) -> Floats:
        """Return where pixels, (n, 2), of the image lie: the inverse of `pixels`."""
        x, y = pixels.T
        return self.low + np.stack([x, self.image.height - y if self.up else y], axis=1) / self.scale

    def polygon(self, outline: Floats, fill: Colour, edge: Colour, width: float = 1.0) -> None:
        """Draw an area, (n, 2), with its edge."""
        self._draw.polygon(self.pixels(outline), fill=fill)
        self.line(np.vstack([outline, outline[:1]]), edge, width)

    def line(self, points: Floats, colour: Colour, width: float) -> None:
        """Draw a line through points, (n, 2)."""
        self._draw.line(self.pixels(points), fill=colour, width=round(FINER * width), joint="curve")

    def circle(
        self, centre: Floats, radius: float, fill: Colour | None, edge: Colour | None = None, width: float = 1.0
    ) -> None:
        """Draw a disk or its edge, of a radius in metres."""
        at, most = self.pixels(centre[np.newaxis])[0], self.scale * radius
        self._draw.circle(at, most, fill, edge, round(FINER * width))

    def balls(self, points: Floats, radius: float, fill: Faint, edge: Faint) -> None:
        """Fill all that is within `radius` of points, (n, 2), and mark the points themselves."""
        from scipy.ndimage import distance_transform_edt

        width, height = self.image.size
        columns, rows = np.rint(np.array(self.pixels(points)).T).astype(np.int64)
        shown = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
        if not shown.any():
            return
        away = np.ones((height, width), dtype=np.bool_)
        away[rows[shown], columns[shown]] = False
        within = distance_transform_edt(away) <= max(self.scale * radius, 1.0)
        for mask, colour in ((within, fill), (~away, edge)):
            self.image.paste(colour[:3], mask=Image.fromarray((mask * colour[3]).astype(np.uint8)))

    def polygons(self, outlines: Floats, fill: Faint, edge: Faint) -> None:
        """Fill the union of areas, (n, corners, 2), and mark their edges."""
        size = self.image.size
        masks = Image.new("L", size), Image.new("L", size)
        draws = [ImageDraw.Draw(mask) for mask in masks]
        for outline in outlines:
            corners = self.pixels(outline)
            draws[0].polygon(corners, fill=fill[3])
            draws[1].line([*corners, corners[0]], fill=edge[3])
        for mask, colour in zip(masks, (fill, edge), strict=True):
            self.image.paste(colour[:3], mask=mask)

    def dot(self, position: Floats, colour: Colour, radius: float) -> None:
        """Draw a dot with a white rim."""
        for size, fill in ((radius + 1, "white"), (radius, colour)):
            self._draw.circle(self.pixels(position[np.newaxis])[0], FINER * size, fill=fill)


def ticks(low: float, high: float) -> Floats:
    """Return round numbers between two, about five of them."""
    least = (high - low) / 6.0
    power = 10.0 ** math.floor(math.log10(least))
    step = next(each * power for each in (1.0, 2.0, 2.5, 5.0, 10.0) if each * power >= least)
    return np.arange(math.ceil(low / step), math.floor(high / step) + 1, dtype=np.float64) * step


class Sheet:
    """A picture of `size` pixels with a title, room for `count` views, and a legend."""

    def __init__(self, size: tuple[int, int], count: int, title: str) -> None:
        self.image = Image.new("RGB", size, "white")
        self._draw = ImageDraw.Draw(self.image, "RGBA")
        self.available = (size[0] - _LEFT + 60) // count - _BETWEEN, size[1] - _TOP - _BOTTOM
        for i, line in enumerate(wrap(title, size[0] // 11)[:3]):
            self._text((size[0] / 2, 20 + 22 * i), line, 18)

    @classmethod
    def around(cls, view: View, width: int, title: str) -> Sheet:
        """Return a sheet that has room for one view, and is at least so wide."""
        across, down = (side // FINER for side in view.image.size)
        return cls((max(width, across + _LEFT - 60 + _BETWEEN), down + _TOP + _BOTTOM), 1, title)

    def add(self, view: View, number: int, title: str, labels: tuple[str, str]) -> None:
        """Paste a view, with frame, ticks and labels."""
        image = view.image.reduce(FINER)
        left = _LEFT + number * (self.available[0] + _BETWEEN) + (self.available[0] - image.width) // 2
        top = _TOP + (self.available[1] - image.height) // 2
        right, bottom = left + image.width, top + image.height
        self.image.paste(image, (left, top))
        self._draw.rectangle((left, top, right, bottom), outline=TEXT)
        for tick in ticks(view.low[0], view.high[0]):
            x = left + view.shown_scale * (tick - view.low[0])
            self._draw.line((x, bottom, x, bottom + 5), fill=TEXT)
            self._text((x, bottom + 18), f"{round(tick, 9):g}", 16)
        for tick in ticks(view.low[1], view.high[1]):
            away = view.shown_scale * (tick - view.low[1])
            y = bottom - away if view.up else top + away
            self._draw.line((left - 5, y, left, y), fill=TEXT)
            self._text((left - 9, y), f"{round(tick, 9):g}", 16, "rm")
        self._text(((left + right) / 2, bottom + 42), labels[0], 17)
        self._text((left - 52, (top + bottom) / 2), labels[1], 17, "rm")
        self._text(((left + right) / 2, top - 16), title, 20)

    def legend(self, entries: Sequence[tuple[str, Colour, Colour | None]]) -> None:
        """Say at the bottom what has which colour: name, colour, and that of the edge; without one it is a line."""
        font = ImageFont.load_default(18)
        widths = [85 + font.getlength(name) for name, _, _ in entries]
        x, y = (self.image.width - sum(widths)) / 2, self.image.height - 30
        for (name, fill, edge), width in zip(entries, widths, strict=True):
            if edge is None:
                self._draw.line((x, y, x + 34, y), fill=fill, width=3)
            else:
                self._draw.rectangle((x, y - 7, x + 34, y + 7), fill=fill, outline=edge)
            self._text((x + 46, y), name, 18, "lm")
            x += width

    def _text(self, position: tuple[float, float], text: str, size: int, anchor: str = "mm") -> None:
        self._draw.text(position, text, fill=TEXT, font=ImageFont.load_default(size), anchor=anchor)
