"""From collision shapes to capsules that contain them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from evenroad.robot.capsule import Capsule
from evenroad.robot.fit_mesh import capsules_around_mesh
from evenroad.robot.geometry import Geometry
from evenroad.robot.meshes import load_triangles

MOST_SIDE_BY_SIDE = 4
"""Most capsules that a box is covered with."""


def fit_capsules(geometry: Geometry) -> tuple[Capsule, ...]:
    """Return capsules, in the link's frame, whose union contains a collision shape.

    A sphere and a capsule are kept.  A cylinder gets the smallest capsule around it on its axis.  A box gets capsules
    along its longest edge, side by side along the next: as many as make their cross-sections near square, at most
    4.  A mesh gets up to 4 capsules, each around some of its triangles (see :func:`capsules_around_mesh`).

    Raises
    ------
    NotAvailable, BrokenFile
        As :func:`evenroad.robot.meshes.load_triangles`, for a mesh.
    """
    rotation, xyz = np.reshape(geometry.rotation, (3, 3)), np.array(geometry.xyz)

    def placed(a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], radius: float) -> Capsule:
        (ax, ay, az), (bx, by, bz) = (rotation @ a + xyz).tolist(), (rotation @ b + xyz).tolist()
        # Turning and shifting round in the last digits, which must not cost a vertex its cover.
        slack = 0.0 if geometry.shape in ("sphere", "capsule") else 1e-9 * (radius + np.abs(xyz).max())
        return Capsule(geometry.link, (ax, ay, az), (bx, by, bz), float(radius + slack))

    if geometry.file is not None:
        vertices, triangles = load_triangles(geometry.file)
        fitted = capsules_around_mesh(vertices * np.array(geometry.size), triangles)
        return tuple(placed(a, b, radius) for a, b, radius in fitted)
    if geometry.shape == "box":
        return tuple(placed(a, b, radius) for a, b, radius in _around_box(np.array(geometry.size)))
    if geometry.shape == "sphere":
        return (placed(np.zeros(3), np.zeros(3), geometry.size[0]),)
    radius, half = geometry.size[0], 0.5 * geometry.size[1]
    if geometry.shape == "cylinder":
        radius, half = smallest_around_prism(radius, half)
    end = np.array([0.0, 0.0, half])
    return (placed(-end, end, radius),)


def smallest_around_prism(reach: float, half: float) -> tuple[float, float]:
    """Return radius and half length of the smallest capsule around a prism on its axis.

    The prism reaches `reach` from its axis and `half` along it to either side.  A segment of half length h needs the
    radius ``sqrt(reach^2 + (half - h)^2)``; of h in [0, half] the one of least volume is taken, to 1 %.
    """
    h = np.linspace(0.0, half, 101)
    radius = np.hypot(reach, half - h)
    volume = math.pi * radius**2 * (2.0 * h + 4.0 / 3.0 * radius)
    best = int(volume.argmin())
    return float(radius[best]), float(h[best])


def _around_box(
    size: npt.NDArray[np.float64],
) -> list[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], float]]:
    thin, middle, long = np.argsort(size, kind="stable")
    count = int(np.clip(round(size[middle] / size[thin]), 1, MOST_SIDE_BY_SIDE))
    width = size[middle] / count
    radius, half = smallest_around_prism(0.5 * math.hypot(size[thin], width), 0.5 * size[long])
    along = half * np.eye(3)[long]
    centres = [(i - 0.5 * (count - 1)) * width * np.eye(3)[middle] for i in range(count)]
    return [(centre - along, centre + along, radius) for centre in centres]
