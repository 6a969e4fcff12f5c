"""Compiled checks of a planar chain, for configurations and for the states of motions."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from evenroad.space.chain import chain_distance
from evenroad.world.bisection_kernel import next_between

FREE, SELF, WALL = 0, 1, 2
"""Verdicts: nothing is crossed; two links cross; a link crosses a wall."""

_TOUCHING = float(np.finfo(np.float32).eps)
"""How far, as a cross product, an end must be beyond the other segment for the two to cross: chain only touch."""


@njit(cache=True, nogil=True)
def verdicts(
    q: npt.NDArray[np.float64], walls: npt.NDArray[np.float64], end_piece: float
) -> npt.NDArray[np.int64]:
    """Return the verdict on each configuration, (n, links)."""
    found = np.empty(len(q), dtype=np.int64)
    chain = np.empty((4, q.shape[1] + 1))
    for row in range(len(q)):
        found[row] = _verdict(q[row], walls, end_piece, chain)
    return found


@njit(cache=True, nogil=True)
def motions_are_free(
    a: npt.NDArray[np.float64],
    b: npt.NDArray[np.float64],
    resolution: float,
    walls: npt.NDArray[np.float64],
    end_piece: float,
) -> npt.NDArray[np.bool_]:
    """Return which motions are free at both ends and at states between them, in bisection order.

    Both (m, links), angles in [-pi, pi).  The number of segments is the distance of the ends over `resolution`,
    rounded up; every joint turns the short way.
    """
    free = np.empty(len(a), dtype=np.bool_)
    links = a.shape[1]
    chain, state, difference = np.empty((4, links + 1)), np.empty(links), np.empty(links)
    for row in range(len(a)):
        first, second = a[row], b[row]
        if _comes_after(first, second):
            # States are rounded: in one fixed order a motion and its reverse have the same.
            first, second = second, first
        for k in range(links):
            turn = second[k] - first[k]
            # rint takes one half to zero: of two opposite ways the one that does not cross -pi is taken.
            difference[k] = turn - 2.0 * math.pi * np.rint(turn / (2.0 * math.pi))
        free[row] = (
            _verdict(first, walls, end_piece, chain) == FREE
            and _verdict(second, walls, end_piece, chain) == FREE
            and _way_is_free(
                first,
                difference,
                math.ceil(chain_distance(first, second) / resolution),
                walls,
                end_piece,
                chain,
                state,
            )
        )
    return free


@njit(cache=True, nogil=True)
def _way_is_free(start, difference, segments, walls, end_piece, chain, state):  # type: ignore[no-untyped-def]
    level, multiple, number = next_between(1, -1, segments)
    while number > 0:
        for k in range(len(start)):
            state[k] = start[k] + number / segments * difference[k]
        if _verdict(state, walls, end_piece, chain) != FREE:
            return False
        level, multiple, number = next_between(level, multiple, segments)
    return True


@njit(cache=True, nogil=True)
def _comes_after(a, b):  # type: ignore[no-untyped-def]
    """Return whether a comes after b in dictionary order."""
    for k in range(len(a)):
        if a[k] != b[k]:
            return a[k] > b[k]
    return False


@njit(cache=True, nogil=True)
def _verdict(q, walls, end_piece, chain):  # type: ignore[no-untyped-def]
    links = len(q)
    heading, x, y = 0.0, 0.0, 0.0
    for k in range(links + 1):
        if k < links:
            heading += q[k]
            along_x, along_y = math.cos(heading) / links, math.sin(heading) / links
        else:
            along_x, along_y = along_x * links * end_piece, along_y * links * end_piece
        chain[0, k], chain[1, k], chain[2, k], chain[3, k] = x, y, along_x, along_y
        # The link before has a joint in common with this one, and no more.
        if _crosses_any(x, y, along_x, along_y, chain, k - 1):
            return SELF
        if _crosses_any(x, y, along_x, along_y, walls, walls.shape[1]):
            return WALL
        x, y = x + along_x, y + along_y
    return FREE


@njit(cache=True, nogil=True)
def _crosses_any(x, y, along_x, along_y, others, count):  # type: ignore[no-untyped-def]
    """Return whether the segment from (x, y) by `along` crosses one of the first `count` others inside of both."""
    crossings = 0
    # Without branches, so that compilers can take several segments at a time.
    for j in range(count):
        apart_x, apart_y = others[0, j] - x, others[1, j] - y
        other_x, other_y = others[2, j], others[3, j]
        cross = along_x * other_y - other_x * along_y
        # The lines meet at the shares s / cross and t / cross of the two; a positive cross product is compared.
        size = abs(cross)
        s = math.copysign(1.0, cross) * (apart_x * other_y - apart_y * other_x)
        t = math.copysign(1.0, cross) * (apart_x * along_y - apart_y * along_x)
        # Never so where the two are parallel, for then the size is about zero.
        crossings += (s >= _TOUCHING) & (s < size - _TOUCHING) & (t >= _TOUCHING) & (t < size - _TOUCHING)
    return crossings > 0
