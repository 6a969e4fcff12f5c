"""A picture of a point set in two of its axes."""

from __future__ import annotations

import os

import numpy as np
from PIL import Image

from evenroad._checks import as_file
from evenroad.errors import InvalidValue, shown
from evenroad.points.pointset import PointSet
from evenroad.viz import style
from evenroad.viz.sheet import Sheet, View, save_png

SIDE = 600
"""Side of the unit square [pixels]."""


def plot_points(points: PointSet, path: str | os.PathLike[str] | None, axes: tuple[int, int]) -> Image.Image:
    """Return what :meth:`PointSet.plot` does."""
    known = range(points.d)
    if not isinstance(axes, tuple | list) or len(axes) != 2 or any(each not in known for each in axes):
        raise InvalidValue(f"axes must be two numbers from 0 to {points.d - 1}, got {shown(axes)}")
    view = View(np.zeros(2), np.ones(2), SIDE)
    radius = float(np.clip(40.0 / np.sqrt(max(points.n, 1)), 1.0, 4.0))
    for row in points.points[:, list(axes)]:
        view.dot(row, style.GOAL, radius)
    labels = (f"axis {axes[0]}", f"axis {axes[1]}")
    picture = Sheet.of_view(view, SIDE, f"{points.n} points, {points.origin}", "", labels, []).image
    if path is not None:
        save_png(picture, as_file("what a picture is saved to", path))
    return picture
