"""Postures and whole turns: configurations that differ by turns of joints are one posture."""

from __future__ import annotations

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._time_limit import look_at_clock
from evenroad.poses.chain import TURN, Chain

MOST = 64
"""Largest number of configurations of one goal, the nearest of all with their whole turns."""

_MOST_TURNING = 8
"""Largest number of joints that are tried in other turns, too."""
_AT_ONCE = 64
"""Number of postures of which each is compared with all others at once."""


def wrapped(chain: Chain, q: Floats) -> Floats:
    """Return postures in the turn nearest to the middle of the limits, moved to a limit by at most 1e-9."""
    middle = 0.5 * chain.bounds.sum(axis=0)
    q = np.where(chain.turns, q - TURN * np.round((q - middle) / TURN), q)
    nearest = np.clip(q, *chain.bounds)
    return np.where(np.abs(q - nearest) <= 1e-9, nearest, q)


def distinct(chain: Chain, q: Floats, same: float) -> Floats:
    """Return postures of which no two are nearer than `same`, modulo turns; the first of each stays."""
    if len(q) < 2:
        return q
    kept = q[:0]
    for begin in range(0, len(q), _AT_ONCE):
        look_at_clock()
        some = q[begin : begin + _AT_ONCE]
        some = some[~_near(chain, some, kept, same).any(axis=1)]
        near = _near(chain, some, some, same)
        new: list[int] = []
        for row in range(len(some)):
            if not near[row, new].any():
                new.append(row)
        kept = np.concatenate([kept, some[new]])
    return kept


def _near(chain: Chain, a: Floats, b: Floats, same: float) -> Bools:
    """Return which postures of two sets, (n, dim) and (m, dim), are nearer than `same`: (n, m)."""
    gap = np.abs(a[:, np.newaxis] - b)
    gap = np.where(chain.turns, np.minimum(gap, np.abs(TURN - gap)), gap)
    return np.asarray(gap.max(axis=2, initial=0.0) < same)


def with_turns(chain: Chain, q: Floats, start: Floats, of: Ints) -> tuple[Floats, Ints]:
    """Return postures in all turns that are within limits, and of which goal they are; `of`, (n,), rises.

    Each goal has at most `MOST`, the nearest to the start first, and at least the nearest one of each posture.
    """
    low, high = chain.bounds
    wide = chain.turns & (high - low >= TURN)
    nearest = np.where(wide, q - TURN * np.round((q - start) / TURN), q)
    # If the nearest turn is beyond a limit by more than rounding, one turn back is not.
    for _ in range(2):
        nearest -= np.where(wide, TURN * (nearest > high + 1e-9), 0.0)
        nearest += np.where(wide, TURN * (nearest < low - 1e-9), 0.0)
    other = nearest + np.where(nearest > start, -TURN, TURN)
    other = np.where(wide & (other >= low - 1e-9) & (other <= high + 1e-9), other, nearest)
    two = np.flatnonzero((other != nearest).any(axis=0))[:_MOST_TURNING]
    takes = np.zeros((2 ** len(two), len(start)), dtype=np.bool_)
    takes[:, two] = np.arange(len(takes))[:, np.newaxis] >> np.arange(len(two)) & 1
    every = np.where(takes, other[:, np.newaxis], nearest[:, np.newaxis])
    # The same once more is the other choice of a joint that has none.
    doubled = (takes & (other == nearest)[:, np.newaxis]).any(axis=2)
    far = (np.linalg.norm(every - start, axis=2) + np.where(doubled, np.inf, 0.0)).ravel()
    goal = np.repeat(of, len(takes))
    order = np.lexsort((far, goal))
    rank = np.arange(len(order)) - np.searchsorted(goal[order], goal[order])
    kept = np.zeros(len(far), dtype=np.bool_)
    kept[order] = (rank < MOST) & np.isfinite(far[order])
    kept[np.arange(len(q)) * len(takes)] = True
    rows = order[kept[order]]
    return np.clip(every.reshape(-1, len(start))[rows], low, high), goal[rows]
