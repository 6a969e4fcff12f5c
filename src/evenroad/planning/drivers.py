"""The sequences that drive an arm's queries, as the native kernel takes them."""

from __future__ import annotations

from collections.abc import Callable

from evenroad._arrays import Floats
from evenroad._native.planning import Drivers, Points
from evenroad._shared import once
from evenroad.points.reversed_halton import PAIRS, ball_points, cube_points, share_pairs, sphere_points


@once
def native_points(points: Callable[[int], Floats], number: int) -> Points:
    """Return the points of a function for a number, in the form of the native kernel.

    They are checked once and cached, because the check takes longer than a short plan.
    """
    return Points(points(number))


@once
def drivers(dim: int) -> Drivers:
    """Return the sequences that drive the queries of an arm with `dim` joints."""
    return drivers_by(native_points(cube_points, dim), dim)


def drivers_by(samples: Points, dim: int) -> Drivers:
    """Return the same sequences, but with these points that trees grow towards."""
    others = native_points(ball_points, dim), native_points(share_pairs, PAIRS), native_points(sphere_points, dim)
    return Drivers(samples, *others)
