"""The fastest times along a rounded path within limits of speed and acceleration; ``make.py`` averages for jerk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad._native import trajectory as kernel
from evenroad._native.trajectory import JointLimits, RoundedPath, Shares, States
from evenroad.trajectory.limits import Limits

_WITHIN = 1.0 - 1e-3
"""Share of the limits that the law uses, because values between two grid points may be slightly larger."""


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

    @property
    def native(self) -> kernel.TimeLaw:
        """The law in the form of the native kernel."""
        return kernel.TimeLaw(self.times, self.lengths, self.speeds, self.accelerations)

    def at(self, t: Floats) -> States:
        """Return positions, velocities and accelerations, (n, dim) each, at times, (n,) [s]; at rest outside."""
        return kernel.states(self.path, self.native, t)

    def averages(self, window: float, t: Floats) -> States:
        """Return averages of :meth:`at` over the `window` before each of some rising times, > 0 [s]."""
        return kernel.averages(self.path, self.native, window, t)

    def largest_shares(self, limits: Limits, samples: int) -> Shares:
        """Return the largest shares of velocity and acceleration at `samples` times in each interval."""
        return kernel.largest_shares(self.path, self.native, limits.of_joints, samples)


def fastest(path: RoundedPath, limits: Limits, share: float = 1.0) -> TimeLaw:
    """Return the fastest law from rest to rest (the two passes of Pham and Pham 2018, TOPP-RA, algorithm 1).

    A whole path has about 400 intervals.  The law uses a share of the limits of a tip and of torques.
    """
    most = limits.of_joints
    within = JointLimits(most.velocity, _WITHIN * most.acceleration, _WITHIN * most.deceleration)
    found = kernel.fastest(path, within, limits.along(0.0, 0.0, _WITHIN * share))
    if found is None:
        steady = TimeLaw(path, path.starts, path.starts, np.ones(len(path.starts)), np.zeros(len(path.bend)))
        raise limits.too_heavy(steady.at(np.linspace(0.0, path.length, 600)).positions)
    return TimeLaw(path, found.times, found.lengths, found.speeds, found.accelerations)


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
