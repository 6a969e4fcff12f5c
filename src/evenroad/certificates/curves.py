"""Curves that a certificate is about: straight motions, or parabolas near which a robot drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.certificates import parabolas


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


def driven(states: Floats, waypoints: Floats, tolerance: float, strays: float = 0.0) -> Curves:
    """Return parabolas, one after the other, along straight motions between states, (n, dim), at most so far away.

    They are nearer by what the robot `strays` from these motions [rad or m].

    Each is the longest that fits: lines become one, an arc a few.  Their control points are within the range of each
    joint over states and waypoints, (p, dim), which keep its limits.
    """
    states = np.ascontiguousarray(states, dtype=float)
    ranges = np.concatenate([states, waypoints])
    return Curves(parabolas(states, ranges.min(axis=0), ranges.max(axis=0), tolerance - strays), 2, tolerance)
