"""The fastest times along a rounded path within limits of speed and acceleration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._njit import njit
from evenroad.trajectory.blends import RoundedPath
from evenroad.trajectory.limits import Limits

INTERVALS = 600
"""Number of intervals of a whole path, about: the acceleration along it is constant in each."""

_PER_ARC, _PER_LINE = 8, 4
_HALVINGS = 40
_WITHIN = 1.0 - 1e-3
"""Share of the acceleration limits that is used: between two grid points a bend may take a little more."""


@dataclass(frozen=True, eq=False)
class TimeLaw:
    """How far along a path one is at what time: the acceleration along it is constant between `times`, (m,)."""

    path: RoundedPath
    times: Floats
    lengths: Floats
    speeds: Floats
    accelerations: Floats

    @property
    def duration(self) -> float:
        """Of the whole [s]."""
        return float(self.times[-1])

    def length_at(self, t: Floats) -> Floats:
        """Return how far along the path one is at times, (n,) [s]."""
        return self._where(np.clip(t, 0.0, self.duration))[1]

    def _where(self, t: Floats) -> tuple[Ints, Floats, Floats]:
        """Return for times within the law the interval, the length, and the speed along the path."""
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
        # The end of an interval belongs to its own piece, whose bend may differ from the next one's.
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
    marks = np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b, n in _spans(path.starts, counts)])
    grid = np.concatenate([[0.0], marks])
    _, ahead, ahead_bend = path.at(grid[:-1], piece)
    _, behind, behind_bend = path.at(grid[1:], piece)
    velocity, acceleration = np.array(limits.velocity), _WITHIN * np.array(limits.acceleration)
    with np.errstate(divide="ignore"):
        most = [np.min(velocity / np.abs(side), axis=1) ** 2 for side in (ahead, behind)]
    ceiling = np.zeros(len(grid))
    ceiling[1:-1] = np.minimum(most[0][1:], most[1][:-1])
    if limits.along_path is not None:
        ceiling = np.minimum(ceiling, limits.along_path**2)
    ceiling[np.isin(grid, path.stops)] = 0.0
    curve = ahead, ahead_bend, behind, behind_bend, np.diff(grid)
    squares = _squared_speeds(curve, ceiling, acceleration)
    speeds, steps = np.sqrt(squares), np.diff(grid)
    took = 2.0 * steps / (speeds[:-1] + speeds[1:])
    times = np.concatenate([[0.0], np.cumsum(took)])
    return TimeLaw(path, times, grid, speeds, np.diff(squares) / (2.0 * steps))


def stretched(law: TimeLaw, factor: float) -> TimeLaw:
    """Return the law that takes `factor` as long, >= 1."""
    return TimeLaw(
        law.path, law.times * factor, law.lengths, law.speeds / factor, law.accelerations / factor**2
    )


def paused(law: TimeLaw, pause: float) -> TimeLaw:
    """Return the law with a pause, >= 0 [s], wherever one comes to a stop within the path."""
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


def _spans(starts: Floats, counts: Ints) -> list[tuple[float, float, int]]:
    return list(zip(starts[:-1].tolist(), starts[1:].tolist(), counts.tolist(), strict=True))


@njit(cache=True)
def _squared_speeds(curve, ceiling, acceleration):  # type: ignore[no-untyped-def]
    """Return the squares of the speeds along a path at its grid, (m,): back for what can be stopped, then on."""
    m, steps = len(ceiling), curve[4]
    highest = np.empty(m)
    highest[m - 1] = 0.0
    for i in range(m - 2, -1, -1):
        low, high = 0.0, ceiling[i]
        least, most = _push(i, high, highest[i + 1], curve, acceleration)
        if least <= most:
            low = high
        for _ in range(_HALVINGS):
            if low == high:
                break
            middle = 0.5 * (low + high)
            least, most = _push(i, middle, highest[i + 1], curve, acceleration)
            if least <= most:
                low = middle
            else:
                high = middle
        highest[i] = low
    squares = np.zeros(m)
    for i in range(m - 1):
        _, most = _push(i, squares[i], highest[i + 1], curve, acceleration)
        squares[i + 1] = min(max(squares[i] + 2.0 * steps[i] * most, 0.0), highest[i + 1])
    return squares


@njit(cache=True)
def _push(i, square, next_square, curve, acceleration):  # type: ignore[no-untyped-def]
    """Return the least and the most acceleration along interval i from this squared speed that keep all limits.

    Joint j accelerates by ``direction * push + bend * square`` at either end; at the far one the square is larger by
    ``2 step push``, and is from 0 to `next_square`.
    """
    ahead, ahead_bend, behind, behind_bend, steps = curve
    twice = 2.0 * steps[i]
    least, most = -square / twice, (next_square - square) / twice
    for j in range(len(acceleration)):
        for end in range(2):
            if end == 0:
                slope, rest = ahead[i, j], ahead_bend[i, j] * square
            else:
                slope = behind[i, j] + behind_bend[i, j] * twice
                rest = behind_bend[i, j] * square
            if abs(slope) < 1e-12:
                if abs(rest) > acceleration[j]:
                    return 1.0, 0.0
                continue
            one, other = (-acceleration[j] - rest) / slope, (acceleration[j] - rest) / slope
            least, most = max(least, min(one, other)), min(most, max(one, other))
    return least, most
