"""Dividing a simple polygon into convex parts, exactly: parts are made of its own corners."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Floats

MOST_CORNERS = 24
"""Largest number of corners of a part."""


def convex_parts(polygon: Floats) -> list[Floats]:
    """Return convex parts of a simple counter-clockwise polygon, (n, 2), that make it up.

    Ears are cut off until a triangle is left; parts that share a side are then joined while they stay convex
    (S. Hertel and K. Mehlhorn, 1983).  A convex polygon is its only part.
    """
    every = list(range(len(polygon)))
    if _is_convex(polygon, every) and len(every) <= MOST_CORNERS:
        return [polygon]
    parts = _triangles(polygon)
    first = 0
    while first < len(parts):
        joined = next(
            ((k, both) for k in range(first + 1, len(parts)) if (both := _joined(polygon, parts[first], parts[k]))),
            None,
        )
        if joined is None:
            first += 1
            continue
        other, parts[first] = joined
        del parts[other]
    return [polygon[part] for part in parts]


def turn(a: Floats, b: Floats, c: Floats) -> float:
    """Return twice the signed area of a triangle: > 0 where it is counter-clockwise."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _triangles(polygon: Floats) -> list[list[int]]:
    """Return the triangles of a polygon, by the numbers of their corners."""
    left, parts = list(range(len(polygon))), []
    while len(left) > 3:
        ear = next(k for k in range(len(left)) if _is_ear(polygon, left, k))
        parts.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    return [*parts, left]


def _is_ear(polygon: Floats, left: list[int], k: int) -> bool:
    """Return whether the triangle at a corner lies in what is left of the polygon."""
    a, b, c = (polygon[left[(k + step) % len(left)]] for step in (-1, 0, 1))
    if turn(a, b, c) <= 0.0:
        return False
    corners = {left[k - 1], left[k], left[(k + 1) % len(left)]}
    others = (polygon[i] for i in left if i not in corners)
    return not any(turn(a, b, p) >= 0.0 and turn(b, c, p) >= 0.0 and turn(c, a, p) >= 0.0 for p in others)


def _joined(polygon: Floats, one: list[int], other: list[int]) -> list[int]:
    """Return the corners of two parts that share a side, where they make a convex part; else nothing."""
    if len(one) + len(other) - 2 > MOST_CORNERS:
        return []
    for i in range(len(one)):
        a, b = one[i], one[(i + 1) % len(one)]
        if a in other and other[(other.index(a) - 1) % len(other)] == b:
            j = other.index(a)
            both = [
                *one[: i + 1],
                *(other[(j + step) % len(other)] for step in range(1, len(other) - 1)),
                *one[i + 1 :],
            ]
            return both if _is_convex(polygon, both) else []
    return []


def _is_convex(polygon: Floats, part: list[int]) -> bool:
    corners = polygon[part]
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    return all(turn(a, b, c) > 0.0 for a, b, c in zip(before, corners, after, strict=True))
