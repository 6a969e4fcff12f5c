"""The fastest motion from rest to rest along segments of which each has a largest speed and acceleration."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints


class Segments(NamedTuple):
    """Parts of a path, one after the other: values of each, (m,)."""

    piece: Ints
    """Number of the piece of the path that it lies on."""
    begin: Floats
    """Length along that piece at which it begins."""
    length: Floats
    """Its length, > 0."""
    fastest: Floats
    """Largest speed, > 0."""
    push: Floats
    """Largest acceleration and deceleration along the path, > 0."""
    rest: Floats
    """Least time to stand still before it [s]; nan where it need not stop."""


class Where(NamedTuple):
    """Where a law is at some times: piece, length along it, speed and acceleration, (n,) each.

    `rested` is the share of a rest that is over; it is 1 in motion.
    """

    piece: Ints
    length: Floats
    speed: Floats
    push: Floats
    rested: Floats


class SpeedLaw(NamedTuple):
    """Length along a path over time: `times`, (k + 1,), and what holds between two of them, (k,) each."""

    times: Floats
    piece: Ints
    begin: Floats
    speed: Floats
    push: Floats

    def at(self, t: Floats) -> Where:
        """Return where it is at times, (n,) [s], from 0 to the last."""
        i = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.piece) - 1)
        after = t - self.times[i]
        speed = np.maximum(self.speed[i] + self.push[i] * after, 0.0)
        is_rest = (self.speed[i] == 0.0) & (self.push[i] == 0.0)
        rested = np.where(is_rest, after / np.diff(self.times)[i], 1.0)
        return Where(self.piece[i], self.begin[i] + 0.5 * after * (self.speed[i] + speed), speed, self.push[i], rested)


def fastest_law(segments: Segments) -> SpeedLaw:
    """Return the fastest motion along segments, which is exact: two passes over the squares of speeds where they meet.

    Within a segment it accelerates, keeps its speed, and brakes.
    """
    length, fastest, push = (values.tolist() for values in (segments.length, segments.fastest, segments.push))
    highest = [0.0, *(min(a, b) ** 2 for a, b in pairwise(fastest)), 0.0]
    for i in np.flatnonzero(~np.isnan(segments.rest)).tolist():
        highest[i] = 0.0
    for i, far in enumerate(length):
        highest[i + 1] = min(highest[i + 1], highest[i] + 2.0 * push[i] * far)
    for i, far in reversed([*enumerate(length)]):
        highest[i] = min(highest[i], highest[i + 1] + 2.0 * push[i] * far)
    rows: list[tuple[float, float, float, float, float]] = []
    for i, (far, begin, rest) in enumerate(zip(length, segments.begin, segments.rest, strict=True)):
        if rest > 0.0:
            rows.append((rest, i, begin, 0.0, 0.0))
        before, after, most = highest[i], highest[i + 1], push[i]
        peak = min(fastest[i] ** 2, 0.5 * (before + after) + most * far)
        first, top, last = np.sqrt([before, peak, after]).tolist()
        up, down = max(0.5 * (peak - before) / most, 0.0), max(0.5 * (peak - after) / most, 0.0)
        steady = max(far - up - down, 0.0)
        rows += [
            ((top - first) / most, i, begin, first, most),
            (steady / top, i, begin + up, top, 0.0),
            ((top - last) / most, i, begin + far - down, top, -most),
        ]
    lasts, number, begins, speeds, pushes = np.array([row for row in rows if row[0] > 0.0]).T
    piece = segments.piece[number.astype(np.int64)]
    return SpeedLaw(np.concatenate([[0.0], np.cumsum(lasts)]), piece, begins, speeds, pushes)
