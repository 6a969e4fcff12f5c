"""A query of a roadmap in one compiled program: the search asks, and the lanes answer, sixteen states at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import integers_at, matrix_at
from evenroad.robot.kernel.layout import LANES, program, quick
from evenroad.robot.kernel.motion import enter
from evenroad.robot.kernel.motion_checks import (
    COARSE,
    START,
    Checks,
    blocked,
    checks_of,
    look_at,
    motion_free,
    motion_proved,
)
from evenroad.robot.kernel.motion_states import BATCHES
from evenroad.robot_roadmap.lazy_search import (
    ENDS_TAKEN,
    PAUSED,
    SPENT,
    answer,
    begin,
    question_of,
    step,
    verdict_of,
    way_back,
    write_asked,
)
from evenroad.robot_roadmap.search_memory import (
    BASE,
    BLOCKED,
    BY,
    CHECKS,
    DIM,
    EDGE,
    ENDS,
    FOUND,
    FREE,
    GOAL,
    LINK,
    MILESTONES,
    MOTIONS,
    NODE,
    PARENT,
    PENDING,
    PROVED,
    REPORT,
    ROWS,
    STATE,
    STRAIGHT,
    UNKNOWN,
    Search,
    search_at,
)

Ints = npt.NDArray[np.int64]

FIRST, LAST, ALL = 1, 2, 4
"""Which motions of a way are proved: the link of its start, that of its goal, all."""

TOLERANCE, MOST_BATCHES = 1e-6, 1024
"""Limits of the proof of a motion [m]."""


@program
def find_way(
    desk: int,
    path: int,
    rows: int,
    report: int,
    fresh: int,
    most_motions: int,
    slice_batches: int,
    wider: int,
    day_checks: int,
    day_tables: int,
    day_by_joint: int,
    day_memory: int,
    checks: int,
    resolution: float,
    tables: int,
    by_joint: int,
    memory: int,
    room: int,
) -> int:
    """Search until there is a way that is free, and return how the call ended.

    `desk` is that of `search_at`; `path`, (rows, dim), takes the way from the goal back to the start, `report` what was
    counted.  `fresh` is 1 for a new query, 0 to go on.  Every motion of the way is proved; where `wider`, an address of
    `LaneWorld.wider`, is not 0, only one straight to a goal, and links of ends at which such bodies touch something.
    The four that follow are of the day's obstacles alone.
    """
    full = checks_of(checks, resolution, tables, by_joint, memory, room)
    day = checks_of(day_checks, resolution, day_tables, day_by_joint, day_memory, room)
    s, counted = search_at(desk), integers_at(report, (REPORT,))
    full.counts[BATCHES] = 0
    if fresh != 0:
        for row in range(REPORT):
            counted[row] = 0
        if not _ends_free(s, full):
            return ENDS_TAKEN
        begin(s)
    while True:
        question = step(s)
        if question == FOUND:
            if _is_proved(s, _to_be_proved(s, wider, full), day, full):
                counted[GOAL] = -s.entries[s.desk[PENDING], STATE] - 1
                counted[CHECKS] += full.counts[BATCHES]
                counted[ROWS] = way_back(s, matrix_at(path, (rows, s.desk[DIM])))
                return FOUND
            begin(s)
        elif question > STRAIGHT:
            return question
        elif counted[MOTIONS] >= most_motions:
            return SPENT
        elif full.counts[BATCHES] >= slice_batches:
            return PAUSED
        else:
            _settle(s, question, day, full, counted)


@quick
def _ends_free(s: Search, full: Checks) -> bool:
    """Return whether start and goals are free; bring them into their ranges."""
    ends, dim = s.desk[ENDS], s.desk[DIM]
    for first in range(0, ends, LANES):
        for lane in range(LANES):
            # Lanes to spare repeat the last row.
            q = s.ends[min(first + lane, ends - 1)]
            if not enter(q, full.bounds, q):
                return False
            for k in range(dim):
                full.states[k * LANES + lane] = q[k]
        if blocked(full) != 0:
            return False
    return True


@quick
def _settle(s: Search, question: int, day: Checks, full: Checks, counted: Ints) -> None:
    """Answer a question."""
    a, b = s.asked[0], s.asked[1]
    if question == NODE:
        for k in range(len(a)):
            for lane in range(LANES):
                day.states[k * LANES + lane] = a[k]
        counted[MILESTONES] += 1
        free = blocked(day) == 0
    else:
        counted[MOTIONS] += 1
        # Of motions between free ends sixteen states do before the proof.
        known = START if question == LINK and s.nodes[s.desk[BY]] == UNKNOWN else COARSE
        free = motion_free(a, b, known, day if _is_old(s, question) else full)
    answer(s, question, FREE if free else BLOCKED)


@quick
def _is_old(s: Search, question: int) -> bool:
    """Return whether a motion is known to be free of robot and cell."""
    return question == EDGE and s.desk[BY] < s.desk[BASE]


@quick
def _to_be_proved(s: Search, wider: int, full: Checks) -> int:
    """Return which motions of the way that was found are to be proved now."""
    goal = s.desk[PENDING]
    if wider == 0 or s.entries[goal, PARENT] < 0:
        return ALL
    for k in range(s.desk[DIM]):
        for lane in range(LANES):
            end = 0 if lane < LANES // 2 else -s.entries[goal, STATE]
            full.states[k * LANES + lane] = s.ends[end, k]
    before = look_at(wider, full)
    touching = blocked(full)
    look_at(before, full)
    return (touching & 1) * FIRST + (touching >> (LANES - 1)) * LAST


@quick
def _is_proved(s: Search, which: int, day: Checks, full: Checks) -> bool:
    """Return whether these motions of the way that was found are proved; one that is not is blocked from now on."""
    entry = s.desk[PENDING]
    while entry >= 0:
        question = question_of(s, entry)
        asked = which == ALL
        if question == LINK:
            asked |= which & (LAST if s.entries[entry, STATE] < 0 else FIRST) != 0
        if asked and verdict_of(s, question) != PROVED:
            write_asked(s, entry, question)
            whole = day if _is_old(s, question) else full
            proved = motion_proved(s.asked[0], s.asked[1], TOLERANCE, MOST_BATCHES, whole)
            answer(s, question, PROVED if proved else BLOCKED)
            if not proved:
                return False
        entry = s.entries[entry, PARENT]
    return True
