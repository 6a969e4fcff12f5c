"""Paths with corners rounded by arcs of circles."""

from __future__ import annotations

from dataclasses import dataclass

from evenroad._arrays import Floats
from evenroad._native.trajectory import rounded as native_rounded


@dataclass(frozen=True, eq=False)
class RoundedPath:
    """Straight lines and arcs, one after the other (Kunz and Stilman 2012, section IV).

    Piece i reaches from length ``starts[i]`` to ``starts[i + 1]``.  It is a line from ``origin[i]`` along ``along[i]``
    where the curvature ``bend[i]`` is 0, else an arc of radius ``1 / bend[i]`` about ``origin[i]``, from the direction
    ``out[i]`` towards ``along[i]``.  `corners`, (p - 2,), are the lengths at the inner waypoints, `stops` those at
    which the direction jumps.
    """

    starts: Floats
    origin: Floats
    out: Floats
    along: Floats
    bend: Floats
    corners: Floats
    stops: Floats

    @property
    def length(self) -> float:
        """Length of the path."""
        return float(self.starts[-1])

    @property
    def columns(self) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """The path as the native kernel takes it."""
        return self.starts, self.origin, self.out, self.along, self.bend


def rounded(path: Floats, deviation: Floats) -> RoundedPath:
    """Round the corners of a path, (p, dim), p >= 2, no two waypoints in a row equal.

    The arc at waypoint i passes it within ``deviation[i]``, (p,), and replaces at most half of both motions.  Where
    `deviation` is 0 the path stops at its corner.
    """
    return RoundedPath(*native_rounded(path, deviation))
