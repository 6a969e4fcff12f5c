"""Which milestones the ends of a query are tried to be linked to, in compiled code."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.layout import quick
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    CAPACITY,
    ENDS,
    FREE,
    LINKS,
    NODES,
    PROVED,
    Search,
    kept_in_order,
)
from evenroad.robot_roadmap.search_metric import is_at

Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]

ONWARD = 0.5
"""Links are tried in the order of their length and this share of what is left beyond them."""

HALVINGS = 12
"""So often at most an interval is halved, until no more than twice the wanted ones are below: they are sorted."""


@quick
def choose_links(s: Search, end: int) -> None:
    """Choose milestones that are near, or on the way to the other ends; an end that is one needs no other."""
    d, n = s.desk, s.desk[NODES]
    away = s.away[end * d[CAPACITY] : end * d[CAPACITY] + n]
    same = _milestone_at(s, end, away)
    if same >= 0:
        count, s.near[end, 0], s.links[end, same] = 1, same, PROVED
    else:
        wants = s.away[(d[ENDS] + 1) * d[CAPACITY] :][:n]
        _write_wants(s, end, away, wants)
        count = _least(s, wants, d[LINKS], s.near[end])
    s.radius[end] = 0.0
    for rank in range(count):
        s.radius[end] = max(s.radius[end], away[s.near[end, rank]])
    for rank in range(count, d[LINKS]):
        s.near[end, rank] = -1


@quick
def _milestone_at(s: Search, end: int, away: Singles) -> int:
    """Return the first free milestone that an end is, or -1."""
    some = False
    for i in range(len(away)):
        some |= away[i] == np.float32(0.0)
    if some:
        for i in range(len(away)):
            if away[i] == 0.0 and s.nodes[i] == FREE and is_at(s, end, i):
                return i
    return -1


@quick
def _write_wants(s: Search, end: int, away: Singles, wants: Singles) -> None:
    """Write keys, the less the sooner; inf for what is blocked."""
    d, n, links = s.desk, len(away), s.links[end]
    beyond = s.away[d[CAPACITY] : d[CAPACITY] + n] if end == 0 else s.away[:n]
    for i in range(n):
        wants[i] = beyond[i]
    if end == 0:
        for other in range(2, d[ENDS]):
            beyond = s.away[other * d[CAPACITY] : other * d[CAPACITY] + n]
            for i in range(n):
                wants[i] = beyond[i] if beyond[i] < wants[i] else wants[i]
    for i in range(n):
        want = away[i] + np.float32(ONWARD) * wants[i]
        blocked = (s.nodes[i] == BLOCKED) | (links[i] == BLOCKED)
        wants[i] = np.float32(np.inf) if blocked else want


@quick
def _least(s: Search, wants: Singles, most: int, into: Ints) -> int:
    """Write the milestones that are wanted most, in order, of equal ones the first; return how many."""
    limit, count = _limit(wants, most), 0
    for i in range(len(wants)):
        if wants[i] <= limit:
            count = kept_in_order(s.keys, into, count, most, wants[i], i)
    return count


@quick
def _limit(wants: Singles, most: int) -> np.float32:
    """Return a number that so many wants, and few others, are not greater than; the largest where few are finite."""
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
