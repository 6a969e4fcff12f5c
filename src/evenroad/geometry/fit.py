"""Capsules that contain a shape."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.errors import InvalidValue
from evenroad.geometry.fit_points import Fitted, capsule_around, rough_capsule_around, volume
from evenroad.geometry.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere

MOST_SIDE_BY_SIDE = 4
"""Largest number of capsules that cover a box."""
MOST_CAPSULES = 4
"""Largest number of capsules of a mesh."""
WORTHWHILE = 0.9
"""Factor by which each further capsule must reduce the sum of volumes, on average."""
_CUTS = (0.15, 0.3, 0.5, 0.7, 0.85)
_LONGEST_EDGE = 1.0 / 6.0
"""Largest length of an edge, in parts of the mesh's extent; longer ones are divided."""
_LOOKED_AT = 300
"""Number of triangles by which splits are compared."""


def fit_capsules(shape: Shape) -> tuple[Capsule, ...]:
    """Return capsules, in the frame of the shape's link, whose union contains a shape.

    A sphere and a capsule are kept.  A cylinder gets the smallest capsule on its axis.  A box gets up to 4 capsules
    along its longest edge, side by side, with nearly square cross-sections.  A mesh gets up to 4, see
    :func:`capsules_around_mesh`.  Raises as :func:`evenroad.geometry.load_mesh` for a mesh, InvalidValue for a cloud.
    """
    rotation, xyz = shape.pose.rotation_matrix, np.array(shape.pose.xyz)
    # The pose rounds in the last digits; every vertex must stay covered.
    exact = isinstance(shape, Sphere | Capsule)

    def placed(fitted: Fitted) -> Capsule:
        (ax, ay, az), (bx, by, bz) = ((rotation @ end + xyz).tolist() for end in fitted[:2])
        radius = fitted[2]
        slack = 0.0 if exact else 1e-9 * (radius + np.abs(xyz).max())
        return Capsule((ax, ay, az), (bx, by, bz), float(radius + slack), link=shape.link)

    return tuple(map(placed, _fitted(shape)))


def _fitted(shape: Shape) -> list[Fitted]:
    """Return the capsules in the shape's own frame."""
    if isinstance(shape, Mesh):
        mesh = shape.triangles
        return capsules_around_mesh(mesh.vertices, mesh.triangles)
    if isinstance(shape, Box):
        return _around_box(np.array(shape.size))
    if isinstance(shape, Sphere):
        return [(np.zeros(3), np.zeros(3), shape.radius)]
    if isinstance(shape, Capsule):
        return [(np.array(shape.a), np.array(shape.b), shape.radius)]
    if isinstance(shape, Cylinder):
        radius, half = smallest_around_prism(shape.radius, 0.5 * shape.length)
        end = np.array([0.0, 0.0, half])
        return [(-end, end, radius)]
    raise InvalidValue(f"no capsules are fitted to a {shape}")


def smallest_around_prism(reach: float, half: float) -> tuple[float, float]:
    """Return radius and half length of the smallest capsule around a prism on its axis, to 1 % of its length.

    The prism reaches `reach` from its axis and `half` along it to either side.  A segment of half length h needs the
    radius ``sqrt(reach^2 + (half - h)^2)``.
    """
    h = np.linspace(0.0, half, 101)
    radius = np.hypot(reach, half - h)
    volume = math.pi * radius**2 * (2.0 * h + 4.0 / 3.0 * radius)
    best = int(volume.argmin())
    return float(radius[best]), float(h[best])


def _around_box(size: Floats) -> list[tuple[Floats, Floats, float]]:
    thin, middle, long = np.argsort(size, kind="stable")
    count = int(np.clip(round(size[middle] / size[thin]), 1, MOST_SIDE_BY_SIDE))
    width = size[middle] / count
    radius, half = smallest_around_prism(0.5 * math.hypot(size[thin], width), 0.5 * size[long])
    along = half * np.eye(3)[long]
    centres = [(i - 0.5 * (count - 1)) * width * np.eye(3)[middle] for i in range(count)]
    return [(centre - along, centre + along, radius) for centre in centres]


@dataclass(frozen=True, eq=False)
class _Part:
    """Triangles, (t, 3, 3), a capsule around them, and the two parts of their best split, if any."""

    corners: Floats
    capsule: Fitted
    halves: tuple[_Part, ...] = ()

    @property
    def gain(self) -> float:
        """Volume that the split saves; negative where it costs volume."""
        if not self.halves:
            return -math.inf
        return volume(self.capsule) - sum(volume(half.capsule) for half in self.halves)


def capsules_around_mesh(vertices: Floats, triangles: Ints) -> list[Fitted]:
    """Return up to 4 capsules (a, b, radius) such that every triangle lies within one of them.

    The capsule whose split saves most is split repeatedly, and the number of capsules with the least cost is taken: a
    link that is thick at both ends gains nothing before its second split.  A split divides triangles by their centres
    along a coordinate or principal axis.  A capsule is convex, so it contains triangles whose corners it contains.
    """
    corners = divided(vertices[triangles])
    parts = [_splittable(_Part(corners, _rough(corners)))]
    found = [parts]
    while len(parts) < MOST_CAPSULES:
        best = max(range(len(parts)), key=lambda i: parts[i].gain)
        if not parts[best].halves:
            break
        halves = parts[best].halves
        if len(parts) + 1 < MOST_CAPSULES:
            halves = tuple(map(_splittable, halves))
        parts = [*parts[:best], *halves, *parts[best + 1 :]]
        found.append(parts)
    chosen = min(map(_merged, found), key=_cost)
    return [capsule_around(part.corners.reshape(-1, 3)) for part in chosen]


def _merged(parts: list[_Part]) -> list[_Part]:
    """Return the parts after joining pairs of them while that lowers the cost."""
    for i, j in itertools.combinations(range(len(parts)), 2):
        corners = np.concatenate([parts[i].corners, parts[j].corners])
        fewer = [part for k, part in enumerate(parts) if k not in (i, j)] + [_Part(corners, _rough(corners))]
        if _cost(fewer) < _cost(parts):
            return _merged(fewer)
    return parts


def _cost(parts: list[_Part]) -> float:
    """Return the sum of volumes with a factor for the number of capsules."""
    return sum(volume(part.capsule) for part in parts) / WORTHWHILE ** len(parts)


def _splittable(part: _Part) -> _Part:
    """Return the part with the best split tried."""
    below = best_cut(part.corners, lambda side: volume(_rough(side)))
    if below is None:
        return part
    sides = part.corners[below], part.corners[~below]
    return _Part(part.corners, part.capsule, tuple(_Part(side, _rough(side)) for side in sides))


def best_cut(corners: Floats, cost: Callable[[Floats], float]) -> Bools | None:
    """Return which triangles, (t, 3, 3), are on one side of the cheapest cut across a coordinate or the principal axis;
    None without a cut.
    """
    centres = corners.mean(axis=1)
    _, _, axes = np.linalg.svd(centres - centres.mean(axis=0), full_matrices=len(centres) < 3)
    shown = slice(None, None, max(1, len(corners) // _LOOKED_AT))
    least, best = math.inf, None
    for axis in (*np.eye(3), axes[0]):
        along = centres @ axis
        for cut in _CUTS:
            below = along < along.min() + cut * np.ptp(along)
            sides = [corners[shown][side[shown]] for side in (below, ~below)]
            if min(map(len, sides)) == 0:
                continue
            total = sum(map(cost, sides))
            if total < least:
                least, best = total, below
    return best


def _rough(corners: Floats) -> Fitted:
    return rough_capsule_around(corners.reshape(-1, 3))


def divided(corners: Floats, share: float = _LONGEST_EDGE) -> Floats:
    """Return triangles, (t, 3, 3), of the same surface with edges of at most this share of its extent."""
    longest = share * float(np.ptp(corners.reshape(-1, 3), axis=0).max())
    done = []
    while len(corners):
        lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        long = lengths.max(axis=1) > longest
        done.append(corners[~long])
        # Turned so that the longest edge runs from the first to the second corner.
        first = lengths[long].argmax(axis=1)[:, np.newaxis]
        turned = np.take_along_axis(corners[long], ((first + np.arange(3)) % 3)[:, :, np.newaxis], axis=1)
        a, b, c = turned[:, 0], turned[:, 1], turned[:, 2]
        middle = 0.5 * (a + b)
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)
