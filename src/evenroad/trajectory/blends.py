"""Paths with corners rounded by arcs of circles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats

_STRAIGHT = 1e-6
"""Angle below which a corner counts as straight [rad]: the largest error of the next arc."""


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
    steps = np.diff(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    directions = steps / lengths[:, None]
    before, after = directions[:-1], directions[1:]
    # Half of the turning angle, exact for small ones, too.
    half = np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))
    turns = half > 0.5 * _STRAIGHT
    # A reversal has no arc.
    round_off = turns & (half < 0.5 * np.pi - 1e-3) & (deviation[1:-1] > 0.0)
    available = 0.5 * np.minimum(lengths[:-1], lengths[1:])
    cut = np.zeros(len(path))
    with np.errstate(divide="ignore", invalid="ignore"):
        by_deviation = deviation[1:-1] * np.sin(half) / (1.0 - np.cos(half))
    cut[1:-1] = np.where(round_off, np.minimum(available, by_deviation), 0.0)

    pieces: list[tuple[float, Floats, Floats, Floats, float]] = []
    corners, stops, nowhere, total = [], [], np.zeros(path.shape[1]), 0.0
    for i, (length, direction) in enumerate(zip(lengths, directions, strict=True)):
        if i and round_off[i - 1]:
            radius = cut[i] / np.tan(half[i - 1])
            inward = after[i - 1] - before[i - 1]
            inward /= np.linalg.norm(inward)
            centre = path[i] + inward * (radius / np.cos(half[i - 1]))
            out = path[i] - cut[i] * before[i - 1] - centre
            pieces.append((total, centre, out / radius, before[i - 1], 1.0 / radius))
            corners.append(total + radius * half[i - 1])
            total += radius * 2.0 * half[i - 1]
        elif i:
            corners.append(total)
            stops += [total] if turns[i - 1] else []
        line = length - cut[i] - cut[i + 1]
        if line > 1e-12 * length:
            pieces.append((total, path[i] + cut[i] * direction, nowhere, direction, 0.0))
            total += line
    starts, origin, out, along, bend = (np.array(column) for column in zip(*pieces, strict=True))
    return RoundedPath(np.append(starts, total), origin, out, along, bend, np.array(corners), np.array(stops))
