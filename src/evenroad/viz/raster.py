"""Drawing triangles in three dimensions with NumPy: perspective, smooth shading, one light and its shadows.

Every triangle is cut into rows of pixels, all of them at once; the nearest of those on a pixel is seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from evenroad._arrays import Floats, Ints
from evenroad.viz.surfaces import Surface

FINER = 2
"""Factor by which a picture is drawn larger, then shrunk, so that edges are smooth."""
_SHADOW = 900
"""Side of the square picture that the light sees [pixels]."""
_TAPS = ((-0.4, -1.1), (1.1, -0.4), (0.4, 1.1), (-1.1, 0.4))
"""Offsets of the pixels that a point is compared with, so that edges of shadows are soft."""
_BIAS = 0.006
"""Depth below a surface that is in its own shadow for sure [m]."""
_CREASE = 0.75
"""Cosine of the angle between two faces beyond which their edge is sharp."""
_SKY, _HORIZON = np.array([214.0, 224.0, 236.0]), np.array([250.0, 251.0, 253.0])
_GROUND, _LINES = np.array([233.0, 236.0, 240.0]), np.array([205.0, 211.0, 219.0])
_TILE = 0.25
"""Distance of the lines on the floor [m]."""


@dataclass(frozen=True)
class Part:
    """A body to draw: corners of its triangles, (t, 3, 3) [m], their normals, its colour, and how opaque it is."""

    corners: Floats
    normals: Floats
    colour: tuple[int, int, int]
    opacity: float = 1.0

    def moved(self, pose: Floats) -> Part:
        """Return it moved by a transform, (4, 4)."""
        turned = pose[:3, :3].T
        return Part(self.corners @ turned + pose[:3, 3], self.normals @ turned, self.colour, self.opacity)


@dataclass(frozen=True)
class Camera:
    """A camera at `eye` that looks at a point, (3,) each [m], with a picture of `size` pixels; z is up."""

    eye: Floats
    look_at: Floats
    size: tuple[int, int]
    zoom: float = 1.5

    @property
    def axes(self) -> Floats:
        """Right, up and forward, (3, 3)."""
        forward = self.look_at - self.eye
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(right, forward), forward])

    def pixels(self, points: Floats) -> Floats:
        """Return column, row and 1 / depth of points, (..., 3): all three are linear on a flat face."""
        seen = (points - self.eye) @ self.axes.T
        near = 1.0 / np.maximum(seen[..., 2], 1e-3)
        scale = self.zoom * self.size[1] / 2.0
        columns = self.size[0] / 2.0 + scale * seen[..., 0] * near
        return np.stack([columns, self.size[1] / 2.0 - scale * seen[..., 1] * near, near], axis=-1)

    def rays(self) -> Floats:
        """Return the directions of all pixels, (rows, columns, 3), with depth 1."""
        width, height = self.size
        scale = self.zoom * height / 2.0
        x, y = (np.arange(width) + 0.5 - width / 2.0) / scale, (height / 2.0 - np.arange(height) - 0.5) / scale
        right, up, forward = self.axes
        return x[None, :, None] * right + y[:, None, None] * up + forward


def part_of(surface: Surface, colour: tuple[int, int, int], opacity: float = 1.0) -> Part:
    """Return a body of its surface, with normals that are smooth except at sharp edges."""
    vertices, triangles = surface
    corners = vertices[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    units = faces / np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-15)
    _, same = np.unique(np.round(vertices, 6), axis=0, return_inverse=True)
    at = same.reshape(-1)[triangles].reshape(-1)
    # Corners in the order of their vertex: pairs of faces at one vertex are pairs within its run.
    order = np.argsort(at, kind="stable")
    firsts = np.searchsorted(at[order], np.arange(at.max() + 2 if len(at) else 1))
    count = (firsts[1:] - firsts[:-1])[at[order]]
    one = np.repeat(order, count)
    other = order[np.repeat(firsts[at[order]], count) + _within(count)]
    smooth = (units[one // 3] * units[other // 3]).sum(axis=1) > _CREASE
    normals = np.zeros((len(at), 3))
    for axis in range(3):
        normals[:, axis] = np.bincount(one[smooth], faces[other[smooth] // 3, axis], len(at))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-15)
    return Part(corners, normals.reshape(-1, 3, 3), colour, opacity)


class Stage:
    """A camera, and a floor at this height [m] below all that it sees."""

    def __init__(self, camera: Camera, floor: float) -> None:
        size = FINER * camera.size[0], FINER * camera.size[1]
        self._camera = Camera(camera.eye, camera.look_at, size, camera.zoom)
        self._rays = self._camera.rays()
        # The light comes from behind the camera's left shoulder, high above.
        right, _, forward = camera.axes
        light = np.array([0.0, 0.0, 1.05]) - 0.55 * forward * [1.0, 1.0, 0.0] - 0.55 * right
        light /= np.linalg.norm(light)
        across = np.cross(light, right) / np.linalg.norm(np.cross(light, right))
        self._axes = np.stack([np.cross(across, light), across, light])
        # The background is smooth: it is not drawn larger.
        rays = camera.rays()
        with np.errstate(divide="ignore", invalid="ignore"):
            away = (floor - camera.eye[2]) / rays[..., 2]
        self._seen = (away > 0.0) & (away < 40.0)
        up = np.clip(rays[..., 2:] / np.linalg.norm(rays, axis=-1, keepdims=True) * 2.5, 0.0, 1.0)
        self._background = _HORIZON + up * (_SKY - _HORIZON)
        floor_points = camera.eye + away[self._seen][:, None] * rays[self._seen]
        self._background[self._seen] = _floor(floor_points, camera)
        self._background = self._background.astype(np.float32)
        self._floor = floor_points @ self._axes.T
        self._depth = np.where(self._seen, 1.0 / np.where(self._seen, away, 1.0), 0.0)

    def picture(self, parts: Sequence[Part]) -> Image.Image:
        """Return a picture of bodies; translucent ones throw no shadow."""
        solid = [part for part in parts if part.opacity == 1.0]
        shadow = _Shadow(solid, self._axes)
        background = self._background.copy()
        background[self._seen] *= (0.72 + 0.28 * shadow.light_at(self._floor)).astype(np.float32)[:, None]
        picture, depth = (each.repeat(FINER, 0).repeat(FINER, 1) for each in (background, self._depth))
        self._paint(picture, depth, solid, shadow)
        for part in parts:
            if part.opacity < 1.0:
                # A still body's double lies on the body: seen is what is nearer by half a percent.
                self._paint(picture, 1.005 * depth, [part], None)
        return Image.fromarray(np.minimum(picture, 255.0, out=picture).astype(np.uint8)).reduce(FINER)

    def _paint(self, picture: Floats, depth: Floats, parts: Sequence[Part], shadow: _Shadow | None) -> None:
        """Draw bodies where they are nearer than what is seen there; `depth` holds 1 / depth of that."""
        if not parts:
            return
        corners = np.concatenate([part.corners for part in parts])
        normals = np.concatenate([part.normals for part in parts])
        colours = np.concatenate([np.tile(np.array(part.colour, float), (len(part.corners), 1)) for part in parts])
        flat = self._camera.pixels(corners)
        pixel, owner = nearest(flat, depth)
        if not len(pixel):
            return
        rows, columns = np.divmod(pixel, picture.shape[1])
        weights = _barycentric(flat[owner], columns + 0.5, rows + 0.5)
        normal = np.einsum("pk,pkd->pd", weights, normals[owner])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-15)
        ray = self._rays[rows, columns]
        # What is seen from behind, as the inside of an open mesh, is lit as its outside.
        normal *= np.where((normal * ray).sum(axis=1) > 0.0, -1.0, 1.0)[:, None]
        point = self._camera.eye + ray / depth[rows, columns][:, None]
        lit = np.clip(normal @ self._axes[2], 0.0, None)
        half = self._axes[2] - ray / np.linalg.norm(ray, axis=1, keepdims=True)
        shine = np.clip((normal * half).sum(axis=1) / np.linalg.norm(half, axis=1), 0.0, None) ** 40
        if shadow is not None:
            reached = shadow.light_at((point + 0.004 * normal) @ self._axes.T)
            lit, shine = lit * reached, shine * reached
        bright = 0.52 + 0.14 * normal[:, 2] + 0.48 * lit
        colour = colours[owner] * bright[:, None] + 60.0 * shine[:, None]
        opacity = parts[0].opacity
        picture[rows, columns] = opacity * colour + (1.0 - opacity) * picture[rows, columns]


def nearest(flat: Floats, depth: Floats) -> tuple[Ints, Ints]:
    """Return the pixels whose nearest thing is a triangle, and which; `depth` is brought up to date.

    `flat` holds column, row and 1 / depth of the corners, (t, 3, 3); `depth` that of what is seen, (rows, columns).
    """
    height, width = depth.shape
    pixel, triangle, value = _covered(flat, width, height)
    seen = depth.reshape(-1)
    np.maximum.at(seen, pixel, value)
    wins = value >= seen[pixel]
    owner = np.full(len(seen), -1)
    owner[pixel[wins]] = triangle[wins]
    found = np.flatnonzero(owner >= 0)
    return found, owner[found]


def _covered(flat: Floats, width: int, height: int) -> tuple[Ints, Ints, Floats]:
    """Return pixel, triangle and 1 / depth of each pixel whose centre a triangle covers."""
    low, high = flat[..., :2].min(axis=1), flat[..., :2].max(axis=1)
    inside = (
        (high > 0.0).all(axis=1)
        & (low[:, 0] < width)
        & (low[:, 1] < height)
        & (np.abs(flat[..., 2]) < 900.0).all(axis=1)
    )
    first = np.ceil(np.clip(low[:, 1], 0, height) - 0.5).astype(int)
    last = np.ceil(np.clip(high[:, 1], 0, height) - 0.5).astype(int)
    rows = np.where(inside, last - first, 0)
    triangle = np.repeat(np.arange(len(flat)), rows)
    row = np.repeat(first, rows) + _within(rows)
    a, b = flat[triangle], np.roll(flat[triangle], -1, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (row[:, None] + 0.5 - a[..., 1]) / (b[..., 1] - a[..., 1])
        cut = np.where((share >= 0.0) & (share <= 1.0), a[..., 0] + share * (b[..., 0] - a[..., 0]), np.nan)
    empty = np.isnan(cut).all(axis=1)
    left = np.where(empty, 0.0, np.nanmin(np.where(np.isnan(cut), np.inf, cut), axis=1))
    right = np.where(empty, 0.0, np.nanmax(np.where(np.isnan(cut), -np.inf, cut), axis=1))
    begin = np.ceil(np.clip(left, 0, width) - 0.5).astype(int)
    count = np.maximum(np.ceil(np.clip(right, 0, width) - 0.5).astype(int) - begin, 0)
    column = np.repeat(begin, count) + _within(count)
    row, triangle = np.repeat(row, count), np.repeat(triangle, count)
    slopes = _slopes(flat)[triangle]
    origin = flat[triangle, 0]
    value = origin[:, 2] + slopes[:, 0] * (column + 0.5 - origin[:, 0]) + slopes[:, 1] * (row + 0.5 - origin[:, 1])
    return row * width + column, triangle, value


def _slopes(flat: Floats) -> Floats:
    """Return by how much 1 / depth grows per column and per row, (t, 2)."""
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(np.abs(area) < 1e-12, np.inf, area)
    return (
        np.stack([u[:, 2] * v[:, 1] - u[:, 1] * v[:, 2], u[:, 0] * v[:, 2] - u[:, 2] * v[:, 0]], axis=1) / area[:, None]
    )


def _barycentric(flat: Floats, x: Floats, y: Floats) -> Floats:
    """Return the weights of a triangle's corners at points, (p, 3), clipped to the triangle."""
    u, v = flat[:, 1, :2] - flat[:, 0, :2], flat[:, 2, :2] - flat[:, 0, :2]
    px, py = x - flat[:, 0, 0], y - flat[:, 0, 1]
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(np.abs(area) < 1e-12, np.inf, area)
    second, third = (px * v[:, 1] - py * v[:, 0]) / area, (u[:, 0] * py - u[:, 1] * px) / area
    return np.clip(np.stack([1.0 - second - third, second, third], axis=1), 0.0, 1.0)


def _within(counts: Ints) -> Ints:
    """Return 0, 1, ... counts[0] - 1, 0, 1, ... counts[1] - 1 and so on."""
    total = int(counts.sum())
    within: Ints = np.arange(total) - np.repeat(np.cumsum(counts) - counts, counts)
    return within


def _floor(points: Floats, camera: Camera) -> Floats:
    """Return the colours of points on the floor: lines every `_TILE`, fading into the distance."""
    distance = np.linalg.norm(points[:, :2] - camera.look_at[:2], axis=1)
    nearest_line = np.abs(points[:, :2] / _TILE - np.rint(points[:, :2] / _TILE)).min(axis=1) * _TILE
    wide = 0.0016 * np.linalg.norm(points - camera.eye, axis=1)
    line = np.clip(1.5 - nearest_line / wide, 0.0, 1.0)[:, None]
    fade = np.clip((distance - 1.5) / 3.0, 0.0, 1.0)[:, None]
    colour = _GROUND + line * (_LINES - _GROUND)
    return colour + fade * (_HORIZON - colour)


class _Shadow:
    """What the light sees: where it is nearer to something else, a point lies in shadow."""

    def __init__(self, parts: Sequence[Part], axes: Floats) -> None:
        seen = np.concatenate([part.corners for part in parts]) @ axes.T
        low, high = seen.reshape(-1, 3).min(axis=0)[:2], seen.reshape(-1, 3).max(axis=0)[:2]
        self._low, self._scale = low - 0.01, _SHADOW / (float(np.max(high - low)) + 0.02)
        self._depth = np.full((_SHADOW, _SHADOW), -np.inf)
        nearest(np.dstack([(seen[..., :2] - self._low) * self._scale, seen[..., 2:]]), self._depth)

    def light_at(self, seen: Floats) -> Floats:
        """Return the share of the light, 0 to 1, that reaches points along the axes of the light, (p, 3)."""
        positions = (seen[:, :2] - self._low) * self._scale
        near = np.flatnonzero((np.abs(positions - 0.5 * _SHADOW) < 0.5 * _SHADOW - 2.0).all(axis=1))
        positions, height, reached = positions[near], seen[near, 2] + _BIAS, np.ones(len(seen))
        lit = np.ones(len(near))
        for tap in _TAPS:
            column, row = (positions + tap).astype(int).T
            lit -= (self._depth[row, column] > height) / len(_TAPS)
        reached[near] = lit
        return reached
