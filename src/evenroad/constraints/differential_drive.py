"""DrivenWorld: an arm on a base that drives along its heading and turns in place, but cannot go sideways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._checks import require_known
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import TOLERANCE, KeptWorld, drop_blocked, is_backwards, turned_round
from evenroad.poses.constraint import Constraint
from evenroad.robots.robot import Robot

_HALF_TURNS = np.arange(-4, 5) * math.pi
"""Angles added to the direction of a drive: forwards or backwards, for every turn of a heading."""
_STILL = 1e-9
"""Distance below which a base does not drive [m]."""


@dataclass(frozen=True)
class DifferentialDrive(Constraint):
    """A base drives forwards or backwards along its heading, and turns in place: it cannot go sideways.

    Every motion turns, drives straight while the other joints move, and turns again.  At heading 0 the base faces
    along x.  It cannot be combined with other constraints.

    Parameters
    ----------
    x, y, heading : str
        The planned joints of the base.

    Examples
    --------
    >>> import evenroad as er
    >>> er.constraints.DifferentialDrive().heading
    'base/theta'
    """

    x: str = "base/x"
    y: str = "base/y"
    heading: str = "base/theta"

    def numbers(self, robot: Robot) -> tuple[int, int, int]:
        """Return the coordinates of the three; UnknownName if a joint is not planned."""
        for name in (self.x, self.y, self.heading):
            require_known(f"joint of {robot.name!r}:", name, robot.group)
        x, y, heading = map(robot.group.index, (self.x, self.y, self.heading))
        return x, y, heading


@dataclass(frozen=True, eq=False)
class DrivenWorld(KeptWorld):
    """The world of an arm on such a base.

    Attributes
    ----------
    base : tuple of 3 ints
        Coordinates of x, y and heading.
    """

    base: tuple[int, int, int] = (0, 1, 2)

    def _followed(self, a: Floats, b: Floats) -> tuple[Bools, Ints, Floats]:
        """Return which motions are free, and their states: turned, driven, and turned again."""
        back, given = is_backwards(a, b), (a, b)
        a, b = np.where(back[:, np.newaxis], given[::-1], given)
        heading = self._headings(a, b)
        states = np.stack([a, a, b, b], axis=1)
        states[:, 1:3, self.base[2]] = np.where(np.isfinite(heading), heading, 0.0)[:, np.newaxis]
        flat = self.space.wrapped(states.reshape(-1, a.shape[1]))
        motion = np.repeat(np.arange(len(a)), 4)
        good = np.isfinite(heading)
        drop_blocked(
            good,
            motion,
            lambda rows: self.world.motion_valid(flat[rows], flat[rows + 1]),
            lambda rows: self.world.motion_certified(flat[rows], flat[rows + 1], TOLERANCE),
        )
        rows = good[motion]
        rows[1:] &= (flat[1:] != flat[:-1]).any(axis=1) | (motion[1:] != motion[:-1])
        return good, *turned_round(motion[rows], flat[rows], back)

    def shortened(self, path: Floats) -> Floats:
        """Return a path, (p, dim), shortened as by `KeptWorld`, with successive turns joined into one."""
        path = super().shortened(path)
        others = np.delete(path, self.base[2], axis=1)
        turns = (others[1:] == others[:-1]).all(axis=1)
        kept = np.ones(len(path), dtype=np.bool_)
        kept[1:-1] = ~(turns[:-1] & turns[1:])
        rows = np.flatnonzero(kept)
        # If the joint has no limits, the joined turn may go in the other direction, which is not known to be free.
        free = self.world.motion_certified(path[rows[:-1]], path[rows[1:]], TOLERANCE)
        for first, last in zip(rows[:-1][~free], rows[1:][~free], strict=True):
            kept[first:last] = True
        path = path[kept]
        moved = (path[1:] != path[:-1]).any(axis=1)
        return path[np.concatenate([moved, [True]])] if moved.any() else path

    def _headings(self, a: Floats, b: Floats) -> Floats:
        """Return the headings, (m,), of drives from rows of `a` to those of `b` with the least turning.

        They are infinite if limits allow none.
        """
        x, y, heading = self.base
        gap = b[:, [x, y]] - a[:, [x, y]]
        first, last = a[:, heading], b[:, heading]
        each = np.arctan2(gap[:, 1], gap[:, 0]) + _HALF_TURNS[:, np.newaxis]
        turns = np.abs(np.stack([each - first, last - each]))
        period = self.space.flat.period[heading]
        if np.isfinite(period):
            turns = np.abs(turns - period * np.rint(turns / period))
            turning = turns.sum(axis=0)
        else:
            within = (each >= self.space.low[heading]) & (each <= self.space.high[heading])
            turning = np.where(within, turns.sum(axis=0), np.inf)
        # Rounded, so that rounding errors do not decide between equal turns.
        best = np.round(turning, 9).argmin(axis=0)
        number = np.arange(len(a))
        chosen = np.where(np.isfinite(turning[best, number]), each[best, number], np.inf)
        still = np.hypot(gap[:, 0], gap[:, 1]) < _STILL
        return np.asarray(np.where(still, first, chosen))


def driven_world(world: ArmWorld, drive: DifferentialDrive) -> DrivenWorld:
    """Return the world in which the base of a robot cannot go sideways."""
    return DrivenWorld(world, (), drive.numbers(world.robot))
