"""Smoothing of paths in compiled code: waypoints slide along what they touch, and the result is proved free.

Straight shortcuts leave a waypoint where it first touched something.  Here it moves on to the sides of its contact, and
every motion is judged at its states alone, with bodies a little larger: only those of the last path are proved.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad.robot.kernel.addresses import doubles_at, matrix_at
from evenroad.robot.kernel.lane_world import LaneWorld
from evenroad.robot.kernel.layout import LANES, MEMORY, Given, Pair, Triple, program, quick, quick_inlined
from evenroad.robot.kernel.motion import canonical, distance_and_direction, enter
from evenroad.robot.kernel.motion_checks import (
    BOTH_ENDPOINTS,
    Checks,
    blocked,
    checks_of,
    look_at,
    motion_free,
)
from evenroad.robot.kernel.motion_states import BATCHES, CONFIGURATIONS, COUNTS, MOTIONS
from evenroad.robot.kernel.path_proof import MOST_BENT, is_proved, proved_or_bent
from evenroad.robot.kernel.shorten import (
    MOST_SHORTCUTS,
    NO_LIMIT,
    Buffer,
    measure,
    move,
    move_to,
    pair_joined,
    pass_by,
    shortcut_corners,
)

Floats = npt.NDArray[np.float64]

CLEARANCE, LITTLE = 1e-3, 1e-4
"""So far from obstacles the states of what is put in are [m]: of motions free there nearly all are proved.  The second
where an end is nearer, and the motion that leads away from it."""

SLIDES, PAIRS, LEAST_GAIN, IN_A_ROW = 12, 2, 2e-3, 4
"""After so many slides so many shortcuts are tried, again and again until the path becomes shorter by less than this
share, so many times in a row."""

PASSED_BY = 3
"""After every third of these rounds it is tried to pass by waypoints."""

MOST_ROUNDS, SPARE_PAIRS = 64, 20
"""So many rounds at most; so many shortcuts where what was drawn tight is not proved."""

CANDIDATES, STATES = 5, 3
"""So many places are tried at once for a waypoint, each with a state to both of its sides: fifteen of sixteen lanes."""

TRIED = 2
"""So many of the places that are free are looked at closely, the one with the shortest way first."""

BESIDE = 0.4
"""Those states are so far towards the neighbours, as a share of the way."""

SIZES = (0.2, 0.24, 0.3, 0.36, 0.44, 0.54, 0.66, 0.8)
"""Places are so far away, as shares of the shorter motion to a neighbour, one after the other."""

AHEAD = 0.2
"""To a direction at random, of length 1, so much of the direction is added in which the path gets shorter soonest."""

SLIDE_WORTH_WHILE = 1e-3
"""The way from neighbour to neighbour becomes shorter by this share or more."""

OF_PROOF = 6
"""The proof of a motion takes about so many batches, which slides leave to it."""

BEND = 0.01
"""A waypoint does not slide where the way by it is longer than the straight one by less than this share."""

_HALF = LANES // 2
_BESIDE = 1 << 32
"""Two counts in one number: less to read after a call."""


class Slides(NamedTuple):
    """What waypoints slide by: directions, used in turn; places tried for one, and how long the way by each is.

    Behind the places there is room for the direction in which the path gets shorter soonest.
    """

    directions: Floats
    tried: Floats
    lengths: Floats


def smooth_path(
    world: LaneWorld,
    path: Floats,
    pairs: tuple[int, int],
    sphere: tuple[int, int],
    most_batches: int,
    proved: bool,
) -> tuple[Floats, int]:
    """Return a path drawn tight, without waypoints where it is not finite, and how many motions were looked at.

    `pairs` and `sphere` are addresses and lengths of what `share_pairs` and `sphere_points` return.  After so many
    batches of sixteen checks, `OF_PROOF` a motion less, no waypoint slides any more; cuts and proofs follow.  Where the
    path is not `proved` as it was given, there are no waypoints if nothing shorter is proved either.
    """
    size, dim = path.shape
    # A slide adds no waypoint; a shortcut, a cut or a bend one, the ends two.
    rows = size + MOST_ROUNDS * PAIRS + MOST_SHORTCUTS + MOST_BENT + 8
    memory, given = world.arguments(COUNTS + rows * (dim + 1) + (CANDIDATES + 5 + size) * dim + CANDIDATES)
    points = memory[-rows * dim :].reshape(rows, dim)
    memory[:COUNTS], points[:size] = 0.0, path
    wider = world.wider(CLEARANCE), world.wider(LITTLE)
    found = smooth_points((rows, size, dim), pairs, sphere, most_batches, int(proved), wider, given)
    motions, left = divmod(found, _BESIDE)
    return points[:left].copy(), motions


@program
def smooth_points(
    shape: Triple, shares: Pair, sphere: Pair, most_batches: int, proved: int, wider: Pair, given: Given
) -> int:
    """Do the work of `smooth_path` on the last rows of the memory; return how many are left, and 2^32 a motion.

    0 are left where the path is not finite.  Where what was drawn tight is not proved, the path is shortened as it was
    given, each motion proved before it is put in; 0 are left where `proved` is 0 and that is not proved either.
    """
    checks = checks_of(*given)
    rows, size, dim = shape
    own = given[MEMORY] + 8 * COUNTS
    last = own + 24 * dim
    lengths = last + 8 * (CANDIDATES + 2) * dim
    kept_at = lengths + 8 * (CANDIDATES + rows)
    begin = kept_at + 8 * size * dim
    goal, kept = doubles_at(last + 8 * (CANDIDATES + 1) * dim, (dim,)), matrix_at(kept_at, (size, dim))
    pairs, slides = (
        matrix_at(shares[0], (shares[1], 2)),
        Slides(
            matrix_at(sphere[0], (sphere[1], dim)),
            matrix_at(last, (CANDIDATES + 1, dim)),
            doubles_at(lengths, (CANDIDATES,)),
        ),
    )
    positions, endpoints, difference = (
        doubles_at(lengths + 8 * CANDIDATES, (rows,)),
        matrix_at(own, (2, dim)),
        doubles_at(own + 16 * dim, (dim,)),
    )
    whole = Buffer(matrix_at(begin, (rows, dim)), positions, endpoints, difference)
    points = whole.points
    for i in range(size):
        for k in range(dim):
            if not np.isfinite(points[i, k]):
                return 0
        enter(points[i], checks.bounds, points[i])
        move_to(points[i], kept[i])
    if size < 3:
        return size
    margin, plain = wider[0], look_at(wider[0], checks)
    size, first, after = _left_behind(points, size, goal, difference, checks)
    if size == 0:
        margin, size = wider[1], shape[1]
        for i in range(size):
            move_to(kept[i], points[i])
        look_at(margin, checks)
        size, first, after = _left_behind(points, size, goal, difference, checks)
    if size > 0:
        buffer = Buffer(
            matrix_at(begin + 8 * dim * first, (rows - first, dim)), positions, endpoints, difference
        )
        size = first + _smoothed(buffer, size - first, pairs, slides, most_batches, checks)
        if after:
            move_to(goal, points[size])
            size += 1
    look_at(plain, checks)
    if size > 0:
        size = proved_or_bent(points, size, margin, slides.directions, slides.tried[0], difference, checks)
    if size == 0:
        size = _shortened(whole, kept, pairs, most_batches, proved != 0, checks)
    return size + _BESIDE * checks.counts[MOTIONS]


@quick
def _smoothed(
    buffer: Buffer, size: int, pairs: Floats, slides: Slides, most_batches: int, checks: Checks
) -> int:
    """Let waypoints slide, and join places of the path, while that gains anything; return its new size."""
    points, positions = buffer.points, buffer.positions
    size = pass_by(points, size, False, checks)
    measure(buffer, size, checks)
    little = pair = turn = 0
    while turn < MOST_ROUNDS and size > 2 and little < IN_A_ROW and _is_work_left(size, most_batches, checks):
        length = positions[size - 1]
        for number in range(SLIDES * turn, SLIDES * (turn + 1)):
            if _is_work_left(size, most_batches, checks):
                _slide(points, 1 + number % (size - 2), number, slides, buffer.direction, checks)
        measure(buffer, size, checks)
        for _ in range(PAIRS):
            size = pair_joined(buffer, size, pairs[pair], False, checks)
            pair = (pair + 1) % len(pairs)
        if turn % PASSED_BY == PASSED_BY - 1:
            size = pass_by(points, size, False, checks)
            measure(buffer, size, checks)
        little = little + 1 if positions[size - 1] > length * (1.0 - LEAST_GAIN) else 0
        turn += 1
    return shortcut_corners(buffer, size, MOST_SHORTCUTS, NO_LIMIT, False, checks)


@quick
def _shortened(
    buffer: Buffer, kept: Floats, pairs: Floats, most_batches: int, proved: bool, checks: Checks
) -> int:
    """Write the path as it was given, shortened by straight motions alone; 0 where it is not proved in the end."""
    size = len(kept)
    if not (proved or (is_proved(kept[:2], 2, checks) and is_proved(kept[size - 2 :], 2, checks))):
        return 0
    most = checks.counts[BATCHES] + most_batches
    for i in range(size):
        move_to(kept[i], buffer.points[i])
    size = pass_by(buffer.points, size, True, checks)
    measure(buffer, size, checks)
    for row in range(SPARE_PAIRS):
        size = pair_joined(buffer, size, pairs[row], True, checks)
    size = shortcut_corners(buffer, size, MOST_SHORTCUTS, most, True, checks)
    return size if proved or is_proved(buffer.points, size, checks) else 0


@quick_inlined
def _is_work_left(size: int, most_batches: int, checks: Checks) -> bool:
    """Return whether waypoints may slide on, and the proof has what it takes."""
    return checks.counts[BATCHES] + OF_PROOF * (size - 1) < most_batches


@quick
def _left_behind(
    points: Floats, size: int, goal: Floats, difference: Floats, checks: Checks
) -> tuple[int, int, bool]:
    """Leave ends that nearly touch something as they are, and what leads away from them.

    Return the path's size, 0 where nothing leads away; 1 where its first motion is to stay, else 0; and whether its
    goal was taken off, and is to come again.
    """
    dim = points.shape[1]
    for side in range(2):
        a, b = (points[0], points[1]) if side == 0 else (points[size - 1], points[size - 2])
        distance_and_direction(a, b, checks.bounds, difference)
        for lane in range(_HALF):
            for k in range(dim):
                checks.states[k * LANES + _HALF * side + lane] = a[k] + lane / _HALF * difference[k]
    touching = blocked(checks)
    first, after = 0, False
    for side in range(2):
        near = touching >> (_HALF * side)
        if near & 1 == 0:
            continue
        lane = 1
        while lane < _HALF and (near >> lane) & 1:
            lane += 1
        if lane == _HALF:
            return 0, 0, False
        if side == 0:
            for row in range(size - 1, 0, -1):
                move(points, row, row + 1)
            size, first, row = size + 1, 1, 1
        else:
            move_to(points[size - 1], goal)
            after, row = True, size - 1
        for k in range(dim):
            points[row, k] = checks.states[k * LANES + _HALF * side + lane]
        canonical(points[row], checks.bounds)
    return size, first, after


@quick
def _slide(points: Floats, i: int, number: int, slides: Slides, difference: Floats, checks: Checks) -> None:
    """Move a waypoint to the best of some places around it by which the way is shorter, and free at its states."""
    dim = points.shape[1]
    directions, tried, lengths = slides.directions, slides.tried, slides.lengths
    a, here, b, ahead = points[i - 1], points[i], points[i + 1], tried[CANDIDATES]
    before, after = _write_ahead(a, here, b, ahead, difference, checks)
    if distance_and_direction(a, b, checks.bounds, difference) > (before + after) * (1.0 - BEND):
        return
    least, inside = (before + after) * (1.0 - SLIDE_WORTH_WHILE), 0
    for index in range(CANDIDATES):
        there, turn = tried[index], CANDIDATES * number + index
        direction, reach = directions[turn % len(directions)], SIZES[turn % len(SIZES)] * min(before, after)
        along = 0.0
        for k in range(dim):
            along += direction[k] * ahead[k]
        # Rather away from the contact than back.
        side = -1.0 if along < 0.0 else 1.0
        reach /= np.sqrt(1.0 + 2.0 * AHEAD * side * along + AHEAD * AHEAD)
        for k in range(dim):
            there[k] = here[k] + reach * (side * direction[k] + AHEAD * ahead[k])
        within = enter(there, checks.bounds, there)
        canonical(there, checks.bounds)
        lengths[index] = distance_and_direction(a, there, checks.bounds, difference)
        _write_states(a, there, difference, STATES * index, checks)
        lengths[index] += distance_and_direction(b, there, checks.bounds, difference)
        for k in range(dim):
            checks.states[k * LANES + STATES * index + 2] = there[k] - BESIDE * difference[k]
        inside |= int(within and lengths[index] <= least) << index
    if inside == 0:
        return
    touching = blocked(checks)
    checks.counts[CONFIGURATIONS] += LANES
    # Sixteen states, as of a motion.
    checks.counts[MOTIONS] += 1
    for _ in range(TRIED):
        best = -1
        for index in range(CANDIDATES):
            seen = (touching >> (STATES * index)) & ((1 << STATES) - 1)
            if (inside >> index) & 1 and seen == 0 and (best < 0 or lengths[index] < lengths[best]):
                best = index
        if best < 0:
            return
        inside &= ~(1 << best)
        there = tried[best]
        if motion_free(a, there, BOTH_ENDPOINTS, checks) and motion_free(there, b, BOTH_ENDPOINTS, checks):
            move_to(there, here)
            return


@quick
def _write_states(a: Floats, there: Floats, difference: Floats, lane: int, checks: Checks) -> None:
    """Write a place, and a state towards the neighbour that a way comes from; lanes to spare repeat the place."""
    for k in range(len(a)):
        checks.states[k * LANES + lane] = checks.states[k * LANES + LANES - 1] = there[k]
        checks.states[k * LANES + lane + 1] = there[k] - BESIDE * difference[k]


@quick
def _write_ahead(
    a: Floats, here: Floats, b: Floats, ahead: Floats, difference: Floats, checks: Checks
) -> tuple[float, float]:
    """Write the direction in which a waypoint shortens the path soonest; return how far its neighbours are."""
    before = max(distance_and_direction(here, a, checks.bounds, difference), 1e-9)
    for k in range(len(here)):
        ahead[k] = difference[k] / before
    after, squared = max(distance_and_direction(here, b, checks.bounds, difference), 1e-9), 1e-18
    for k in range(len(here)):
        ahead[k] += difference[k] / after
        squared += ahead[k] * ahead[k]
    for k in range(len(here)):
        ahead[k] /= np.sqrt(squared)
    return before, after
