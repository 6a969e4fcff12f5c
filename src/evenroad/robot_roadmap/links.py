"""The choice of milestones that start and goals are linked to, in compiled code."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.memory import (
    BLOCKED,
    CAPACITY,
    FREE,
    LINKS,
    NODES,
    PROVED,
    TERMINALS,
    Search,
    kept_in_order,
)
from evenroad.robot_roadmap.metric import is_at

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

ONWARD = 0.5
"""Weight of the distance beyond a link, in the order in which links are tried."""

HALVINGS = 12
"""Largest number of halvings of an interval, until it holds at most twice the wanted ones, which are then sorted."""


@quick
def choose_links(s: Search, terminal: int) -> None:
    """Choose milestones that are near, or towards the other terminals; a terminal at a milestone needs no other."""
    h, n = s.header, s.header[NODES]
    away = s.away[terminal * h[CAPACITY] : terminal * h[CAPACITY] + n]
    same = _milestone_at(s, terminal, away)
    if same >= 0:
        count, s.near[terminal, 0], s.links[terminal, same] = 1, same, PROVED
    else:
        wants = s.away[(h[TERMINALS] + 1) * h[CAPACITY] :][:n]
        _write_wants(s, terminal, away, wants)
        count = _least(s, wants, h[LINKS], s.near[terminal])
    s.radius[terminal] = 0.0
    for rank in range(count):
        s.radius[terminal] = max(s.radius[terminal], away[s.near[terminal, rank]])
    for rank in range(count, h[LINKS]):
        s.near[terminal, rank] = -1


@quick
def _milestone_at(s: Search, terminal: int, away: Singles) -> int:
    """Return the first free milestone that equals a terminal, or -1."""
    some = False
    for i in range(len(away)):
        some |= away[i] == np.float32(0.0)
    if some:
        for i in range(len(away)):
            if away[i] == 0.0 and s.nodes[i] >= FREE and is_at(s, terminal, i):
                return i
    return -1


@quick
def _write_wants(s: Search, terminal: int, away: Singles, wants: Singles) -> None:
    """Write the order of milestones as keys, lowest first; inf for blocked ones."""
    h, n, links = s.header, len(away), s.links[terminal]
    beyond = s.away[h[CAPACITY] : h[CAPACITY] + n] if terminal == 0 else s.away[:n]
    for i in range(n):
        wants[i] = beyond[i]
    if terminal == 0:
        for other in range(2, h[TERMINALS]):
            beyond = s.away[other * h[CAPACITY] : other * h[CAPACITY] + n]
            for i in range(n):
                wants[i] = beyond[i] if beyond[i] < wants[i] else wants[i]
    for i in range(n):
        want = away[i] + np.float32(ONWARD) * wants[i]
        blocked = (s.nodes[i] == BLOCKED) | (links[i] == BLOCKED)
        wants[i] = np.float32(np.inf) if blocked else want


@quick
def _least(s: Search, wants: Singles, most: int, into: Ints) -> int:
    """Write the milestones with the lowest keys, in order, ties to the first; return their number."""
    limit, count = _limit(wants, most), 0
    for i in range(len(wants)):
        if wants[i] <= limit:
            count = kept_in_order(s.keys, into, count, most, wants[i], i)
    return count


@quick
def _limit(wants: Singles, most: int) -> np.float32:
    """Return a limit that `count` keys, and few others, do not exceed; the largest key where few are finite."""
    low, high, found = np.float32(0.0), np.float32(0.0), 0
    for i in range(min(2 * most, len(wants))):
        if wants[i] < np.inf:
            high, found = max(high, wants[i]), found + 1
    if found < most:
        return np.float32(np.finfo(np.float32).max)
    for _ in range(HALVINGS):
        middle, found = np.float32(0.5) * (low + high), 0
        for i in range(len(wants)):
            found += wants[i] <= middle
        if found < most:
            low = middle
        else:
            high = middle
            if found < 2 * most:
                break
    return high
