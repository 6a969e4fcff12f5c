"""Capsules that contain a shape."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._rng import generator
from evenroad.errors import InvalidValue
from evenroad.geometry.kept import Fitted, fitted_once
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
"""Number of triangles by which splits of one part are compared."""
_SHOWN = 2000
"""Number of triangles by which parts are compared."""
_COMPARED = 128
"""Number of directions in which corners of parts are compared."""
_AT_ONCE = 1 << 16
"""Number of products of points and directions that are computed together."""


def fit_capsules(shape: Shape) -> tuple[Capsule, ...]:
    """Return capsules, in the frame of the shape's link, whose union contains a shape.

    A sphere or capsule stays as it is.  A cylinder gets the smallest capsule on its axis.  A box gets up to 4 capsules
    along its longest edge, side by side, with nearly square cross-sections.  A mesh gets up to 4, see
    :func:`capsules_around_mesh`.  Raises the errors of :func:`evenroad.geometry.load_mesh` for a mesh, and
    InvalidValue for a cloud.
    """
    rotation, xyz = shape.pose.rotation_matrix, np.array(shape.pose.xyz)
    # The pose rounds the last digits, and every vertex must stay covered.
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
        return fitted_once("around", shape.triangles, lambda mesh: capsules_around_mesh(mesh.vertices, mesh.triangles))
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
    """Triangles, (t, 3), between points, a capsule around them, and the two parts of their best split, if any.

    `outer`, (n, 3), are outer corners of some triangles.  The capsule contains only these: it serves to compare splits.
    """

    points: Floats
    triangles: Ints
    outer: Floats
    capsule: Fitted
    halves: tuple[_Part, ...] = ()

    @property
    def gain(self) -> float:
        """Volume that the split saves; negative if it adds volume."""
        if not self.halves:
            return -math.inf
        return volume(self.capsule) - sum(volume(half.capsule) for half in self.halves)


def capsules_around_mesh(vertices: Floats, triangles: Ints) -> list[Fitted]:
    """Return up to 4 capsules (a, b, radius) such that every triangle lies within one of them.

    The capsule whose split saves most is split repeatedly, and the number of capsules with the least cost is used.  A
    link that is thick at both ends gains nothing before its second split.  A split divides triangles by their centres
    along a coordinate or principal axis.  A capsule is convex, so it contains a triangle if it contains its corners.
    """
    parts = [_splittable(_part(*divided(vertices, triangles)))]
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
    return [capsule_around(used(part.points, part.triangles)) for part in chosen]


def _merged(parts: list[_Part]) -> list[_Part]:
    """Return the parts after joining pairs of them while that lowers the cost."""
    for i, j in itertools.combinations(range(len(parts)), 2):
        both = np.concatenate([parts[i].triangles, parts[j].triangles])
        joined = _part(parts[i].points, both, np.concatenate([parts[i].outer, parts[j].outer]))
        fewer = [part for k, part in enumerate(parts) if k not in (i, j)] + [joined]
        if _cost(fewer) < _cost(parts):
            return _merged(fewer)
    return parts


def _cost(parts: list[_Part]) -> float:
    """Return the sum of volumes with a factor for the number of capsules."""
    return sum(volume(part.capsule) for part in parts) / WORTHWHILE ** len(parts)


def _splittable(part: _Part) -> _Part:
    """Return the part with the best split tried."""
    corners = part.points[part.triangles]
    below = best_cut(corners, lambda side: volume(rough_capsule_around(side.reshape(-1, 3))))
    if below is None:
        return part
    return replace(part, halves=tuple(_part(part.points, part.triangles[side]) for side in (below, ~below)))


def _part(points: Floats, triangles: Ints, known: Floats | None = None) -> _Part:
    """Return a part of these triangles; `known` points, if given, include the corners of their hull."""
    shown = triangles[:: max(1, len(triangles) // _SHOWN)]
    outer = farthest(used(points, shown), _COMPARED) if known is None else known
    return _Part(points, triangles, outer, rough_capsule_around(outer))


def farthest(points: Floats, count: int) -> Floats:
    """Return the points of (n, 3) that are farthest along some direction of a set spread over the sphere."""
    # A spiral by the golden angle.
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    around = np.sqrt(1.0 - z**2)
    directions = np.stack([around * np.cos(turn), around * np.sin(turn), z], axis=1)
    most, which = np.full(count, -np.inf), np.zeros(count, dtype=np.int64)
    # Few products at a time stay in the processor's cache, and no threads wait for each other.
    some = max(1, _AT_ONCE // count)
    for first in range(0, len(points), some):
        along = directions @ points[first : first + some].T
        here = along.argmax(axis=1)
        reached = along[np.arange(count), here]
        which, most = np.where(reached > most, here + first, which), np.maximum(reached, most)
    return points[np.unique(which)]


def used(points: Floats, triangles: Ints) -> Floats:
    """Return the points, (n, 3), that are corners of triangles, each once."""
    is_used = np.zeros(len(points), dtype=np.bool_)
    is_used[triangles] = True
    return points[is_used]


def best_cut(corners: Floats, cost: Callable[[Floats], float]) -> Bools | None:
    """Return which triangles, (t, 3, 3), are on one side of the cheapest cut across a coordinate or the principal axis;
    None without a cut.
    """
    centres = corners.mean(axis=1)
    relative = centres - centres.mean(axis=0)
    longest = np.linalg.eigh(relative.T @ relative)[1][:, -1]
    shown = slice(None, None, max(1, len(corners) // _LOOKED_AT))
    least, best = math.inf, None
    for axis in (*np.eye(3), longest):
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


def divided(points: Floats, triangles: Ints, share: float = _LONGEST_EDGE) -> tuple[Floats, Ints]:
    """Return the same surface with edges of at most this share of its extent: points, (n, 3), triangles, (t, 3)."""
    longest = share * float(np.ptp(used(points, triangles), axis=0).max())
    done = []
    while len(triangles):
        corners = points[triangles]
        lengths = np.linalg.norm(corners - corners[:, [1, 2, 0]], axis=2)
        long = lengths.max(axis=1) > longest
        done.append(triangles[~long])
        # Rotate the corners so that the longest edge runs from the first to the second.
        first = lengths[long].argmax(axis=1)[:, np.newaxis]
        a, b, c = np.take_along_axis(triangles[long], (first + np.arange(3)) % 3, axis=1).T
        # Two triangles at one edge each have their own middle point.
        middle = len(points) + np.arange(len(a))
        points = np.concatenate([points, 0.5 * (points[a] + points[b])])
        triangles = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return points, np.concatenate(done)


SAMPLES = 1 << 15
"""Number of points that estimate the volume of a union: a standard error of about half a per cent."""
_LEAST_RADIUS = 1e-6
"""Radius around collinear points [m]."""
_SHARES = np.array([0.0, 0.1, 0.2, 0.35, 0.6, 1.0])
"""Radii to try on an axis besides the least one, as shares of the points' reach along it."""


def capsule_around(points: Floats) -> Fitted:
    """Return a small capsule that contains all points, (n, 3), to rounding.

    :func:`rough_capsule_around`, refined over the axis by the simplex of Nelder and Mead (1965).
    """
    from scipy.optimize import minimize

    # A few outer points suffice to find the axis; the capsule on it contains all points.
    outer = farthest(points, 2 * _COMPARED)
    centre, axes = _starts(outer)
    frame = _frame(min(axes, key=lambda axis: volume(_smallest_on(outer, centre, axis[np.newaxis]))))
    best = _smallest_on(points, centre, frame[:1])
    size = float(np.ptp(points, axis=0).max()) or 1.0

    def moved(x: Floats, around: Floats) -> Fitted:
        tilted = frame[0] + x[0] * frame[1] + x[1] * frame[2]
        origin = centre + size * (x[2] * frame[1] + x[3] * frame[2])
        return _smallest_on(around, origin, (tilted / np.linalg.norm(tilted))[np.newaxis])

    steps = np.vstack([np.zeros(4), 0.1 * np.eye(4)])
    options = dict(maxiter=200, xatol=1e-4, fatol=1e-4 * volume(best), initial_simplex=steps)
    found = minimize(lambda x: volume(moved(x, outer)), np.zeros(4), method="Nelder-Mead", options=options)
    return min((best, moved(found.x, points)), key=volume)


def rough_capsule_around(points: Floats) -> Fitted:
    """Return the smallest capsule around points, (n, 3), through the middle along a principal or coordinate axis."""
    return _smallest_on(points, *_starts(points))


def volume(capsule: Fitted) -> float:
    """Return the volume of a capsule."""
    a, b, radius = capsule
    return math.pi * radius**2 * (math.dist(a, b) + 4.0 / 3.0 * radius)


def _starts(points: Floats) -> tuple[Floats, Floats]:
    """Return the middle of the points' bounding box, and their principal and the coordinate axes, (6, 3)."""
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    relative = points - points.mean(axis=0)
    return centre, np.concatenate([np.eye(3), np.linalg.eigh(relative.T @ relative)[1].T])


def _smallest_on(points: Floats, origin: Floats, axes: Floats) -> Fitted:
    """Return the smallest capsule around the points on a line through `origin` along one of the axes, (n, 3).

    Six radii are tried on each: the least that the line allows, and larger ones, whose shorter segments save volume.
    """
    relative = points - origin
    along = axes @ relative.T
    squared = np.maximum((relative**2).sum(axis=1) - along**2, 0.0)
    span = 0.5 * np.ptp(along, axis=1)[:, np.newaxis]
    radius = np.hypot(np.sqrt(squared.max(axis=1))[:, np.newaxis], _SHARES * span) * (1.0 + 1e-12) + 1e-12 * span
    reach = np.sqrt(np.maximum(radius[:, :, np.newaxis] ** 2 - squared[:, np.newaxis], 0.0))
    # The cap of an end contains a point if the end is at most `reach` from it along the axis.
    low = (along[:, np.newaxis] + reach).min(axis=2)
    high = (along[:, np.newaxis] - reach).max(axis=2)
    middle = 0.5 * (low + high)
    low, high = np.minimum(low, middle), np.maximum(high, middle)
    radius = np.maximum(radius, _LEAST_RADIUS)
    best = int((radius**2 * (high - low + 4.0 / 3.0 * radius)).argmin())
    axis, radius_of_best = axes[best // len(_SHARES)], float(radius.flat[best])
    return origin + low.flat[best] * axis, origin + high.flat[best] * axis, radius_of_best


def _frame(axis: Floats) -> Floats:
    """Return three unit vectors as rows, the first along `axis`."""
    first = axis / np.linalg.norm(axis)
    helper = np.eye(3)[np.abs(first).argmin()]
    second = np.cross(first, helper)
    second /= np.linalg.norm(second)
    return np.stack([first, second, np.cross(first, second)])


def union_volume(capsules: Sequence[Capsule]) -> float:
    """Return the volume of the union of capsules in one frame [m^3], by 32768 fixed random points."""
    a, b = (np.array([getattr(capsule, end) for capsule in capsules]) for end in ("a", "b"))
    radius = np.array([capsule.radius for capsule in capsules])
    low = (np.minimum(a, b) - radius[:, np.newaxis]).min(axis=0)
    high = (np.maximum(a, b) + radius[:, np.newaxis]).max(axis=0)
    points = low + generator(0).random((SAMPLES, 3)) * (high - low)
    inside = np.zeros(SAMPLES, dtype=np.bool_)
    for start, end, reach in zip(a, b, radius, strict=True):
        axis = end - start
        along = np.clip((points - start) @ axis / max(float(axis @ axis), 1e-300), 0.0, 1.0)
        inside |= ((points - start - along[:, np.newaxis] * axis) ** 2).sum(axis=1) <= reach**2
    return float(inside.mean() * np.prod(high - low))
