"""Whole turns: joints that span more than one turn are planned in one, and the search counts the turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._native import robot_roadmap
from evenroad.robot import ArmWorld, Robot
from evenroad.robot.arm_world import VALIDATION_TOLERANCE
from evenroad.space import JointSpace

TURN = 2.0 * np.pi

MOST_TURNS = robot_roadmap.MOST_TURNS
"""Largest number of turns to either side."""

MOST_MULTI_TURN = robot_roadmap.MOST_MULTI_TURN
"""Largest number of joints with more than one turn: the first ones."""


@dataclass(frozen=True, eq=False)
class OneTurn:
    """The ranges of a robot's joints, each cut to one turn where it has more.

    Attributes
    ----------
    low, high : ndarrays, shape (dim,)
        Ranges of milestones [rad or m]; a joint of more than one turn has the turn in the middle of its range.
    limits : ndarray, shape (2, dim)
        The joints' own ranges; of `multi_turn` joints at most MOST_TURNS to either side of `low` and `high` [rad or m].
    wraps : ndarray of bool, shape (dim,)
        Joints whose edges may lead over the end of the range: endless ones, and those of more than one turn.
    multi_turn : ndarray of bool, shape (dim,)
        The ones of these with limits; their number of turns is counted along a path.
    """

    low: Floats
    high: Floats
    limits: Floats
    wraps: Bools
    multi_turn: Bools


def one_turn(space: JointSpace, whole: Bools) -> OneTurn:
    """Return the ranges of a space's joints, cut to one turn where they have more and a turn is `whole`, (dim,).

    Joints beyond the first MOST_MULTI_TURN keep theirs.
    """
    limits = np.array([space.low, space.high])
    endless = np.array(space.wrapping)
    multi_turn = whole & ~endless & (limits[1] - limits[0] > TURN)
    multi_turn[MOST_MULTI_TURN:] = False
    middle = limits.mean(axis=0)
    low = np.where(multi_turn, middle - 0.5 * TURN, limits[0])
    high = np.where(multi_turn, middle + 0.5 * TURN, limits[1])
    limits[0, multi_turn] = np.maximum(limits[0], low - MOST_TURNS * TURN)[multi_turn]
    limits[1, multi_turn] = np.minimum(limits[1], high + MOST_TURNS * TURN)[multi_turn]
    return OneTurn(low, high, limits, endless | multi_turn, multi_turn)


def shifts(one: OneTurn, a: Floats, b: Floats) -> Ints:
    """Return by how many turns the shortest motion from each row of `a` leads past `b`, (m, dim)."""
    return np.where(one.wraps, np.rint((a - b) / TURN), 0.0).astype(np.int64)


def whole_turns(robot: Robot) -> Bools:
    """Return for which joints of the group a turn changes nothing, (dim,): not for sliding ones, nor those others
    follow.
    """
    kinds = {joint.name: joint.kind for joint in robot.joints}
    leaders = {joint.mimic.joint for joint in robot.joints if joint.mimic is not None}
    return np.array([kinds[name] != "prismatic" and name not in leaders for name in robot.group])


def winding_motions_free(world: ArmWorld, one: OneTurn, a: Floats, b: Floats, turns: Ints) -> Bools:
    """Return which motions are proved free, with both endpoints turned to be within the limits: (m,)."""
    b = np.where(one.multi_turn, b + TURN * turns, b)
    low, high = np.minimum(a, b), np.maximum(a, b)
    least, most = np.ceil((one.limits[0] - low) / TURN), np.floor((one.limits[1] - high) / TURN)
    turned = np.where(one.multi_turn, TURN * np.clip(0.0, least, most), 0.0)
    fits = np.all(~one.multi_turn | (least <= most), axis=1)
    free = np.zeros(len(a), dtype=np.bool_)
    free[fits] = world.motion_certified((a + turned)[fits], (b + turned)[fits], VALIDATION_TOLERANCE)
    return free
