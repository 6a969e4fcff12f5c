"""KnownGraph: a roadmap in one scene with what was found out there, in memory that compiled code works in."""

from __future__ import annotations

from copy import copy
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.robot.kernel.addresses import address, doubles_at, integers_at, matrix_at
from evenroad.robot.kernel.layout import program, quick
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.search_memory import (
    BLOCKED,
    DOUBTED,
    FREE,
    PROVED,
    UNKNOWN,
    Search,
    group_of,
    join,
    kept_in_order,
    search_at,
)
from evenroad.robot_roadmap.search_metric import BITS, length_of_edge, measure, write, write_distances
from evenroad.robot_roadmap.turns import MOST_TURNS, TURN, OneTurn

JOINED = 8
"""Nearest milestones that a learned one may be joined to; whether they can be is asked when a search comes by."""

LEAST = 8
"""A group of fewer milestones that free motions join leads nowhere."""

AT_ONCE = 2 ** (BITS - 1) + 1 - MOST_TURNS
"""A learned motion of more turns would lead from turns that are followed over all that the packed form knows."""

ROOM = 256
"""Milestones to be learned that there is room for at first."""


class KnownGraph:
    """Milestones and edges of a roadmap with their verdicts in a scene, and what was learned there; of one thread.

    Parameters
    ----------
    milestones, edges, turns : arrays, (n, dim), (m, 2), (m, dim)
        Of the roadmap.
    one : OneTurn
        The ranges of its joints.
    """

    def __init__(self, milestones: Floats, edges: Ints32, turns: Ints, one: OneTurn) -> None:
        n, dim = milestones.shape
        own = np.concatenate([edges[:, 0], edges[:, 1]])
        order = np.argsort(own, kind="stable")
        own, count = own[order], len(own)
        self.desk = np.zeros(at.DESK, dtype=np.int64)
        self.rules = np.empty((at.RULE_ROWS, dim))
        self.rules[[at.LOW, at.HIGH]] = one.limits
        self.rules[at.LIFTS], self.rules[at.ENDLESS] = one.lifts, one.wraps & ~one.lifts
        self.rules[at.MIDDLE], self.rules[at.GREED] = 0.5 * (one.low + one.high), 1.0
        self.desk[at.DIM], self.desk[at.LIFTING] = dim, one.lifts.any()
        self._query, self._shape = np.empty(0), (0, 0)
        self._make_room(n, count, len(edges))
        self.desk[[at.NODES, at.HALVES_MADE, at.EDGES_MADE, at.BASE]] = n, count, len(edges), len(edges)
        self.milestones[:n], self.columns[:, :n] = milestones, milestones.T
        turned = np.where(one.lifts, turns, 0) @ (2**BITS) ** np.arange(dim)
        half, here = self.halves[:count], np.arange(count)
        half[:, at.OTHER] = np.concatenate([edges[:, 1], edges[:, 0]])[order]
        half[:, at.NUMBER] = np.tile(np.arange(len(edges)), 2)[order]
        self.leads[:count] = np.concatenate([turned, -turned])[order]
        half[:, at.NEXT] = here + 1
        half[np.flatnonzero(np.append(own[1:] != own[:-1], True)[:count]), at.NEXT] = -1
        self.first[:] = -1
        self.first[own[::-1]] = here[::-1]
        self.groups[:n] = np.arange(n)
        way = milestones[edges[:, 1]] + TURN * turns - milestones[edges[:, 0]]
        self.lengths[:count] = np.tile(np.linalg.norm(way, axis=1), 2)[order]

    def within(self, low: Floats, high: Floats) -> KnownGraph:
        """Return a graph of which nothing is known, for narrower ranges, (dim,)."""
        fresh = copy(self)
        fresh.desk, fresh.rules = self.desk.copy(), self.rules.copy()
        fresh._known, fresh.edges = self._known.copy(), np.zeros_like(self.edges)
        # Half edges are shared until the first are learned.
        fresh._shares, fresh._query, fresh._shape = True, np.empty(0), (0, 0)
        fresh._lay_out()
        fresh.rules[at.LOW] = np.maximum(self.rules[at.LOW], low)
        fresh.rules[at.HIGH] = np.minimum(self.rules[at.HIGH], high)
        n = int(self.desk[at.NODES])
        lifts, q = self.rules[at.LIFTS] > 0.0, self.milestones[:n]
        if np.any(~lifts & ((low > self.rules[at.LOW]) | (high < self.rules[at.HIGH]))):
            fresh.nodes[:n] = np.where((~lifts & ((q < low) | (q > high))).any(axis=1), BLOCKED, UNKNOWN)
        return fresh

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy is made of, here or in another process: it finds out for itself where its arrays are."""
        kept = "desk", "rules", "edges", "_known", "_graph", "_shares"
        return {name: vars(self)[name] for name in kept}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Make a copy of it, in which no query is written yet."""
        vars(self).update(kept, _query=np.empty(0), _shape=(0, 0))
        self._lay_out()

    def _make_room(self, nodes: int, halves: int, edges: int) -> None:
        """Take memory for so many and some more."""
        desk, dim, more = self.desk, int(self.desk[at.DIM]), ROOM * (JOINED + 2)
        desk[at.CAPACITY], desk[at.HALVES], desk[at.EDGES] = nodes + ROOM, halves + 2 * more, edges + more
        self._known = np.zeros(at.known_room(nodes + ROOM, dim))
        self._graph, self._shares = np.zeros(at.graph_room(halves + 2 * more)), False
        self.edges = np.zeros(edges + more, dtype=np.uint8)
        self._lay_out()

    def _lay_out(self) -> None:
        """Write where things lie in the memory."""
        desk, dim, capacity = self.desk, int(self.desk[at.DIM]), int(self.desk[at.CAPACITY])
        parts, graph = (self._known, self._graph, self.rules, self.edges), self._graph
        desk[[at.KNOWN, at.GRAPH, at.RULES, at.VERDICTS]] = [address(a) for a in parts]
        self.milestones = self._known[: dim * capacity].reshape(capacity, dim)
        self.columns = self._known[dim * capacity :].view(np.float32)[: dim * capacity].reshape(dim, capacity)
        behind = (dim + (dim + 1) // 2) * capacity
        self.first, self.groups = self._known[behind:][: 2 * capacity].view(np.int64).reshape(2, capacity)
        self.nodes = self._known[behind + 2 * capacity :].view(np.uint8)[:capacity]
        count = int(desk[at.HALVES])
        split = at.HALF * count // 2
        self.halves = graph[:split].view(np.int32).reshape(count, at.HALF)
        self.leads = graph[split : split + count].view(np.int64)
        self.lengths = graph[split + count :].view(np.float32)

    def _grow(self) -> None:
        """Take more memory, and copy what there is."""
        old = self._arrays()
        self._make_room(len(self.nodes), len(self.halves), len(self.edges))
        self._query, self._shape = np.empty(0), (0, 0)
        new = self._arrays()
        for before, after in zip(old, new, strict=True):
            after[: len(before)] = before
        self.columns[:, : len(old[0])] = old[0].T

    def _arrays(self) -> tuple[npt.NDArray[Any], ...]:
        known = self.milestones, self.nodes, self.first, self.groups
        return *known, self.halves, self.leads, self.lengths, self.edges

    def prepare(
        self,
        start: Floats,
        goals: Floats,
        links: int,
        greed: float,
        nearby: float = 0.0,
        room: int = 1,
        *,
        only_known: bool = False,
        unturned: bool = False,
    ) -> None:
        """Write a query, of which nothing is known yet.

        `greed` multiplies the bound of the search, 1 for the shortest way; `nearby` times their length links of the
        start come later than this says, so that near milestones are tried first; `room` multiplies the usual memory.
        With `only_known` it is the last query, whose links are known; where these are forgotten, it is a new one.  With
        `unturned` ends are linked to milestones in their one turn.
        """
        desk, e = self.desk, 1 + len(goals)
        self.rules[at.GREED, 0], self.rules[at.NEARBY, 0] = greed, nearby
        if self._shape != (e, room):
            self._take_room(e, room)
            only_known = False
        desk[at.LINKS] = min(links, int(desk[at.NODES]))
        desk[at.ONLY_KNOWN], desk[at.UNTURNED] = only_known, unturned
        self.ends[0], self.ends[1:] = start, goals
        if not only_known:
            self._verdicts.fill(UNKNOWN)
            desk[at.MEASURED] = 0

    def _take_room(self, ends: int, room: int) -> None:
        """Take memory for a query of so many ends, in which nothing is written yet."""
        desk, dim, capacity = self.desk, int(self.desk[at.DIM]), int(self.desk[at.CAPACITY])
        self._shape = ends, room
        desk[at.ENDS], desk[at.STATES], desk[at.SIZE] = ends, 2 * room * capacity, 0
        desk[at.ENTRIES] = room * (desk[at.HALVES] + (2 + ends) * capacity)
        self._query = np.zeros(at.query_room(desk))
        desk[at.QUERY] = address(self._query)
        # The last end is a place that is learned.
        begin, row = (ends + 3) * dim, (ends + 1) * capacity
        heads = begin + 3 * row + ends + 1
        self.ends = self._query[: ends * dim].reshape(ends, dim)
        self.asked = self._query[(ends + 1) * dim : begin].reshape(2, dim)
        turns_and_near = self._query[begin:][: 2 * row].view(np.int64)
        self.turns, self.near = turns_and_near.reshape(2, ends + 1, capacity)
        behind = self._query[begin + 2 * row : begin + 3 * row].view(np.uint8)
        self._verdicts = behind[4 * (row + capacity) :][: row + ends]
        self._links, self._straight = self._verdicts[:row].reshape(ends + 1, capacity), self._verdicts[row:]
        self._query[heads : heads + capacity].view(np.int64)[:] = -1
        self.path, self.report = np.empty((2 * room * capacity + 2, dim)), np.zeros(at.REPORT, np.int64)
        # Worked out once: that takes longer than the rest.
        self.places = address(desk), address(self.path), len(self.path), address(self.report)

    def doubt(self, end: int) -> None:
        """Take it that no motion of an end of the query is proved soon."""
        motions = self._links[end], self._straight[end : end + 1] if end else self._straight
        for verdicts in motions:
            verdicts[verdicts == UNKNOWN] = DOUBTED

    def around(self, weights: Floats, onward: float, most: int) -> list[Floats | None]:
        """Return which milestones, (m, dim), ways out of start and goal of the last search may lead to.

        Of the largest group that free motions join, these have the shortest way by them from end to end, of
        which the part beyond counts `onward`, in the metric of such weights, (dim,).  None for an end that is
        linked to the group; none, m = 0, where the group is small.
        """
        found, counts = np.empty((2, most, len(weights))), np.empty(2, dtype=np.int64)
        _around(address(self.desk), address(weights), onward, most, address(found), address(counts))
        return [None if n < 0 else rows[:n] for rows, n in zip(found, counts.tolist(), strict=True)]

    def _own_halves(self) -> None:
        """Share half edges no longer."""
        if self._shares:
            self._graph, self._shares = self._graph.copy(), False
            self._lay_out()

    def learn(self, path: Floats) -> None:
        """Take the waypoints of a path, (p, dim), for milestones; its motions are proved free today.

        Nothing is learned where joints turn so far that packed turns would be read as others.
        """
        path = np.ascontiguousarray(path)
        turns = np.rint((path - self.rules[at.MIDDLE]) / TURN)[:, self.rules[at.LIFTS] > 0.0]
        steps = np.abs(np.diff(turns, axis=0))
        if np.abs(turns).max(initial=0.0) > MOST_TURNS or steps.max(initial=0.0) > AT_ONCE:
            return
        if len(path):
            self._own_halves()
        if not len(self._query):
            # Room that is worked in.
            self.prepare(self.milestones[0], self.milestones[:1], 1, 1.0)
        while not _learn(address(self.desk), address(path), len(path)):
            self._grow()
            self.prepare(path[0], path[:1], 1, 1.0)
            # What is kept of a query is gone.
            self._shape = (0, 0)


@program
def _around(desk: int, weights: int, onward: float, most: int, into: int, counts: int) -> int:
    """Write what `KnownGraph.around` returns."""
    s, found, main = search_at(desk), integers_at(counts, (2,)), 0
    n, dim = s.desk[at.NODES], s.desk[at.DIM]
    s.items[:n] = 0
    for i in range(n):
        if s.nodes[i] == FREE:
            group = group_of(s, i)
            s.items[group] += 1
            main = group if s.items[group] > s.items[main] else main
    few = s.items[main] < LEAST
    for end in range(2):
        found[end] = 0
        for i in range(n):
            if s.links[end, i] >= FREE and group_of(s, i) == main:
                found[end] = -1
    weight, way = doubles_at(weights, (dim,)), s.costs[:n]
    for end in range(2):
        if few or found[end] < 0:
            continue
        write_distances(s, end, weight, way)
        write_distances(s, 1 - end, weight, s.keys[:n])
        for i in range(n):
            way[i] += onward * s.keys[i]
        count = 0
        for i in range(n):
            if count == most and way[i] >= s.keys[most - 1]:
                continue
            if s.nodes[i] == FREE and group_of(s, i) == main:
                count = kept_in_order(s.keys, s.items, count, most, way[i], i)
        rows = matrix_at(into + 8 * end * most * dim, (most, dim))
        for rank in range(count):
            write(s, s.items[rank], s.turns[end, s.items[rank]], rows[rank])
        found[end] = count
    return main


@program
def _learn(desk: int, path: int, rows: int) -> bool:
    """Add the waypoints of a path; return whether there was room."""
    s = search_at(desk)
    d, way, edges = s.desk, matrix_at(path, (rows, s.desk[at.DIM])), rows * (JOINED + 1)
    if (
        d[at.NODES] + rows > d[at.CAPACITY]
        or d[at.EDGES_MADE] + edges > d[at.EDGES]
        or d[at.HALVES_MADE] + 2 * edges > d[at.HALVES]
    ):
        return False
    before, turned = -1, 0
    for row in range(rows):
        node, packed = _add_milestone(s, way[row])
        if before >= 0 and before != node:
            _add_edge(s, before, node, packed - turned, PROVED)
        before, turned = node, packed
    return True


@quick
def _add_milestone(s: Search, q: Floats) -> tuple[int, int]:
    """Return the milestone at a free configuration, a new one where there is none, and after which turns it is there.

    A new one may be joined to its nearest ones, which nobody has asked about.
    """
    d, dim, packed, count = s.desk, s.desk[at.DIM], 0, 0
    new, guest = d[at.NODES], d[at.ENDS]
    for k in range(dim):
        turn = np.rint((q[k] - s.rules[at.MIDDLE, k]) / TURN) if s.rules[at.LIFTS, k] > 0.0 else 0.0
        s.ends[guest, k], s.milestones[new, k] = q[k], q[k] - TURN * turn
        s.columns[k * d[at.CAPACITY] + new] = s.milestones[new, k]
        packed += int(turn) << (BITS * k)
    measure(s, guest, 0)
    for i in range(new):
        away = s.away[guest * d[at.CAPACITY] + i]
        if (count == JOINED and away >= s.keys[JOINED - 1]) or s.nodes[i] == BLOCKED:
            continue
        if away == 0.0 and _same(s, i, new):
            s.nodes[i] = FREE
            return i, packed
        count = kept_in_order(s.keys, s.items, count, JOINED, away, i)
    s.nodes[new], s.first[new], s.groups[new] = FREE, -1, new
    d[at.NODES] = new + 1
    for rank in range(count):
        i = s.items[rank]
        _add_edge(s, new, i, s.turns[guest, i] - packed, UNKNOWN)
    return new, packed


@quick
def _same(s: Search, a: int, b: int) -> bool:
    """Return whether two milestones are one place."""
    same = True
    for k in range(s.desk[at.DIM]):
        same &= s.milestones[a, k] == s.milestones[b, k]
    return same


@quick
def _add_edge(s: Search, a: int, b: int, turns: int, verdict: int) -> None:
    """Join two milestones by a motion that leads past the second by packed turns."""
    d, edge, length = s.desk, s.desk[at.EDGES_MADE], length_of_edge(s, a, b, turns)
    d[at.EDGES_MADE] += 1
    s.edges[edge] = verdict
    if verdict == PROVED:
        join(s, a, b)
    for side in range(2):
        half, here = d[at.HALVES_MADE], a if side == 0 else b
        d[at.HALVES_MADE] += 1
        s.halves[half, at.OTHER], s.halves[half, at.NUMBER] = a + b - here, edge
        s.leads[half] = turns if side == 0 else -turns
        s.halves[half, at.NEXT], s.first[here] = s.first[here], half
        s.lengths[half] = length
