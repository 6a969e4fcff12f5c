"""KnownGraph: a roadmap in one scene with what was found out there, in memory that compiled code works in."""

from __future__ import annotations

from copy import copy

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.robot.kernel.addresses import address, matrix_at
from evenroad.robot.kernel.layout import program, quick
from evenroad.robot_roadmap import search_memory as at
from evenroad.robot_roadmap.search_memory import BLOCKED, FREE, PROVED, UNKNOWN, Search, search_at
from evenroad.robot_roadmap.search_metric import BITS, length_of_edge
from evenroad.robot_roadmap.turns import TURN, OneTurn

JOINED = 8
"""Nearest milestones that a learned one may be joined to; whether they can be is asked when a search comes by."""

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
        self.desk[at.DIM] = dim
        self._make_room(n, count, len(edges))
        self.desk[[at.NODES, at.HALVES_MADE, at.EDGES_MADE, at.BASE]] = n, count, len(edges), len(edges)
        self.milestones[:n], self.columns[:, :n] = milestones, milestones.T
        turned = np.where(one.lifts, turns, 0) @ (2**BITS) ** np.arange(dim)
        half, here = self.halves[:count], np.arange(count)
        half[:, at.OTHER] = np.concatenate([edges[:, 1], edges[:, 0]])[order]
        half[:, at.NUMBER] = np.tile(np.arange(len(edges)), 2)[order]
        half[:, at.TURNS] = np.concatenate([turned, -turned])[order]
        half[:, at.NEXT] = here + 1
        half[np.flatnonzero(np.append(own[1:] != own[:-1], True)[:count]), at.NEXT] = -1
        self.first[:] = -1
        self.first[own[::-1]] = here[::-1]
        way = milestones[edges[:, 1]] + TURN * turns - milestones[edges[:, 0]]
        self.lengths[:count] = np.tile(np.linalg.norm(way, axis=1), 2)[order]

    def within(self, low: Floats, high: Floats) -> KnownGraph:
        """Return a graph of which nothing is known, for narrower ranges, (dim,)."""
        fresh = copy(self)
        fresh.desk, fresh.rules = self.desk.copy(), self.rules.copy()
        fresh._known, fresh._graph = self._known.copy(), self._graph.copy()
        fresh._lay_out()
        fresh.rules[at.LOW] = np.maximum(self.rules[at.LOW], low)
        fresh.rules[at.HIGH] = np.minimum(self.rules[at.HIGH], high)
        n = int(self.desk[at.NODES])
        lifts, q = self.rules[at.LIFTS] > 0.0, self.milestones[:n]
        fresh.nodes[:n] = np.where((~lifts & ((q < low) | (q > high))).any(axis=1), BLOCKED, UNKNOWN)
        fresh.edges[:] = UNKNOWN
        return fresh

    def _make_room(self, nodes: int, halves: int, edges: int) -> None:
        """Take memory for so many and some more."""
        desk, dim, more = self.desk, int(self.desk[at.DIM]), ROOM * (JOINED + 2)
        desk[at.CAPACITY], desk[at.HALVES], desk[at.EDGES] = nodes + ROOM, halves + 2 * more, edges + more
        self._known = np.zeros(at.known_room(nodes + ROOM, dim))
        self._graph = np.zeros(5 * (halves + 2 * more) + edges + more)
        self._lay_out()

    def _lay_out(self) -> None:
        """Write where things lie in the memory."""
        desk, dim, capacity = self.desk, int(self.desk[at.DIM]), int(self.desk[at.CAPACITY])
        desk[at.KNOWN], desk[at.GRAPH], desk[at.RULES] = map(address, (self._known, self._graph, self.rules))
        self.milestones = self._known[: dim * capacity].reshape(capacity, dim)
        self.columns = self._known[dim * capacity :].view(np.float32)[: dim * capacity].reshape(dim, capacity)
        self.nodes, self.first = self._known[-2 * capacity :].view(np.int64).reshape(2, capacity)
        split = 4 * int(desk[at.HALVES])
        self.halves = self._graph[:split].view(np.int64).reshape(-1, 4)
        self.lengths = self._graph[split : split // 4 * 5]
        self.edges = self._graph[split // 4 * 5 :].view(np.int64)
        self._query, self._shape = np.empty(0), (0, 0)

    def _grow(self) -> None:
        """Take more memory, and copy what there is."""
        old = self.milestones, self.nodes, self.first, self.halves, self.lengths, self.edges
        self._make_room(len(self.nodes), len(self.halves), len(self.edges))
        new = self.milestones, self.nodes, self.first, self.halves, self.lengths, self.edges
        for before, after in zip(old, new, strict=True):
            after[: len(before)] = before
        self.columns[:, : len(old[0])] = old[0].T

    def prepare(self, start: Floats, goals: Floats, links: int, greed: float, room: int = 1) -> None:
        """Write a query, of which nothing is known yet.

        `greed` multiplies the bound of the search, 1 for the shortest way; `room` the usual memory.
        """
        desk, e, self.rules[at.GREED] = self.desk, 1 + len(goals), greed
        dim, capacity = int(desk[at.DIM]), int(desk[at.CAPACITY])
        desk[at.LINKS] = min(links, desk[at.NODES])
        if self._shape != (e, room):
            self._shape = e, room
            desk[at.ENDS], desk[at.STATES] = e, 2 * room * capacity
            desk[at.ENTRIES] = room * (desk[at.HALVES] + (1 + e) * capacity)
            self._query = np.empty(at.query_room(desk))
            desk[at.QUERY] = address(self._query)
            begin, end = (e + 2) * dim, (e + 2) * dim + 4 * e * capacity
            self.ends = self._query[: e * dim].reshape(e, dim)
            self.asked = self._query[e * dim : begin].reshape(2, dim)
            self._links = self._query[begin : begin + 2 * e * capacity].view(np.int64)
            self._straight = self._query[end : end + e].view(np.int64)
            self.path = np.empty((2 * room * capacity + 2, dim))
        self.ends[0], self.ends[1:] = start, goals
        # Verdicts of the links, and behind them the turns of those that do not turn.
        self._links[:] = 0
        self._straight[:] = UNKNOWN

    def learn(self, path: Floats) -> None:
        """Take the waypoints of a path, (p, dim), for milestones; its motions are proved free today."""
        path = np.ascontiguousarray(path)
        if not len(self._query):
            # Room that is worked in.
            self.prepare(self.milestones[0], self.milestones[:1], 1, 1.0)
        while not _learn(address(self.desk), address(path), len(path)):
            self._grow()
            self.prepare(path[0], path[:1], 1, 1.0)


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
    d, dim, packed = s.desk, s.desk[at.DIM], 0
    new, count = d[at.NODES], 0
    for k in range(dim):
        turn = np.rint((q[k] - s.rules[at.MIDDLE, k]) / TURN) if s.rules[at.LIFTS, k] > 0.0 else 0.0
        s.milestones[new, k] = q[k] - TURN * turn
        s.columns[k * d[at.CAPACITY] + new] = s.milestones[new, k]
        packed += int(turn) << (BITS * k)
    for i in range(new):
        if s.nodes[i] == BLOCKED:
            continue
        squared, most = 0.0, 0.0
        for k in range(dim):
            apart = s.milestones[i, k] - s.milestones[new, k]
            most = max(most, abs(apart))
            if s.rules[at.LIFTS, k] > 0.0 or s.rules[at.ENDLESS, k] > 0.0:
                apart -= TURN * np.rint(apart / TURN)
            squared += apart * apart
        if most == 0.0:
            s.nodes[i] = FREE
            return i, packed
        if count == JOINED and squared >= s.keys[count - 1]:
            continue
        # Kept in order.
        count = min(count + 1, JOINED)
        place = count - 1
        while place > 0 and s.keys[place - 1] > squared:
            s.keys[place], s.items[place] = s.keys[place - 1], s.items[place - 1]
            place -= 1
        s.keys[place], s.items[place] = squared, i
    s.nodes[new], s.first[new] = FREE, -1
    d[at.NODES] = new + 1
    for rank in range(count):
        i, turns = s.items[rank], 0
        for k in range(dim):
            if s.rules[at.LIFTS, k] > 0.0:
                apart = s.milestones[new, k] - s.milestones[i, k]
                turns += int(np.rint(apart / TURN)) << (BITS * k)
        _add_edge(s, new, i, turns, UNKNOWN)
    return new, packed


@quick
def _add_edge(s: Search, a: int, b: int, turns: int, verdict: int) -> None:
    """Join two milestones by a motion that leads past the second by packed turns."""
    d, edge, length = s.desk, s.desk[at.EDGES_MADE], length_of_edge(s, a, b, turns)
    d[at.EDGES_MADE] += 1
    s.edges[edge] = verdict
    for side in range(2):
        half, here = d[at.HALVES_MADE], a if side == 0 else b
        d[at.HALVES_MADE] += 1
        s.halves[half, at.OTHER], s.halves[half, at.NUMBER] = a + b - here, edge
        s.halves[half, at.TURNS] = turns if side == 0 else -turns
        s.halves[half, at.NEXT], s.first[here] = s.first[here], half
        s.lengths[half] = length
