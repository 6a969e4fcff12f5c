"""The proof: tasks that the checker makes, and the answers of the certificate to them."""

from __future__ import annotations

import numpy as np

from evenroad_verify.certificate import Certificate, Kept
from evenroad_verify.claim import LEAST, Claim
from evenroad_verify.errors import Answers, Bools, Floats, Ints, demand
from evenroad_verify.nodes import Nodes

HALVE_TIME, HALVE_FIRST, HALVE_SECOND, CENTRES, BOXES, CORNERS = range(6)
FINEST = 40
"""Number of times that a motion may be halved."""
MOTION, NUMBER, LEVEL, FIRST, SECOND, PAIR = range(6)
"""Columns of tasks: a stretch is the part `NUMBER` of the 2^LEVEL parts of a motion."""
NO_NODE = -1
"""Stands for the nodes of a task that is about a constraint."""
_AT_ONCE = 1 << 14


def prove(claim: Claim, certificate: Certificate) -> tuple[float, Ints]:
    """Return the least gap of all answers [m] and the answered tasks; Refused where a task is not proved."""
    pairs = np.array([(pair.first, pair.second) for pair in claim.pairs], np.int64).reshape(-1, 2)
    tasks, answers, left = expand(claim.nodes, _first(certificate, pairs), certificate.answers)
    none = np.full((len(certificate.kept), 2), NO_NODE)
    kept, how, left = expand(claim.nodes, _first(certificate, none), left)
    demand(not len(left), "there are answers without a task")
    demand((how == CENTRES).all(), "an answer to a constraint is a direction")
    motions = Motions(claim, certificate)
    least, directions = require_apart(claim, motions, tasks, answers, certificate.directions)
    demand(not len(directions), "there are directions left over")
    for number, each in enumerate(certificate.kept):
        excess = motions.excess(kept[kept[:, PAIR] == number], each)
        demand((excess <= LEAST).all(), f"{each.link} is not proved to keep its constraint")
    return least, tasks


def require_apart(
    claim: Claim, motions: Motions, tasks: Ints, answers: Ints, directions: Floats
) -> tuple[float, Floats]:
    """Return the least gap of tasks [m], and the directions left over; Refused where one does not separate."""
    given = np.cumsum(answers > CENTRES) - 1
    count, least = int((answers > CENTRES).sum()), np.inf
    demand(count <= len(directions), "a direction is missing")
    keep = np.array([pair.keep for pair in claim.pairs])
    some_direction = np.concatenate([directions[:count], np.zeros((1, 3))])  # of those without one any will do
    for start in range(0, len(tasks), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        gap = motions.gaps(tasks[some], answers[some], some_direction[given[some]]) - keep[tasks[some, PAIR]]
        worst = int(gap.argmin())
        if not gap[worst] > LEAST:  # nor if it is no number
            first, second = claim.pairs[tasks[start + worst, PAIR]].names
            demand(False, f"motion {tasks[start + worst, MOTION]}: {first} and {second} are not proved apart")
        least = min(least, float(gap[worst]))
    return least, directions[count:]


def _first(certificate: Certificate, pairs: Ints) -> Ints:
    """Return the first tasks: each pair for each motion, over the whole motion."""
    motion, pair = np.divmod(np.arange(len(certificate.curves) * len(pairs)), max(1, len(pairs)))
    return np.stack([motion, 0 * motion, 0 * motion, *pairs[pair].T, pair], axis=1)


def expand(nodes: Nodes, tasks: Ints, answers: Answers) -> tuple[Ints, Ints, Answers]:
    """Return the tasks that are answered by a direction, one row each, these answers, and the answers left over."""
    proved, how = [tasks[:0]], [tasks[:0, 0]]
    while len(tasks):
        demand(len(tasks) <= len(answers), "a task has no answer")
        answer, answers = answers[: len(tasks)].astype(np.int64), answers[len(tasks) :]
        proved.append(tasks[answer >= CENTRES])
        how.append(answer[answer >= CENTRES])
        tasks = _halved(nodes, tasks[answer < CENTRES], answer[answer < CENTRES])
    return np.concatenate(proved), np.concatenate(how), answers


def _halved(nodes: Nodes, tasks: Ints, answer: Ints) -> Ints:
    """Return the two halves of each task, one after the other."""
    side, by = np.tile([0, 1], len(tasks)), np.repeat(answer, 2)
    new = np.repeat(tasks, 2, axis=0)
    in_time = by == HALVE_TIME
    new[in_time, NUMBER] = 2 * new[in_time, NUMBER] + side[in_time]
    new[in_time, LEVEL] += 1
    demand(new[:, LEVEL].max(initial=0) <= FINEST, "a motion is halved too often")
    for which, column in ((HALVE_FIRST, FIRST), (HALVE_SECOND, SECOND)):
        rows = np.flatnonzero(by == which)
        node, where = np.unique(new[rows, column], return_inverse=True)
        demand(NO_NODE not in node, "a constraint has no node that could be halved")
        halves = np.array([nodes.halves(int(each)) for each in node], np.int64).reshape(-1, 2)
        new[rows, column] = halves[where, side[rows]]
    return new


class Motions:
    """How nodes move along the curves of a certificate."""

    def __init__(self, claim: Claim, certificate: Certificate) -> None:
        self._frames, self._nodes, self._curves = claim.frames, claim.nodes, certificate.curves
        self._far, _ = claim.frames.far(certificate.curves, certificate.tolerance)
        most = float(np.bincount(claim.frames.column).max())
        self._off = certificate.tolerance**2 * most * claim.frames.factor**2
        self._slides, self._carries = claim.frames.slides, claim.frames.carries

    def gaps(self, tasks: Ints, answers: Ints, given: Floats) -> Floats:
        """Return by how much the directions of tasks separate their nodes throughout their stretches [m]."""
        nodes, half = self._nodes, np.asarray(0.5 ** (tasks[:, LEVEL] + 1.0))
        key, at = np.unique(_middles(tasks), return_inverse=True)
        rate, bend, rotation, origin, turning, along = self._middle_states(key)
        rate, bend = rate[at], bend[at]
        tables = nodes.frame, nodes.centre, nodes.box, nodes.reach
        frame, centre, box, reach = (np.array(table)[tasks[:, FIRST : SECOND + 1]] for table in tables)
        turns, origins = rotation[at[:, None], frame], origin[at[:, None], frame]
        middles = origins + np.einsum("nsij,nsj->nsi", turns, centre)
        direction = np.where((answers == CENTRES)[:, None], middles[:, 1] - middles[:, 0], given)
        length = np.linalg.norm(direction, axis=1)
        demand((length > 1e-6).all(), "a direction has no length")
        direction = direction / length[:, None]
        ends, lost = np.zeros((2, 2, len(tasks)))
        by_corners = np.flatnonzero(answers == CORNERS)
        for s, sign in enumerate((1.0, -1.0)):
            moves = self._carries[frame[:, s]] & ~self._carries[frame[:, 1 - s]]
            lost += self._lost(half, moves, rate, bend, self._far[frame[:, s]] + reach[:, s, None])
            spin, shift = (np.einsum("nk,nkc->nc", moves, each[at]) for each in (turning, along))
            for e, time in enumerate((half, -half)):
                f = sign * (direction + time[:, None] * np.cross(direction, spin))
                local = np.einsum("nij,ni->nj", turns[:, s], f)
                far = np.einsum("nc,nc->n", local, centre[:, s])
                far += np.abs(np.einsum("nij,nj->ni", box[:, s], local)).sum(1)
                self._reach_by_corners(tasks[:, FIRST + s], by_corners, local, far)
                ends[e] += far + np.einsum("nc,nc->n", f, origins[:, s])
                ends[e] += sign * time * np.einsum("nc,nc->n", direction, shift)
        return np.asarray(-ends.max(0) - lost[0] - np.sqrt(lost[1]))

    def excess(self, tasks: Ints, kept: Kept) -> Floats:
        """Return by how much a constraint may be exceeded during the stretches of tasks [m, or of a unit vector]."""
        half = np.asarray(0.5 ** (tasks[:, LEVEL, None] + 1.0))
        rate, bend, rotation, origin, turning, along = self._middle_states(_middles(tasks))
        frame, (turn, shift) = self._frames.place[kept.link]
        moves = self._carries[frame]
        if kept.is_axis:
            moves, lever = moves & ~self._slides, np.ones(len(moves))
            at = rotation[:, frame] @ (turn @ kept.part)
            velocity = np.cross((moves[:, None] * turning).sum(1), at)
        else:
            point = turn @ kept.part + shift
            lever = self._far[frame] + np.linalg.norm(point)
            at = rotation[:, frame] @ point + origin[:, frame]
            velocity = np.cross((moves[:, None] * turning).sum(1), at) + (moves[:, None] * along).sum(1)
        # The distance is convex: along a straight way it is largest at an end.
        worst = np.maximum(kept.off(at + half * velocity), kept.off(at - half * velocity))
        stray, off = self._lost(half[:, 0], moves, rate, bend, lever)
        return np.asarray(worst + stray + np.sqrt(off) - kept.limit)

    def _middle_states(self, key: Ints) -> tuple[Floats, ...]:
        """Return rates and bends of joints, poses of frames, and how joints turn and shift the root's frame."""
        column, factor, share = self._frames.column, self._frames.factor, shares(key) / 2.0 ** (FINEST + 1)
        first, middle, last = np.moveaxis(self._curves[key >> FINEST + 1], 1, 0)
        share = share[:, None]
        q = (1 - share) ** 2 * first + 2 * share * (1 - share) * middle + share**2 * last
        rate = (2 * (1 - share) * (middle - first) + 2 * share * (last - middle))[:, column] * factor
        return self._states(q, rate, np.abs(2 * (last - 2 * middle + first))[:, column] * np.abs(factor))

    def _states(self, q: Floats, rate: Floats, bend: Floats) -> tuple[Floats, ...]:
        rotation, origin, axes = self._frames.at(q)
        turning = np.where(self._slides[:, None], 0.0, rate[:, :, None] * axes)
        along = np.where(self._slides[:, None], rate[:, :, None] * axes, np.cross(origin[:, 1:], turning))
        return rate, bend, rotation, origin, turning, along

    def _lost(self, half: Floats, moves: Bools, rate: Floats, bend: Floats, lever: Floats) -> Floats:
        """Return how far points stray at most from where their velocities take them, and the square of how far they are
        off by the tolerance, (2, n).
        """
        fastest = np.abs(rate) + half[:, None] * bend
        turns = moves * fastest * ~self._slides
        before = np.cumsum(turns, axis=1) - turns
        each = 0.5 * half[:, None] ** 2 * (fastest * (2 * before + turns) + bend)
        arm = moves * np.where(self._slides, 1.0, lever)
        return np.stack([(arm * each).sum(1), np.broadcast_to(arm**2 * self._off, each.shape).sum(1)])

    def _reach_by_corners(self, node: Ints, rows: Ints, local: Floats, far: Floats) -> None:
        """Write how far nodes reach by their corners, in the rows that are answered so."""
        rows = rows[np.argsort(node[rows], kind="stable")]
        for some in np.split(rows, np.flatnonzero(np.diff(node[rows])) + 1):
            if len(some):
                far[some] = self._nodes.supports(int(node[some[0]]), local[some])


def _middles(tasks: Ints) -> Ints:
    """Return one number for the motion and the middle of each stretch."""
    return np.asarray(tasks[:, MOTION] << FINEST + 1 | (2 * tasks[:, NUMBER] + 1) << FINEST - tasks[:, LEVEL])


def shares(key: Ints) -> Ints:
    """Return the parts of motions that numbers of `_middles` have."""
    return np.asarray(key & ((1 << FINEST + 1) - 1))
