"""Surface: triangles of a body, read from elsewhere or made of the round and square shapes that we know."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.robot.capsule import Capsule
from evenroad.robot.kernel.tree import rotation_from_z
from evenroad.robot.robot import Robot
from evenroad.robot.scene import Obstacle

AROUND = 24
"""Corners of a circle; a round body loses less than 0.9 % of its radius, which stays inside of the true one."""


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles.

    Attributes
    ----------
    vertices : float64 ndarray, shape (v, 3)
        Corners [m].
    triangles : int64 ndarray, shape (t, 3)
        Their numbers.

    Raises
    ------
    InvalidValue
        If there are no triangles: nothing would ever touch such a body.
    """

    vertices: npt.NDArray[np.float64]
    triangles: npt.NDArray[np.int64]

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, dtype=np.float64).reshape(-1, 3)
        triangles = np.ascontiguousarray(self.triangles, dtype=np.int64).reshape(-1, 3)
        if len(triangles) == 0 or not np.isfinite(vertices).all():
            raise InvalidValue(
                "a surface must have triangles with finite corners; without them it never collides"
            )
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            raise InvalidValue(f"triangles must name corners from 0 to {len(vertices) - 1}")
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", triangles)


def robot_surfaces(robot: Robot) -> dict[str, Surface]:
    """Return the surfaces of a robot's capsules, in their links' frames: link -> surface."""
    links = dict.fromkeys(capsule.link for capsule in robot.capsules)
    return {
        link: joined([capsule_surface(capsule) for capsule in robot.capsules if capsule.link == link])
        for link in links
    }


def capsule_surface(capsule: Capsule) -> Surface:
    """Return the surface of a capsule, in its link's frame."""
    a, b = np.array(capsule.a), np.array(capsule.b)
    length = float(np.linalg.norm(b - a))
    axis = (b - a) / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    upright = _lathe(_round_profile(capsule.radius, length))
    turn = rotation_from_z((float(axis[0]), float(axis[1]), float(axis[2])))
    return Surface(upright.vertices @ turn.T + 0.5 * (a + b), upright.triangles)


def obstacle_surface(obstacle: Obstacle) -> Surface:
    """Return the surface of an obstacle, in the frame of the robot's root link."""
    if obstacle.shape == "box":
        local = _box(obstacle.size)
    elif obstacle.shape == "cylinder":
        radius, length = obstacle.size
        local = _lathe([(-0.5 * length, radius), (0.5 * length, radius)])
    else:
        radius, length = (*obstacle.size, 0.0)[:2]
        local = _lathe(_round_profile(radius, length))
    turn = np.array(obstacle.rotation).reshape(3, 3)
    return Surface(local.vertices @ turn.T + np.array(obstacle.xyz), local.triangles)


def joined(surfaces: Sequence[Surface]) -> Surface:
    """Return several surfaces as one."""
    offsets = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    return Surface(
        np.concatenate([surface.vertices for surface in surfaces]),
        np.concatenate([s.triangles + offset for s, offset in zip(surfaces, offsets, strict=True)]),
    )


def _box(size: Sequence[float]) -> Surface:
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    triangles = [corner for a, b, c, d in sides for corner in ((a, b, c), (a, c, d))]
    return Surface(0.5 * signs * np.array(size), np.array(triangles))


def _round_profile(radius: float, length: float) -> list[tuple[float, float]]:
    """Return heights and radii of the rings of a capsule that stands on the z axis, poles included."""
    quarter = AROUND // 4
    angles = [0.5 * math.pi * k / quarter for k in range(quarter + 1)]
    lower = [(-radius * math.cos(angle), radius * math.sin(angle)) for angle in angles]
    lower[0] = (-radius, 0.0)
    upper = [(-height, ring) for height, ring in reversed(lower)]
    # A ball has its equator once.
    upper = upper if length > 0.0 else upper[1:]
    half = 0.5 * length
    return [(height - half, ring) for height, ring in lower] + [
        (height + half, ring) for height, ring in upper
    ]


def _lathe(profile: Sequence[tuple[float, float]]) -> Surface:
    """Return the surface that a profile of (height, radius) sweeps about the z axis, closed by its ends' middles."""
    rings = [(height, radius) for height, radius in profile if radius > 0.0]
    angles = 2.0 * math.pi * np.arange(AROUND) / AROUND
    corners = [
        np.column_stack([radius * np.cos(angles), radius * np.sin(angles), np.full(AROUND, height)])
        for height, radius in rings
    ]
    poles = np.array([[0.0, 0.0, profile[0][0]], [0.0, 0.0, profile[-1][0]]])
    here, after = np.arange(AROUND), (np.arange(AROUND) + 1) % AROUND
    triangles = []
    for k in range(len(rings) - 1):
        low, high = k * AROUND, (k + 1) * AROUND
        triangles += [np.column_stack([low + here, low + after, high + after])]
        triangles += [np.column_stack([low + here, high + after, high + here])]
    south, last = len(rings) * AROUND, (len(rings) - 1) * AROUND
    triangles += [np.column_stack([after, here, np.full(AROUND, south)])]
    triangles += [np.column_stack([last + here, last + after, np.full(AROUND, south + 1)])]
    return Surface(np.concatenate([*corners, poles]), np.concatenate(triangles))
