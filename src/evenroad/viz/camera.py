"""The camera of a picture in three dimensions, and from which side an arm is seen best."""

from __future__ import annotations

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
_MARGIN, _ZOOM = 0.46, 2.2
"""Largest distance of what is shown from the middle of the picture: a share of its size; and the camera's lens."""


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
        seen = ((points.reshape(-1, 3) - self.eye) @ self.axes.T).reshape(points.shape)
        near = 1.0 / np.maximum(seen[..., 2], 1e-3)
        seen[..., 0] = self.size[0] / 2.0 + self.scale * seen[..., 0] * near
        seen[..., 1] = self.size[1] / 2.0 - self.scale * seen[..., 1] * near
        seen[..., 2] = near
        return seen


def best_camera(arm: Floats, obstacles: Floats, shown: Floats, size: tuple[int, int]) -> Camera:
    """Return a camera from which much of an arm is seen: points of it, (p, 3), along its path.

    All points of `shown`, (s, 3), are in its picture.  `obstacles` are the triangles, (t, 3, 3), that may stand before
    the arm.  A side is better the more pixels of a small picture show a point of it.
    """
    seen: list[tuple[int, Camera]] = []
    for i in range(_SIDES):
        # From the right front to both sides of it; x points right and away.
        turn = -0.3 * np.pi + 2.0 * np.pi / _SIDES * ((i + 1) // 2) * (-1.0) ** i
        camera = _fitted(np.array([np.cos(turn), np.sin(turn), _ABOVE]), shown, _COARSE)
        hidden, _ = nearest(camera.pixels(obstacles), *_COARSE)
        at = camera.pixels(arm)
        column, row = at[:, :2].astype(int).T.clip(0, np.array([_COARSE]).T - 1)
        pixel = row * _COARSE[0] + column
        free = pixel[at[:, 2] >= hidden.reshape(-1)[pixel]]
        seen.append((int(np.count_nonzero(np.bincount(free))), camera))
    most = max(count for count, _ in seen)
    best = next(camera for count, camera in seen if count >= _ENOUGH * most)
    return Camera(best.eye, best.look_at, size, best.zoom)


def _fitted(direction: Floats, shown: Floats, size: tuple[int, int]) -> Camera:
    """Return the nearest camera in a direction from which all of some points, (s, 3), are in the picture."""
    low, high = shown.min(axis=0), shown.max(axis=0)
    middle, distance = 0.5 * (low + high), max(float(np.linalg.norm(high - low)), 0.05)
    direction = direction / np.linalg.norm(direction)
    for _ in range(4):
        camera = Camera(middle + distance * direction, middle, size, _ZOOM)
        at = camera.pixels(shown)[:, :2] - 0.5 * np.array(size)
        low, high = at.min(axis=0), at.max(axis=0)
        right, up, _ = camera.axes
        across, down = 0.5 * (low + high) * distance / camera.scale
        middle = middle + across * right - down * up
        distance *= max(float((0.5 * (high - low) / size).max()) / _MARGIN, 0.5)
    return Camera(middle + distance * direction, middle, size, _ZOOM)
