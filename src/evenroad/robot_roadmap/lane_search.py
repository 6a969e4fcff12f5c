"""A query of a roadmap in one compiled program: a search that evaluates edges in sixteen lanes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import integers_at
from evenroad.robot.kernel.layout import LANES, program, quick
from evenroad.robot.kernel.motion import enter
from evenroad.robot.kernel.motion_checks import (
    COARSE,
    START,
    Checks,
    blocked,
    checks_of,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.motion_states import BATCHES as TESTED
from evenroad.robot_roadmap.memory import (
    BASE,
    BATCHES,
    BLOCKED,
    BY,
    CONFIGURATIONS,
    DIM,
    EDGE,
    FOUND,
    FREE,
    LINK,
    MOTIONS,
    NODE,
    PARENT,
    PAUSED,
    PENDING,
    PROVED,
    SPENT,
    STRAIGHT,
    TAKEN,
    TERMINALS,
    UNKNOWN,
    Search,
    search_at,
)
from evenroad.robot_roadmap.search import (
    begin,
    begin_again,
    check_of,
    record,
    result_of,
    step,
    write_motion,
    write_path,
)

Ints = npt.NDArray[np.int64]

TOLERANCE, MOST_BATCHES = 1e-6, 1024
"""Tolerance [m] and largest number of batches of the proof of a motion."""


@program
def find_path(
    header: int,
    fresh: int,
    most_motions: int,
    slice_batches: int,
    resolution: float,
    dynamic: int,
    full: int,
) -> int:
    """Search until there is a path all of whose motions are proved free, and return how the call ended.

    `header` is that of `search_at`; `fresh` is 1 for a new query, 0 to go on.  `full` and `dynamic` are addresses of
    the arguments of `checks_of`, without the resolution: of the whole world, and of what the roadmap did not check.
    """
    everything, moved = _checks_at(full, resolution), _checks_at(dynamic, resolution)
    s = search_at(header)
    h = s.header
    everything.counts[TESTED] = 0
    if fresh != 0:
        if not _terminals_free(s, everything):
            return TAKEN
        begin(s)
    while True:
        check = step(s)
        if check == FOUND:
            if _is_proved(s, moved, everything):
                h[BATCHES] += everything.counts[TESTED]
                write_path(s)
                return FOUND
            begin_again(s)
        elif check > STRAIGHT:
            return check
        elif h[MOTIONS] >= most_motions:
            return SPENT
        elif everything.counts[TESTED] >= slice_batches:
            return PAUSED
        else:
            _evaluate(s, check, moved, everything)


@quick
def _checks_at(table: int, resolution: float) -> Checks:
    """Return the checks of a world from a table of addresses."""
    at = integers_at(table, (5,))
    return checks_of(at[0], resolution, at[1], at[2], at[3], at[4])


@quick
def _terminals_free(s: Search, everything: Checks) -> bool:
    """Return whether start and goals are free; bring them into their ranges."""
    terminals, dim = s.header[TERMINALS], s.header[DIM]
    for first in range(0, terminals, LANES):
        for lane in range(LANES):
            # Unused lanes repeat the last row.
            q = s.terminals[min(first + lane, terminals - 1)]
            if not enter(q, everything.bounds, q):
                return False
            for k in range(dim):
                everything.states[k * LANES + lane] = q[k]
        if blocked(everything) != 0:
            return False
    return True


@quick
def _evaluate(s: Search, check: int, moved: Checks, everything: Checks) -> None:
    """Check a milestone or a motion at its states."""
    a, b = s.motion[0], s.motion[1]
    if check == NODE:
        for k in range(len(a)):
            for lane in range(LANES):
                moved.states[k * LANES + lane] = a[k]
        s.header[CONFIGURATIONS] += 1
        free = blocked(moved) == 0
    else:
        s.header[MOTIONS] += 1
        # Sixteen states of motions between free configurations are enough before the proof.
        known = START if check == LINK and s.nodes[s.header[BY]] == UNKNOWN else COARSE
        free = motion_free(a, b, known, moved if _is_old(s, check) else everything)
    record(s, check, FREE if free else BLOCKED)


@quick
def _is_old(s: Search, check: int) -> bool:
    """Return whether a motion is known to be free of robot and static scene."""
    return check == EDGE and s.header[BY] < s.header[BASE]


@quick
def _is_proved(s: Search, moved: Checks, everything: Checks) -> bool:
    """Return whether the path is proved; a motion that is not becomes blocked."""
    entry = s.header[PENDING]
    while entry >= 0:
        check = check_of(s, entry)
        if result_of(s, check) != PROVED:
            write_motion(s, entry, check)
            whole = moved if _is_old(s, check) else everything
            proved = motion_proved(s.motion[0], s.motion[1], TOLERANCE, MOST_BATCHES, whole)
            record(s, check, PROVED if proved else BLOCKED)
            if not proved:
                return False
        entry = s.entries[entry, PARENT]
    return True
