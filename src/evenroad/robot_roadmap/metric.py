"""Distances of milestones after whole turns from each other and from start and goals; compiled."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.memory import CAPACITY, DIM, ENDLESS, HIGH, LOW, MULTI_TURN, NODES, Search
from evenroad.robot_roadmap.turns import MOST_MULTI_TURN, TURN

Floats = npt.NDArray[np.float64]

BITS = 4
"""Bits of one joint's turns in the packed number of all, ``sum_k turn_k 16^k``."""

_OFFSETS = sum(2 ** (BITS - 1) << (BITS * k) for k in range(MOST_MULTI_TURN))


@quick
def measure(s: Search, terminal: int) -> None:
    """Write the distance of each milestone from a terminal, after the turns that bring it nearest."""
    n, capacity = s.header[NODES], s.header[CAPACITY]
    away, turns = s.away[terminal * capacity :][:n], s.turns[terminal, :n]
    for i in range(len(away)):
        away[i] = 0.0
    initialised = False
    for k in range(s.header[DIM]):
        column, here = s.columns[k * capacity :][:n], np.float32(s.terminals[terminal, k])
        if s.rules[MULTI_TURN, k] > 0.0:
            low, high = s.rules[LOW, k], s.rules[HIGH, k]
            for i in range(len(away)):
                if not initialised:
                    turns[i] = 0
                value = s.milestones[i, k]
                turn = np.rint((s.terminals[terminal, k] - value) / TURN)
                turn = min(max(turn, np.ceil((low - value) / TURN)), np.floor((high - value) / TURN))
                apart = np.float32(value + TURN * turn - s.terminals[terminal, k])
                away[i] += apart * apart
                turns[i] += np.int64(turn) << (BITS * k)
            initialised = True
        elif s.rules[ENDLESS, k] > 0.0:
            for i in range(len(away)):
                apart = np.float32(apart_in(s, k, s.milestones[i, k] - s.terminals[terminal, k]))
                away[i] += apart * apart
        else:
            for i in range(len(away)):
                apart = column[i] - here
                away[i] += apart * apart
    for i in range(len(away)):
        away[i] = np.sqrt(away[i])


@quick
def write(s: Search, node: int, packed: int, q: Floats) -> None:
    """Write the configuration of a milestone after turns."""
    for k in range(s.header[DIM]):
        q[k] = s.milestones[node, k]
        if s.rules[MULTI_TURN, k] > 0.0:
            q[k] += TURN * _turn(packed, k)


@quick
def is_at(s: Search, terminal: int, node: int) -> bool:
    """Return whether a terminal equals a milestone after its turns; a distance of 0 in single precision may not mean
    it.
    """
    write(s, node, s.turns[terminal, node], s.motion[0])
    same = True
    for k in range(s.header[DIM]):
        same &= s.motion[0, k] == s.terminals[terminal, k]
    return same


@quick
def length_of_edge(s: Search, a: int, b: int, turns: int) -> float:
    """Return the length of the motion between two milestones that leads past the second by packed turns."""
    write(s, a, 0, s.motion[0])
    write(s, b, turns, s.motion[1])
    return distance(s, s.motion[0], s.motion[1])


@quick
def distance(s: Search, a: Floats, b: Floats) -> float:
    """Return the distance of two configurations in the metric of the space."""
    squared = 0.0
    for k in range(s.header[DIM]):
        squared += apart_in(s, k, b[k] - a[k]) ** 2
    return np.sqrt(squared)


@quick
def apart_in(s: Search, k: int, apart: float) -> float:
    """Return the difference of two values of a joint, the shorter one for an endless joint."""
    return apart - TURN * np.rint(apart / TURN) if s.rules[ENDLESS, k] > 0.0 else apart


@quick
def _turn(packed: int, k: int) -> int:
    """Return the turns of one joint from the packed number of all, ``sum_k turn_k 16^k``."""
    # Each is brought to 0 .. 15 first, so that a negative one does not borrow from the next.
    return (((packed + _OFFSETS) >> (BITS * k)) & (2**BITS - 1)) - 2 ** (BITS - 1)
