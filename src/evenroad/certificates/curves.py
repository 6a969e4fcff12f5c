"""Curves that a certificate is about: straight motions, or parabolas near which a robot drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats


@dataclass(frozen=True)
class Curves:
    """Motions one after the other, by the control points, (degree * motions + 1, dim), of their Bezier curves.

    The robot's configuration is within `tolerance` of them [rad or m].
    """

    points: Floats
    degree: int = 1
    tolerance: float = 0.0

    @property
    def controls(self) -> Floats:
        """The three control points of each motion, (motions, 3, dim)."""
        first, last = self.points[: -self.degree : self.degree], self.points[self.degree :: self.degree]
        middle = self.points[1::2] if self.degree == 2 else 0.5 * (first + last)
        return np.ascontiguousarray(np.stack([first, middle, last], axis=1), dtype=float)


def straight(path: Floats) -> Curves:
    """Return the straight motions of a path, (p, dim)."""
    return Curves(path)


TOLERANCES = (5e-4, 2e-4, 1e-4, 1e-5, 1e-6)
"""How far states are from parabolas along them [rad or m]: certificates are tried in this order.

Nearer ones are many: a way between two states of a corner is straight, and some 1e-4 from any smooth curve.
"""
_ROUNDS = 2
_FINE = 64
"""Parts of a curve that a checker looks at."""
_SHARE = 0.8
"""Of the tolerance, for states; the rest is for how far a curve strays from straight ways between its parts."""


def driven(states: Floats, waypoints: Floats, tolerance: float) -> Curves:
    """Return parabolas, one after the other, along straight motions between states, (n, dim), at most so far away.

    Each is the longest that fits: lines become one, an arc a few.  Their control points are within the range of each
    joint over states and waypoints, (p, dim), which keep its limits.
    """
    ranges = np.concatenate([states, waypoints])
    low, high = ranges.min(axis=0), ranges.max(axis=0)
    points, begin = [states[:1]], 0
    while begin < len(states) - 1:
        end, step = begin + 1, 1
        middle = 0.5 * (states[begin] + states[end])
        # Twice as many states as long as these fit, then half of the rest.
        while step:
            last = min(end + step, len(states) - 1)
            found = _fitted(states[begin : last + 1], low, high, tolerance) if last > end else None
            if found is not None:
                middle, end, step = found, last, 2 * step
            else:
                step //= 2
        points += [middle[np.newaxis], states[end : end + 1]]
        begin = end
    return Curves(np.concatenate(points), 2, tolerance)


def _fitted(states: Floats, low: Floats, high: Floats, tolerance: float) -> Floats | None:
    """Return the middle control point of a parabola along states, from the first to the last; None if none is near."""
    first, last = states[0], states[-1]
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(states, axis=0), axis=1))])
    if travelled[-1] == 0.0:
        return np.asarray(first)
    t = (travelled / travelled[-1])[:, np.newaxis]
    for _ in range(_ROUNDS):
        outer, weight = (1 - t) ** 2 * first + t**2 * last, 2 * t * (1 - t)
        middle = np.asarray((weight * (states - outer)).sum(axis=0) / (weight**2).sum()).clip(low, high)
        off, bend, steps = outer + weight * middle - states, 2 * (last - 2 * middle + first), np.diff(t[:, 0])
        # A chord is as far from its parabola as the second derivative allows.
        bends, farthest = float(np.linalg.norm(bend)) / 8.0, float(np.linalg.norm(off, axis=1).max())
        is_near = farthest + bends * float((steps**2).max()) < _SHARE * tolerance
        if is_near and bends / _FINE**2 < (1.0 - _SHARE) * tolerance and steps.min() >= 0.0:
            return np.asarray(middle)
        # Newton's method for the nearest place of the parabola (Schneider 1990).
        along = 2 * (1 - t) * (middle - first) + 2 * t * (last - middle)
        slope = (along**2).sum(axis=1, keepdims=True) + (off @ bend)[:, np.newaxis]
        t = np.clip(t - (off * along).sum(axis=1, keepdims=True) / np.where(slope > 0.0, slope, np.inf), 0.0, 1.0)
        t[0], t[-1] = 0.0, 1.0
    return None
