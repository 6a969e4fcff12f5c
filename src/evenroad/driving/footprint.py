"""Footprint: what of the floor a robot covers, as convex parts, with disks around and inside of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import counted
from evenroad._native.drive import Footprint as NativeFootprint
from evenroad.driving.convex_parts import convex_parts, turn
from evenroad.errors import InvalidValue, shown

MOST = 200
"""Largest number of corners of a footprint."""
SHRUNK = 1e-9
"""By how much parts are smaller in checks, so that rounding errs towards contact [cells]."""
_LARGEST = 1e6
"""Largest coordinate of a corner, in map units."""
_SAME = 1e-9
"""Share of the size of a footprint within which corners are one, or lie on one line."""
_ARC = math.pi / 8
"""Largest angle of a rounded corner's sides: they lie at most 2 % of the radius outside of its arc."""
_MOST_COVERING = 8
"""Largest number of disks that cover a part."""

FootprintLike = npt.ArrayLike | Sequence[npt.ArrayLike]
"""Corners of one polygon, (n, 2), or several polygons."""


@explains_calls
@dataclass(frozen=True, eq=False, init=False, repr=False)
class Footprint:
    """What of the floor a robot covers, around its reference point: x is forwards, y is to the left.

    Parameters
    ----------
    polygons : array_like, shape (n, 2), or a sequence of such
        Corners of a polygon, in either sense, closed or not, or of several, which together are the footprint.  They
        are divided into convex parts.  At most 200 corners, in map units.

    Attributes
    ----------
    outlines : tuple of ndarrays, shape (n, 2)
        The polygons, counter-clockwise.
    parts : tuple of ndarrays, shape (k, 2)
        Convex parts that make them up, counter-clockwise.

    Raises
    ------
    InvalidValue
        If a polygon crosses itself, has no area, or is not of finite numbers.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.driving import Footprint
    >>> Footprint([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)])
    Footprint(6 corners, 2 convex parts)
    """

    outlines: tuple[Floats, ...]
    parts: tuple[Floats, ...] = field(init=False)

    def __init__(self, polygons: FootprintLike) -> None:
        outlines = tuple(_outline(each) for each in _polygons(polygons))
        if sum(map(len, outlines)) > MOST:
            raise InvalidValue(f"a footprint must have at most {MOST} corners, got {sum(map(len, outlines))}")
        self._set(outlines, tuple(part for outline in outlines for part in convex_parts(outline)))

    def _set(self, outlines: tuple[Floats, ...], parts: tuple[Floats, ...]) -> None:
        for each in (*outlines, *parts):
            each.setflags(write=False)
        set_fields(self, outlines=outlines, parts=parts)

    def __repr__(self) -> str:
        return f"Footprint({sum(map(len, self.outlines))} corners, {counted(len(self.parts), 'convex part')})"

    @property
    def reach(self) -> float:
        """Largest distance of a corner from the reference point."""
        return max(float(np.hypot(*part.T).max()) for part in self.parts)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Least and largest x and y, (2,) each."""
        corners = np.concatenate(self.parts)
        return corners.min(axis=0), corners.max(axis=0)

    @cached_property
    def inscribed(self) -> tuple[Floats, float]:
        """Centres, (k, 2), and radius of the largest disks that lie in a part."""
        found = [largest_disks(part) for part in self.parts]
        radius = max(each[1] for each in found)
        centres = np.concatenate([own for own, r in found if r >= (1.0 - _SAME) * radius])
        return centres[:3], radius

    def grown(self, by: float) -> Footprint:
        """Return a footprint that holds all points within a distance of this one, and at corners up to 2 % more.

        Parameters
        ----------
        by : float
            Distance, >= 0, in map units.

        Returns
        -------
        Footprint

        Examples
        --------
        >>> from evenroad.driving import Footprint
        >>> box = Footprint([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        >>> [bound.round(3).tolist() for bound in box.grown(0.5).bounds]
        [[-1.5, -1.5], [1.5, 1.5]]
        """
        if by == 0.0:
            return self
        footprint = Footprint.__new__(Footprint)
        footprint._set(self.outlines, tuple(_rounded(part, by) for part in self.parts))
        return footprint

    def placed(self, pose: npt.ArrayLike, polygons: Sequence[Floats]) -> list[Floats]:
        """Return where polygons of the footprint, its `parts` or `outlines`, are at a pose.

        Parameters
        ----------
        pose : array_like, shape (3,)
        polygons : sequence of ndarrays, shape (n, 2)

        Returns
        -------
        list of ndarrays, shape (n, 2)

        Examples
        --------
        >>> from evenroad.driving import Footprint
        >>> box = Footprint([(0, 0), (2, 0), (2, 1), (0, 1)])
        >>> box.placed((3, 4, 0), box.parts)[0].tolist()
        [[3.0, 4.0], [5.0, 4.0], [5.0, 5.0], [3.0, 5.0]]
        """
        x, y, angle = np.asarray(pose, dtype=np.float64).tolist()
        turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
        return [polygon @ turn + np.array([x, y]) for polygon in polygons]

    def native(self, cell: float, less: float = 0.0) -> NativeFootprint:
        """Return it as the native kernel takes it, in cells of a side in map units.

        The disks inside are smaller by `less` cells.
        """
        parts = [part / cell for part in self.parts]
        corners = [_shrunk(part) for part in parts]
        radius, cover = _covering(parts)
        centres, inner = self.inscribed
        return NativeFootprint(
            np.concatenate(corners),
            np.array([len(part) for part in corners], dtype=np.int64),
            cover,
            np.ascontiguousarray(centres / cell),
            np.array([radius + SHRUNK, max(inner / cell - less - 2.0 * SHRUNK, 1e-150)]),
        )


def as_footprint(given: Footprint | FootprintLike) -> Footprint:
    """Return a footprint, also of the corners of one."""
    return given if isinstance(given, Footprint) else Footprint(given)


def _polygons(given: FootprintLike) -> list[Floats]:
    """Return the corners of each polygon, (n, 2)."""
    try:
        rows = [np.asarray(each, dtype=np.float64) for each in given]  # type: ignore[union-attr]
    except (TypeError, ValueError):
        rows = []
    if rows and all(row.shape == (2,) for row in rows):
        rows = [np.array(rows)]
    if not rows or not all(row.ndim == 2 and row.shape[1:] == (2,) for row in rows):
        raise InvalidValue(f"a footprint must be corners (n, 2), or a list of such polygons, got {shown(given)}")
    for row in rows:
        if not np.isfinite(row).all():
            raise InvalidValue(f"the corners of a footprint must be finite, got {shown(row.tolist())}")
        if np.abs(row).max(initial=0.0) > _LARGEST:
            raise InvalidValue(f"a footprint must reach at most {_LARGEST:g} far, got {shown(row.tolist())}")
    return rows


def _outline(corners: Floats) -> Floats:
    """Return a polygon counter-clockwise, without corners that repeat or lie on a side; refuse what is none."""
    if len(corners) > MOST:
        raise InvalidValue(f"a footprint must have at most {MOST} corners, got {len(corners)}")
    size = float(np.ptp(corners, axis=0).max()) if len(corners) else 0.0
    apart = np.hypot(*(corners - np.roll(corners, 1, axis=0)).T) > _SAME * size if size > 0.0 else np.zeros(0, bool)
    outline = corners[apart]
    _require_simple(outline)
    area = sum(turn(outline[0], outline[k], outline[k + 1]) for k in range(1, len(outline) - 1))
    if area < 0.0:
        outline = outline[::-1]
    while len(outline) > 2:
        before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
        bent = [abs(turn(a, b, c)) > _SAME * size * size for a, b, c in zip(before, outline, after, strict=True)]
        if all(bent):
            break
        outline = outline[bent]
    if len(outline) < 3 or abs(area) <= _SAME * size * size:
        raise InvalidValue(f"a footprint must have three corners or more, and an area, got {shown(corners.tolist())}")
    return np.ascontiguousarray(outline)


def _require_simple(outline: Floats) -> None:
    """Refuse a polygon of which two sides meet that are no neighbours."""
    count = len(outline)
    for i, j in combinations(range(count), 2):
        if j - i in (1, count - 1):
            continue
        a, b, c, d = outline[i], outline[i + 1], outline[j], outline[(j + 1) % count]
        if _meet(a, b, c, d):
            sides = " and ".join(f"({p[0]:g}, {p[1]:g}) to ({q[0]:g}, {q[1]:g})" for p, q in ((a, b), (c, d)))
            raise InvalidValue(f"a footprint must not cross itself: its sides {sides} meet")


def _meet(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    """Return whether two segments have a point in common."""
    if turn(a, b, c) * turn(a, b, d) > 0.0 or turn(c, d, a) * turn(c, d, b) > 0.0:
        return False
    low, high = np.minimum(a, b), np.maximum(a, b)
    return bool((np.minimum(c, d) <= high).all() and (np.maximum(c, d) >= low).all())


def _sides(part: Floats) -> tuple[Floats, Floats]:
    """Return the outward normals, (n, 2), of the sides of a convex part, and their distances from the origin, (n,)."""
    along = np.roll(part, -1, axis=0) - part
    out = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, np.newaxis]
    return out, np.einsum("ij,ij->i", out, part)


def largest_disks(part: Floats) -> tuple[Floats, float]:
    """Return the centres, (k, 2), and the radius of the largest disks in a convex part: they touch three sides."""
    out, far = _sides(part)
    three = np.array(list(combinations(range(len(part)), 3)))
    rows = np.concatenate([out[three], np.ones((len(three), 3, 1))], axis=2)
    usable = np.abs(np.linalg.det(rows)) > _SAME
    found = np.linalg.solve(rows[usable], far[three[usable]][:, :, np.newaxis])[:, :, 0]
    inside = (far - found[:, :2] @ out.T).min(axis=1)
    radius = float(inside.max())
    centres = found[inside >= (1.0 - _SAME) * radius, :2]
    return np.unique(centres.round(12), axis=0), radius * (1.0 - _SAME)


def _shrunk(part: Floats) -> Floats:
    centres, radius = largest_disks(part)
    return np.asarray(centres[0] + (part - centres[0]) * (1.0 - min(SHRUNK / radius, 0.5)))


def _covering(parts: Sequence[Floats]) -> tuple[float, Floats]:
    """Return the radius and the centres, (k, 2), of equal disks that cover all parts, a row of them for each part."""
    boxes = [_box_around(part) for part in parts]
    # A disk of a square box reaches 1.4 times as far as its sides; more of them hardly reach less far.
    wanted = [min(max(math.ceil(1.5 * long / wide), 1), _MOST_COVERING) for _, _, long, wide in boxes]
    radius = max(0.5 * math.hypot(long / count, wide) for count, (_, _, long, wide) in zip(wanted, boxes, strict=True))
    centres = []
    for middle, direction, long, wide in boxes:
        count = next(k for k in range(1, _MOST_COVERING + 1) if 0.5 * math.hypot(long / k, wide) <= radius)
        shares = (np.arange(count) + 0.5) / count - 0.5
        centres.append(middle + long * shares[:, np.newaxis] * direction)
    return radius, np.concatenate(centres)


def _box_around(part: Floats) -> tuple[Floats, Floats, float, float]:
    """Return the middle, the longer direction, the length and the width of a box around a part, along a side of it."""
    best = None
    for normal in _sides(part)[0]:
        along = np.array([-normal[1], normal[0]])
        on, off = part @ along, part @ normal
        long, wide = float(np.ptp(on)), float(np.ptp(off))
        middle = 0.5 * (on.min() + on.max()) * along + 0.5 * (off.min() + off.max()) * normal
        box = (middle, along, long, wide) if long >= wide else (middle, normal, wide, long)
        if best is None or box[2] * box[3] < best[2] * best[3]:
            best = box
    assert best is not None, "a part has sides"
    return best


def _rounded(part: Floats, by: float) -> Floats:
    """Return a convex polygon around all points within a distance of a convex part: corners get sides of their own."""
    out, _ = _sides(part)
    corners = []
    for corner, before, after in zip(part, np.roll(out, 1, axis=0), out, strict=True):
        first = math.atan2(before[1], before[0])
        angle = math.atan2(before[0] * after[1] - before[1] * after[0], float(before @ after))
        count = max(math.ceil(angle / _ARC), 1)
        half = 0.5 * angle / count
        middles = first + half * (2.0 * np.arange(count) + 1.0)
        corners.append(corner + by / math.cos(half) * np.column_stack([np.cos(middles), np.sin(middles)]))
    return np.concatenate(corners)
