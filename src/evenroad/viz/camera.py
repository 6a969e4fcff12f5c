"""The camera of a picture in three dimensions, and from which side an arm is seen best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.picture import nearest

_SIDES, _ABOVE = 16, 0.42
"""Number of sides that the camera may stand on, and how far above: a share of its distance."""
_COARSE = (160, 100)
"""Size of the pictures from which a side is chosen [pixels]."""
_ENOUGH = 0.85
"""Share of the most that any side sees: the first side with so much is taken."""
_MARGIN = 0.46
"""Largest distance of what is shown from the middle of the picture: a share of its size."""


@dataclass(frozen=True)
class Camera:
    """A camera at `eye` that looks at a point, (3,) each [m], with a picture of `size` pixels; z is up."""

    eye: Floats
    look_at: Floats
    size: tuple[int, int]
    zoom: float = 1.5

    @cached_property
    def axes(self) -> Floats:
        """Right, up and forward, (3, 3)."""
        forward = self.look_at - self.eye
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), forward])

    @property
    def scale(self) -> float:
        """Pixels of a metre at a depth of 1 m."""
        return self.zoom * self.size[1] / 2.0

    def pixels(self, points: Floats) -> Floats:
        """Return column, row and 1 / depth of points, (..., 3): all three are linear on a flat face."""
        seen = (points - self.eye) @ self.axes.T
        near = 1.0 / np.maximum(seen[..., 2], 1e-3)
        seen[..., 0] = self.size[0] / 2.0 + self.scale * seen[..., 0] * near
        seen[..., 1] = self.size[1] / 2.0 - self.scale * seen[..., 1] * near
        seen[..., 2] = near
        return seen


def best_camera(arm: Floats, obstacles: Floats, low: Floats, high: Floats, size: tuple[int, int]) -> Camera:
    """Return a camera around a box from which much of an arm is seen: points of it, (p, 3), along its path.

    `obstacles` are the triangles, (t, 3, 3), that may stand before it.  A side is better the more pixels of a small
    picture show a point of the arm.
    """
    seen: list[tuple[int, Camera]] = []
    for i in range(_SIDES):
        # From the right front to both sides of it; x points right and away.
        turn = -0.3 * np.pi + 2.0 * np.pi / _SIDES * ((i + 1) // 2) * (-1.0) ** i
        camera = _fitted(np.array([np.cos(turn), np.sin(turn), _ABOVE]), low, high, _COARSE)
        hidden, _ = nearest(camera.pixels(obstacles), *_COARSE)
        at = camera.pixels(arm)
        column, row = at[:, :2].astype(int).T.clip(0, np.array([_COARSE]).T - 1)
        place = row * _COARSE[0] + column
        free = place[at[:, 2] >= hidden.reshape(-1)[place]]
        seen.append((np.count_nonzero(np.bincount(free)), camera))
    most = max(count for count, _ in seen)
    best = next(camera for count, camera in seen if count >= _ENOUGH * most)
    return Camera(best.eye, best.look_at, size, best.zoom)


def _fitted(direction: Floats, low: Floats, high: Floats, size: tuple[int, int]) -> Camera:
    """Return the nearest camera in a direction from which the whole box is in the picture."""
    middle, distance = 0.5 * (low + high), float(np.linalg.norm(high - low))
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    for _ in range(6):
        camera = Camera(middle + distance * direction / np.linalg.norm(direction), middle, size, 2.2)
        off = np.abs(camera.pixels(corners)[:, :2] / np.array(size) - 0.5).max()
        distance *= max(off / _MARGIN, 0.5)
    return camera
