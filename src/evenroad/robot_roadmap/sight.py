"""What an end sees: the configurations of a pool that a straight motion joins to it."""

from __future__ import annotations

import math

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.robot import ArmWorld
from evenroad.robot.kernel.addresses import ANY_LENGTH, address, doubles_at, integers_at, matrix_at
from evenroad.robot.kernel.layout import LANES, program, quick
from evenroad.robot.kernel.motion import wrapped
from evenroad.robot.kernel.motion_checks import BOTH_ENDS, Checks, blocked, checks_of, motion_free
from evenroad.robot.kernel.motion_states import COUNTS

EARLY = 0.1
"""How far along a motion it is looked at first: most that leave a pocket touch its walls at once."""

LOOKS = np.array([EARLY, 0.25, 0.05, 1.0, 0.4])
"""And where next, each time with the motions that are left; from the second on at the motion's nearest state."""

_NO_LOOKS = np.empty(0)


def joined_to(pocket: ArmWorld, inside: ArmWorld, pool: Floats, end: int, rows: Ints) -> Ints:
    """Return which of some rows of a pool, (n, dim), wrapped, a straight motion joins to the row `end`.

    The end is free of the pocket, all of the pool of what is `inside`, robot and cell.
    """
    rows = rows[rows != end]
    if pocket.backend != "lanes" or inside.backend != "lanes":
        here = np.broadcast_to(pool[end], (len(rows), pool.shape[1]))
        free = pocket.valid(pocket.space.interpolate(here, pool[rows], EARLY))
        for world in (pocket, inside):
            free[free] = world.motion_valid(here[free], pool[rows[free]])
        return rows[free]
    kept = len(rows)
    for world, looks in ((pocket, LOOKS), (inside, _NO_LOOKS)):
        _, arguments = world.lanes.arguments(COUNTS + 2 * LANES)
        kept = keep_joined(address(pool), end, address(rows), kept, address(looks), len(looks), *arguments)
    return rows[:kept]


@program
def keep_joined(
    pool: int,
    end: int,
    rows: int,
    count: int,
    looks: int,
    many: int,
    check: int,
    resolution: float,
    tables: int,
    by_joint: int,
    memory: int,
    room: int,
) -> int:
    """Keep the rows, the first ones, that a world does not part from an end; return how many."""
    checks = checks_of(check, resolution, tables, by_joint, memory, room)
    dim, given, shares = checks.bounds.shape[1], integers_at(rows, (count,)), doubles_at(looks, (many,))
    places, spare = matrix_at(pool, (ANY_LENGTH, dim)), matrix_at(room + 8 * COUNTS, (2, LANES))
    own = places[end]
    for look in range(many):
        kept = 0
        for first in range(0, count, LANES):
            some = min(LANES, count - first)
            for lane in range(LANES):
                # Lanes to spare repeat the last row.
                row = given[first + min(lane, some - 1)]
                for k in range(dim):
                    checks.states[k * LANES + lane] = places[row, k]
            if look == 0:
                _go_straight(own, shares[0], checks)
            elif shares[look] < 1.0:
                _go_to_states(own, shares[look], checks, spare)
            touching = blocked(checks)
            for lane in range(some):
                if (touching >> lane) & 1 == 0:
                    given[kept] = given[first + lane]
                    kept += 1
        count = kept
    kept = 0
    for i in range(count):
        if motion_free(own, places[given[i]], BOTH_ENDS, checks):
            given[kept] = given[i]
            kept += 1
    return kept


@quick
def _go_straight(own: Floats, share: float, checks: Checks) -> None:
    """Put what is so far from `own` to each lane's configuration in its place, as ``JointSpace.interpolate`` has it."""
    for k in range(len(own)):
        a, low, high, period = own[k], checks.bounds[0, k], checks.bounds[1, k], checks.bounds[2, k]
        states = checks.states[k * LANES : (k + 1) * LANES]
        if period == np.inf:
            begun = (1.0 - share) * a
            for lane in range(LANES):
                b = states[lane]
                states[lane] = min(max(begun + share * b, min(a, b)), max(a, b))
        else:
            for lane in range(LANES):
                way = states[lane] - a
                way -= period * np.rint(way / period)
                states[lane] = wrapped(a + share * way, low, high, period)


@quick
def _go_to_states(own: Floats, share: float, checks: Checks, spare: Floats) -> None:
    """Put the state nearest to such a share of the motion from `own`, and no end, in each lane's place."""
    sums, signs = spare[0], spare[1]
    for lane in range(LANES):
        sums[lane], signs[lane] = 0.0, 0.0
    for k in range(len(own)):
        a, period = own[k], checks.bounds[2, k]
        states = checks.states[k * LANES : (k + 1) * LANES]
        for lane in range(LANES):
            way = states[lane] - a
            if signs[lane] == 0.0:
                # Motions are judged from the end that comes first in dictionary order.
                signs[lane] = 1.0 if way > 0.0 else -1.0 if way < 0.0 else 0.0
            if period != np.inf:
                way -= period * np.rint(way / period)
            sums[lane] += way * way
    for lane in range(LANES):
        segments = math.ceil(math.sqrt(sums[lane]) / checks.resolution)
        number = min(max(round(share * segments), 1), segments - 1)
        sums[lane] = (number if signs[lane] > 0.0 else segments - number) / max(segments, 1)
    for k in range(len(own)):
        a, period = own[k], checks.bounds[2, k]
        states = checks.states[k * LANES : (k + 1) * LANES]
        for lane in range(LANES):
            b, way = states[lane], states[lane] - a
            if period != np.inf:
                way -= period * np.rint(way / period)
            states[lane] = a + sums[lane] * way if signs[lane] > 0.0 else b - sums[lane] * way
