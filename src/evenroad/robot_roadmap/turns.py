"""Whole turns: joints that span more than one are planned in one, and the search follows how often they turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad.robot import ArmWorld, Robot
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.space import JointSpace

TURN = 2.0 * np.pi

MOST_TURNS = 6
"""So many turns to either side are followed; the packed form of the search has room for one more."""

MOST_LIFTED = 14
"""And of so many joints, the first ones."""


@dataclass(frozen=True, eq=False)
class OneTurn:
    """The ranges of a robot's joints, each cut to one turn where it has more.

    Attributes
    ----------
    low, high : ndarrays, shape (dim,)
        What milestones are drawn in [rad or m]; a joint of more than one turn has the turn in the middle of its range.
    limits : ndarray, shape (2, dim)
        The joints' own ranges; of one that `lifts` at most MOST_TURNS to either side of `low` and `high` [rad or m].
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


def one_turn(space: JointSpace, whole: Bools) -> OneTurn:
    """Return the ranges of a space's joints, cut to one turn where they have more and a turn is `whole`, (dim,).

    Joints beyond the first MOST_LIFTED keep theirs.
    """
    limits = np.array([space.low, space.high])
    endless = np.array(space.wrapping)
    lifts = whole & ~endless & (limits[1] - limits[0] > TURN)
    lifts[MOST_LIFTED:] = False
    middle = limits.mean(axis=0)
    low = np.where(lifts, middle - 0.5 * TURN, limits[0])
    high = np.where(lifts, middle + 0.5 * TURN, limits[1])
    limits[0, lifts] = np.maximum(limits[0], low - MOST_TURNS * TURN)[lifts]
    limits[1, lifts] = np.minimum(limits[1], high + MOST_TURNS * TURN)[lifts]
    return OneTurn(low, high, limits, endless | lifts, lifts)


def shifts(one: OneTurn, a: Floats, b: Floats) -> Ints:
    """Return by how many turns the shortest way from each row of `a` leads past `b`, (m, dim)."""
    return np.where(one.wraps, np.rint((a - b) / TURN), 0.0).astype(np.int64)


def whole_turns(robot: Robot) -> Bools:
    """Return for which joints of the group a turn changes nothing, (dim,): not for one that slides, or leads others."""
    kinds = {joint.name: joint.kind for joint in robot.joints}
    leaders = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    return np.array([kinds[name] != "prismatic" and name not in leaders for name in robot.group])


def lifted_motions_free(world: ArmWorld, one: OneTurn, a: Floats, b: Floats, turns: Ints) -> Bools:
    """Return which motions are proved free, with both ends turned so that they are within the limits: (m,)."""
    b = np.where(one.lifts, b + TURN * turns, b)
    low, high = np.minimum(a, b), np.maximum(a, b)
    least, most = np.ceil((one.limits[0] - low) / TURN), np.floor((one.limits[1] - high) / TURN)
    turned = np.where(one.lifts, TURN * np.clip(0.0, least, most), 0.0)
    fits = np.all(~one.lifts | (least <= most), axis=1)
    free = np.zeros(len(a), dtype=np.bool_)
    free[fits] = world.motion_certified((a + turned)[fits], (b + turned)[fits], RECHECK_TOLERANCE)
    return free
