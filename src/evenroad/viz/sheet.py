"""A sheet with a picture or a view, drawn with Pillow, which loads and draws in a fifth of Matplotlib's time."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from io import BytesIO
from textwrap import wrap

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from evenroad._arrays import Floats
from evenroad._files import atomic_write

FINER = 2
"""Factor by which bodies are drawn larger, then shrunk, so that their edges are smooth."""
TEXT, GRID = "#000000", "#e3e9ee"
_LEFT, _RIGHT, _TOP, _BOTTOM = 95, 45, 105, 125
"""Margins of a view [pixels]; its ticks and labels are left of it and below."""
Colour = tuple[int, int, int] | tuple[int, int, int, int] | str
Entry = tuple[str, Colour, Colour | None]
"""Name and colour of something in a legend, and that of its edge; without one it is a line."""


def save_png(picture: Image.Image, path: str | os.PathLike[str]) -> None:
    """Save a picture as PNG, atomically."""
    written = BytesIO()
    # By a name's end Pillow loads what writes this format alone.
    written.name = "picture.png"
    # Compressing more takes longer than drawing, for a tenth of the bytes.
    picture.save(written, compress_level=1)
    with atomic_write(path) as file:
        file.write(written.getvalue())


class View:
    """A view along one axis, between the corners `low` and `high`, (2,) each, in metres or map units.

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

    def line(self, points: Floats, colour: Colour, width: float) -> None:
        """Draw a line through points, (n, 2)."""
        self._draw.line(self.pixels(points), fill=colour, width=round(FINER * width), joint="curve")

    def circle(
        self, centre: Floats, radius: float, fill: Colour | None, edge: Colour | None = None, width: float = 1.0
    ) -> None:
        """Draw a disk or its edge, of a radius in metres."""
        at, most = self.pixels(centre[np.newaxis])[0], self.scale * radius
        self._draw.circle(at, most, fill, edge, round(FINER * width))

    def polygon(self, corners: Floats, fill: Colour | None, edge: Colour | None = None) -> None:
        """Draw a polygon, (n, 2), or its edge."""
        self._draw.polygon(self.pixels(corners), fill, edge, FINER)

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
    """A picture with a title above it and a legend below."""

    def __init__(self, size: tuple[int, int], title: str) -> None:
        self.image = Image.new("RGB", size, "white")
        self._draw = ImageDraw.Draw(self.image, "RGBA")
        for i, line in enumerate(_lines(title, size[0])):
            self._text((size[0] / 2, 20 + 22 * i), line, 18)

    @classmethod
    def of_picture(cls, picture: Image.Image, title: str, entries: Sequence[Entry]) -> Sheet:
        """Return a sheet of a picture that fills its width."""
        top = 16 + 22 * len(_lines(title, picture.width))
        sheet = cls((picture.width, top + picture.height + 48), title)
        sheet.image.paste(picture, (0, top))
        sheet._legend(entries)
        return sheet

    @classmethod
    def of_view(
        cls, view: View, least: int, title: str, above: str, labels: tuple[str, str], entries: Sequence[Entry]
    ) -> Sheet:
        """Return a sheet of a view, with frame, ticks and labels; at least so wide."""
        image = view.image.reduce(FINER)
        width = max(least, image.width + _LEFT + _RIGHT)
        sheet = cls((width, image.height + _TOP + _BOTTOM), title)
        left, top = _LEFT + (width - _LEFT - _RIGHT - image.width) // 2, _TOP
        right, bottom = left + image.width, top + image.height
        sheet.image.paste(image, (left, top))
        sheet._draw.rectangle((left, top, right, bottom), outline=TEXT)
        for tick in ticks(view.low[0], view.high[0]):
            x = left + view.shown_scale * (tick - view.low[0])
            sheet._draw.line((x, bottom, x, bottom + 5), fill=TEXT)
            sheet._text((x, bottom + 18), f"{round(tick, 9):g}", 16)
        for tick in ticks(view.low[1], view.high[1]):
            away = view.shown_scale * (tick - view.low[1])
            y = bottom - away if view.up else top + away
            sheet._draw.line((left - 5, y, left, y), fill=TEXT)
            sheet._text((left - 9, y), f"{round(tick, 9):g}", 16, "rm")
        sheet._text(((left + right) / 2, bottom + 42), labels[0], 17)
        sheet._text((left - 52, (top + bottom) / 2), labels[1], 17, "rm")
        sheet._text(((left + right) / 2, top - 16), above, 20)
        sheet._legend(entries)
        return sheet

    def _legend(self, entries: Sequence[Entry]) -> None:
        """Say at the bottom what has which colour."""
        font = ImageFont.load_default(18)
        widths = [85 + font.getlength(name) for name, _, _ in entries]
        x, y = (self.image.width - sum(widths)) / 2, self.image.height - 26
        for (name, fill, edge), width in zip(entries, widths, strict=True):
            if edge is None:
                self._draw.line((x, y, x + 34, y), fill=fill, width=3)
            else:
                self._draw.rectangle((x, y - 7, x + 34, y + 7), fill=fill, outline=edge)
            self._text((x + 46, y), name, 18, "lm")
            x += width

    def _text(self, position: tuple[float, float], text: str, size: int, anchor: str = "mm") -> None:
        self._draw.text(position, text, fill=TEXT, font=ImageFont.load_default(size), anchor=anchor)


def _lines(title: str, width: int) -> list[str]:
    return wrap(title, width // 10, max_lines=3, placeholder=" ...")
