"""The fastest times along a rounded path within limits of speed and acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native.trajectory import squared_speeds
from evenroad.trajectory.blends import RoundedPath
from evenroad.trajectory.limits import Limits

INTERVALS = 600
"""Number of intervals of a whole path, about: the acceleration along it is constant in each."""

_PER_ARC, _PER_LINE = 8, 4
_WITHIN = 1.0 - 1e-3
"""Share of the acceleration limits used: between two grid points an arc may take a little more."""


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """Length along a path as a function of time; the acceleration along it is constant between `times`, (m,)."""

    path: RoundedPath
    times: Floats
    lengths: Floats
    speeds: Floats
    accelerations: Floats

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.times[-1])

    def length_at(self, t: Floats) -> Floats:
        """Return the lengths along the path at times, (n,) [s]."""
        return self._where(np.clip(t, 0.0, self.duration))[1]

    def _where(self, t: Floats) -> tuple[Ints, Floats, Floats]:
        """Return interval, length and speed along the path at times within the duration."""
        i = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.accelerations) - 1)
        after, push = t - self.times[i], self.accelerations[i]
        s = self.lengths[i] + after * (self.speeds[i] + 0.5 * push * after)
        return (
            i,
            np.clip(s, self.lengths[i], self.lengths[i + 1]),
            np.maximum(self.speeds[i] + push * after, 0.0),
        )

    def at(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Return positions, velocities and accelerations, (n, dim) each, at times, (n,) [s]; at rest outside."""
        inside = (t >= 0.0) & (t <= self.duration)
        i, s, speed = self._where(np.clip(t, 0.0, self.duration))
        # The end of an interval belongs to its own piece, whose curvature may differ from the next one's.
        piece = self.path.piece_at(0.5 * (self.lengths[i] + self.lengths[i + 1]))
        position, direction, bend = self.path.at(s, piece)
        speed = np.where(inside, speed, 0.0)[:, None]
        push = np.where(inside, self.accelerations[i], 0.0)[:, None]
        return position, direction * speed, direction * push + bend * speed**2


def fastest(path: RoundedPath, limits: Limits) -> TimeLaw:
    """Return the fastest law from rest to rest (the two passes of Pham and Pham 2018, TOPP-RA, algorithm 1)."""
    share = np.diff(path.starts) / path.length
    least = np.where(path.bend > 0.0, _PER_ARC, _PER_LINE)
    counts = np.maximum(np.ceil(INTERVALS * share).astype(int), least)
    piece = np.repeat(np.arange(len(counts)), counts)
    marks = np.concatenate(
        [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(path.starts[:-1], path.starts[1:], counts, strict=True)]
    )
    grid = np.concatenate([[0.0], marks])
    first, ahead, ahead_bend = path.at(grid[:-1], piece)
    last, behind, behind_bend = path.at(grid[1:], piece)
    velocity, acceleration = np.array(limits.velocity), _WITHIN * np.array(limits.acceleration)
    with np.errstate(divide="ignore"):
        most = [np.min(velocity / np.abs(side), axis=1) ** 2 for side in (ahead, behind)]
    if limits.tip is not None:
        of_tip = [_WITHIN * limits.tip.along(*side) for side in ((first, ahead), (last, behind))]
        most = [np.minimum(each, tip**2) for each, tip in zip(most, of_tip, strict=True)]
    ceiling = np.zeros(len(grid))
    ceiling[1:-1] = np.minimum(most[0][1:], most[1][:-1])
    if limits.along_path is not None:
        ceiling = np.minimum(ceiling, limits.along_path**2)
    ceiling[np.isin(grid, path.stops)] = 0.0
    curve = ahead, ahead_bend, behind, behind_bend, np.diff(grid)
    squares = squared_speeds(curve, ceiling, acceleration)
    speeds, steps = np.sqrt(squares), np.diff(grid)
    took = 2.0 * steps / (speeds[:-1] + speeds[1:])
    times = np.concatenate([[0.0], np.cumsum(took)])
    return TimeLaw(path, times, grid, speeds, np.diff(squares) / (2.0 * steps))


def slowed(law: TimeLaw, factor: float) -> TimeLaw:
    """Return the law slowed down by a factor >= 1."""
    return TimeLaw(law.path, law.times * factor, law.lengths, law.speeds / factor, law.accelerations / factor**2)


def paused(law: TimeLaw, pause: float) -> TimeLaw:
    """Return the law with a pause, >= 0 [s], at every stop within the path."""
    stops = 1 + np.flatnonzero(law.speeds[1:-1] == 0.0)
    if pause == 0.0 or len(stops) == 0:
        return law
    rows = np.insert(np.arange(len(law.times)), stops, stops)
    waits = np.zeros(len(rows))
    waits[stops + 1 + np.arange(len(stops))] = pause
    return TimeLaw(
        law.path,
        law.times[rows] + np.cumsum(waits),
        law.lengths[rows],
        law.speeds[rows],
        np.insert(law.accelerations, stops, 0.0),
    )
