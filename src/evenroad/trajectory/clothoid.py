"""Pieces of a car's path whose curvature changes evenly, and the blend of a straight drive and a turn by two of them.

A piece is a row (curvature at its begin, at its end, signed length): straight drives, turns, and clothoids.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from evenroad._arrays import Floats

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_SHARES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
"""Gauss's rule on [0, 1]: exact to rounding for pieces of up to a full turn."""
LONGEST = 1.5
"""Largest length over which the steering goes from straight to a turn, in radii of it."""
_SWINGS = 0.1, 0.4
"""Bounds of the curvature of the swing, as a share of that of the turn: it is about 0.234."""
_SAMPLES = 33
"""Number of positions at which the deviation is measured, on each clothoid."""
BEFORE, AFTER, OFF = 1.0227, 0.446, 0.0249
"""Upper bounds for a turn of radius 1: of the straight drive and of the turn that a blend replaces, as shares of its
length, and of its deviation, as a share of the square of its length."""


def poses_on(starts: Floats, pieces: Floats, lengths: Floats) -> Floats:
    """Return the pose after a length >= 0 of each piece, (n, 3), that begins at a pose, (n, 3): (n, 3).

    Turns on the spot have infinite curvatures, and an angle in place of the length.
    """
    first, last, signed = pieces.T
    on_the_spot = np.isinf(first)
    driven = np.where(on_the_spot, 0.0, np.copysign(lengths, signed))[:, np.newaxis]
    first, last = (np.where(on_the_spot, 0.0, each)[:, np.newaxis] for each in (first, last))
    along = driven * _SHARES
    heading = starts[:, 2:] + along * (first + 0.5 * (last - first) * along / signed[:, np.newaxis])
    by = driven[:, 0, np.newaxis] * np.stack([np.cos(heading) @ _WEIGHTS, np.sin(heading) @ _WEIGHTS], axis=1)
    turned = driven * (first + 0.5 * (last - first) * driven / signed[:, np.newaxis])
    spots = np.where(on_the_spot, np.copysign(lengths, pieces[:, 0]), 0.0)
    return np.column_stack([starts[:, :2] + by, starts[:, 2] + turned[:, 0] + spots])


def starts_of(start: Floats, pieces: Floats) -> Floats:
    """Return the pose at which each piece begins, (k, 3), and that at which the last one ends, as (k + 1, 3)."""
    poses = [start]
    for piece in pieces:
        poses.append(poses_on(poses[-1][np.newaxis], piece[np.newaxis], np.abs(piece[2:]))[0])
    return np.array(poses)


class Blend(NamedTuple):
    """Two clothoids that replace the end of one piece and the begin of the next, so that the curvature does not jump.

    From a straight drive into a turn the curvature goes from 0 to the other side, and then to that of the turn: the car
    swings out a little.  No curve within the turn's curvature could else lead onto its circle.
    """

    pieces: Floats
    before: float
    """Length of the first piece that they replace."""
    after: float
    """Length of the second piece that they replace."""
    deviation: float
    """Largest distance from both."""

    def between(self, first: Floats, second: Floats) -> Blend:
        """Return the blend, of a straight drive and a turn to the left of radius 1, for two pieces, (3,) each.

        One of them is straight; the other is a turn of any radius, to any side, which may come first.
        """
        turn = second if first[0] == 0.0 else first
        radius = 1.0 / abs(turn[0])
        pieces = self.pieces * [turn[0], turn[0], np.copysign(radius, turn[2])]
        before, after = self.before * radius, self.after * radius
        if turn is first:
            pieces, before, after = pieces[::-1, [1, 0, 2]], after, before
        return Blend(pieces, before, after, self.deviation * radius)


def blend_of(length: float) -> Blend:
    """Return the blend of a straight drive and a turn to the left of radius 1.

    The steering takes the `length`, 0 < length <= `LONGEST`, from straight to the turn.
    """

    def pieces_of(swing: float) -> Floats:
        return np.array([[0.0, -swing, swing * length], [-swing, 1.0, (1.0 + swing) * length]])

    def turn_of(swing: float) -> float:
        return 0.5 * (1.0 - 2.0 * swing * swing) * length

    def off(swing: float) -> float:
        # By how much they end off the circle, whose centre is at a height of 1.
        return float(starts_of(np.zeros(3), pieces_of(swing))[-1, 1] - 1.0 + np.cos(turn_of(swing)))

    swing = float(brentq(off, *_SWINGS, xtol=1e-15))
    pieces, after = pieces_of(swing), turn_of(swing)
    starts = starts_of(np.zeros(3), pieces)
    before = float(starts[-1, 0] - np.sin(after))
    number = np.repeat([0, 1], _SAMPLES)
    along = np.tile(np.linspace(0.0, 1.0, _SAMPLES), 2) * pieces[number, 2]
    x, y, _ = poses_on(starts[number], pieces[number], along).T
    off_turn = np.abs(np.hypot(x - before, y - 1.0) - 1.0)
    return Blend(pieces, before, after, float(np.where(x < before, np.abs(y), off_turn).max()))


def corner_of(turned: float) -> Blend:
    """Return two clothoids of length 1 that turn to the left by an angle, 0 < turned < pi, from one straight drive to
    another.

    `before` and `after` are the lengths from their endpoints to where the straight drives would meet, and `deviation`
    is the distance of their middle from there.
    """
    pieces = np.array([[0.0, turned, 1.0], [turned, 0.0, 1.0]])
    x, y, half = starts_of(np.zeros(3), pieces[:1])[1]
    reach = float(x + y * np.tan(half))
    return Blend(pieces, reach, reach, float(y / np.cos(half)))
