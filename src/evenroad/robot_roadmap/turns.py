"""Whole turns: joints that span more than one are planned in one, and the search follows how often they turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.space import JointSpace

TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class OneTurn:
    """The ranges of a robot's joints, each revolute one cut to one turn.

    Attributes
    ----------
    low, high : ndarrays, shape (dim,)
        What milestones are drawn in [rad or m]; a joint of more than one turn has the turn in the middle of its range.
    limits : ndarray, shape (2, dim)
        The joints' own ranges [rad or m].
    wraps : ndarray of bool, shape (dim,)
        Joints whose edges may lead over the end of the range: those that turn on for ever, or more than once.
    lifts : ndarray of bool, shape (dim,)
        Of these, the ones with limits: their number of turns is counted along a path.
    """

    low: Floats
    high: Floats
    limits: Floats
    wraps: Bools
    lifts: Bools

    @property
    def period(self) -> Floats:
        """After how much each joint repeats, inf where it does not, (dim,)."""
        return np.where(self.wraps, TURN, np.inf)

    @property
    def space(self) -> JointSpace:
        """The ranges as a space in which all `wraps` repeat."""
        return JointSpace(self.low, self.high, self.wraps.tolist())

    def within_limits(self, q: Floats, towards: Floats) -> Floats:
        """Return configurations, (n, dim), turned so that they are as near as possible to others within the limits."""
        turns = np.rint((towards - q) / TURN)
        least, most = np.ceil((self.limits[0] - q) / TURN), np.floor((self.limits[1] - q) / TURN)
        return np.where(self.lifts, q + TURN * np.clip(turns, least, most), q)


def one_turn(space: JointSpace, revolute: Bools) -> OneTurn:
    """Return the ranges of a space's joints, cut to one turn where a `revolute` one, (dim,), has more."""
    limits = np.array([space.low, space.high])
    endless = np.array(space.wrapping)
    lifts = revolute & ~endless & (limits[1] - limits[0] > TURN)
    middle = limits.mean(axis=0)
    low = np.where(lifts, middle - 0.5 * TURN, limits[0])
    high = np.where(lifts, middle + 0.5 * TURN, limits[1])
    return OneTurn(low, high, limits, endless | lifts, lifts)


def shifts(one: OneTurn, a: Floats, b: Floats) -> Ints:
    """Return by how many turns the shortest way from each row of `a` leads past `b`, (m, dim)."""
    return np.where(one.wraps, np.rint((a - b) / TURN), 0.0).astype(np.int64)
