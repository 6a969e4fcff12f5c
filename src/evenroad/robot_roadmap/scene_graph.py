"""SceneGraph: a roadmap in one scene with the states of its milestones and edges, in memory of compiled code."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad.robot.kernel.addresses import address, matrix_at
from evenroad.robot.kernel.layout import program, quick
from evenroad.robot_roadmap import memory as at
from evenroad.robot_roadmap.memory import (
    BLOCKED,
    FREE,
    PROVED,
    UNKNOWN,
    Search,
    kept_in_order,
    search_at,
)
from evenroad.robot_roadmap.metric import BITS, length_of_edge, measure
from evenroad.robot_roadmap.turns import MOST_TURNS, TURN, OneTurn

JOINED = 8
"""Number of nearest milestones that an inserted one may be joined to; a search evaluates these edges
when it needs to."""

AT_ONCE = 2 ** (BITS - 1) + 1 - MOST_TURNS
"""Largest number of turns of an inserted motion, so that the packed form still holds the sum."""

GROWTH = 256
"""Number of milestones by which memory grows when it is full."""

GREED = 3.0
"""Factor of the bound of the search: it needs a third of the checks of a shortest path, and after shortening its paths
are not longer."""

EXPENSIVE = 5.0
"""Cost of a unit of length of an edge that is not evaluated yet, where evaluations are expensive."""

OF_ROADMAP = ("milestones", "columns", "first", "halves", "leads", "lengths")
"""Arrays that scenes share until the first milestone is inserted in one of them."""

OF_SCENE = ("nodes", "edges", "rules")
"""Arrays of each scene."""

OF_QUERY = ("links", "straight")
"""Arrays of the states of a query's own motions."""


class Query(NamedTuple):
    """A start, (dim,), and goals, (g, dim), the largest number of links of each, the factor of the bound, and the cost
    of a unit of length that is not evaluated yet.
    """

    start: Floats
    goals: Floats
    links: int
    greed: float = GREED
    check_cost: float = 1.0


class SceneGraph:
    """Milestones and edges of a roadmap, their states in a scene, and those inserted there; for one thread.

    Parameters
    ----------
    milestones, edges, turns : arrays, (n, dim), (m, 2), (m, dim)
        Arrays of the roadmap.
    one : OneTurn
        The ranges of its joints.
    """

    def __init__(self, milestones: Floats, edges: Ints32, turns: Ints, one: OneTurn) -> None:
        (n, dim), m = milestones.shape, len(edges)
        own = np.concatenate([edges[:, 0], edges[:, 1]])
        order = np.argsort(own, kind="stable")
        own = own[order]
        self.header = np.zeros(at.HEADER, dtype=np.int64)
        self.header[[at.DIM, at.ANY_MULTI_TURN]] = dim, one.multi_turn.any()
        self.header[[at.NODES, at.HALVES_MADE, at.EDGES_MADE, at.BASE]] = n, 2 * m, m, m
        self.header[[at.CAPACITY, at.HALVES, at.EDGES]] = n, 2 * m, m
        rules = np.empty((at.RULE_ROWS, dim))
        rules[[at.LOW, at.HIGH]] = one.limits
        rules[at.MULTI_TURN], rules[at.ENDLESS] = one.multi_turn, one.wraps & ~one.multi_turn
        rules[at.MIDDLE] = 0.5 * (one.low + one.high)
        turned = np.where(one.multi_turn, turns, 0) @ (2**BITS) ** np.arange(dim)
        first, halves = np.full(n, -1), np.empty((2 * m, at.HALF), dtype=np.int32)
        halves[:, at.OTHER] = np.concatenate([edges[:, 1], edges[:, 0]])[order]
        halves[:, at.NUMBER] = np.tile(np.arange(m), 2)[order]
        halves[:, at.NEXT] = np.arange(1, 2 * m + 1)
        halves[np.flatnonzero(np.append(own[1:] != own[:-1], True)[: 2 * m]), at.NEXT] = -1
        first[own[::-1]] = np.arange(2 * m)[::-1]
        motions = milestones[edges[:, 1]] + TURN * turns - milestones[edges[:, 0]]
        self.arrays: dict[str, npt.NDArray[Any]] = {}
        self._shape = (0, 0)
        self._bind(
            milestones=np.ascontiguousarray(milestones),
            columns=milestones.T.astype(np.float32, order="C"),
            nodes=np.zeros(n, dtype=np.uint8),
            first=first,
            halves=halves,
            leads=np.concatenate([turned, -turned])[order],
            lengths=np.tile(np.linalg.norm(motions, axis=1), 2)[order].astype(np.float32),
            edges=np.zeros(m, dtype=np.uint8),
            rules=rules,
        )

    def within(self, low: Floats, high: Floats) -> SceneGraph:
        """Return a graph with unknown states, for narrower ranges, (dim,)."""
        fresh, q, rules = object.__new__(SceneGraph), self.arrays["milestones"], self.arrays["rules"].copy()
        fresh.header, fresh._shape = self.header.copy(), (0, 0)
        fresh.arrays = {name: self.arrays[name] for name in OF_ROADMAP}
        rules[at.LOW], rules[at.HIGH] = np.maximum(rules[at.LOW], low), np.minimum(rules[at.HIGH], high)
        outside = ((rules[at.MULTI_TURN] == 0.0) & ((q < low) | (q > high))).any(axis=1)
        nodes = np.where(outside, BLOCKED, UNKNOWN).astype(np.uint8)
        fresh._bind(nodes=nodes, edges=np.zeros_like(self.arrays["edges"]), rules=rules)
        return fresh

    def __getstate__(self) -> dict[str, Any]:
        """Return the parts of a copy, here or in another process, which sets its own addresses."""
        return {"header": self.header, "arrays": {n: self.arrays[n] for n in (*OF_ROADMAP, *OF_SCENE)}}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Restore a copy; it holds no query."""
        self.header, self.arrays, self._shape = kept["header"], {}, (0, 0)
        self._bind(**kept["arrays"])

    def _bind(self, **arrays: npt.NDArray[Any]) -> None:
        """Set arrays, and write their addresses."""
        self.arrays |= arrays
        for name, array in arrays.items():
            self.header[at.HEADER_INDEX[name]] = address(array)

    def _grow(self) -> None:
        """Extend the memory of milestones and edges, and copy them."""
        header, more = self.header, GROWTH * (JOINED + 2)
        added = np.array([GROWTH, 2 * more, more])
        header[[at.CAPACITY, at.HALVES, at.EDGES]] += added
        nodes, halves, edges = added.tolist()
        extra = {"edges": edges, "halves": halves, "leads": halves, "lengths": halves}
        extra |= dict.fromkeys(("milestones", "nodes", "first"), nodes)
        longer = {}
        for name, count in extra.items():
            array = self.arrays[name]
            longer[name] = np.concatenate([array, np.zeros((count, *array.shape[1:]), array.dtype)])
        longer["columns"] = longer["milestones"].T.astype(np.float32, order="C")
        self._bind(**longer)
        # The arrays of a query have another shape now.
        self._shape = (0, 0)

    def prepare(self, query: Query, growth: int = 1) -> None:
        """Write a query; `growth` multiplies the usual memory: where it is more than 1, the same query goes on."""
        header, rules, count = self.header, self.arrays["rules"], 1 + len(query.goals)
        rules[at.GREED], rules[at.CHECK_COST] = query.greed, query.check_cost
        earlier = [self.arrays[name] for name in OF_QUERY] if growth > 1 else []
        if self._shape != (count, growth):
            self._allocate(count, growth)
        header[at.LINKS] = min(query.links, int(header[at.NODES]))
        terminals = self.arrays["terminals"]
        terminals[0], terminals[1:count] = query.start, query.goals
        if not earlier:
            header[[at.CONFIGURATIONS, at.MOTIONS, at.BATCHES]] = 0
            for name in OF_QUERY:
                self.arrays[name].fill(UNKNOWN)
        for name, before in zip(OF_QUERY, earlier, strict=False):
            self.arrays[name][:] = before

    def _allocate(self, terminals: int, growth: int) -> None:
        """Allocate memory for a query with this number of terminals."""
        header, dim, capacity = self.header, int(self.header[at.DIM]), int(self.header[at.CAPACITY])
        self._shape = terminals, growth
        # The last row is a configuration to be inserted.
        rows, states = terminals + 1, 2 * growth * (capacity + GROWTH)
        entries = growth * (int(header[at.HALVES]) + (16 + terminals) * (capacity + GROWTH))
        header[at.TERMINALS], header[at.STATES], header[at.ENTRIES], header[at.SIZE] = (
            terminals,
            states,
            entries,
            0,
        )
        self._bind(
            terminals=np.zeros((rows, dim)),
            motion=np.zeros((2, dim)),
            turns=np.zeros((rows, capacity), dtype=np.int64),
            near=np.zeros((rows, capacity), dtype=np.int64),
            away=np.zeros((rows + 1) * capacity, dtype=np.float32),
            links=np.zeros((rows, capacity), dtype=np.uint8),
            straight=np.zeros(rows, dtype=np.uint8),
            radius=np.zeros(rows),
            heads=np.full(capacity, -1),
            states=np.empty((states, 4), dtype=np.int64),
            bounds=np.empty((states, 2)),
            entries=np.empty((entries, 3), dtype=np.int32),
            costs=np.empty(entries),
            keys=np.empty(entries),
            items=np.empty(entries, dtype=np.int64),
            path=np.empty((states + 2, dim)),
        )

    @property
    def size(self) -> int:
        """Number of milestones, inserted ones included."""
        return int(self.header[at.NODES])

    def insert(self, path: Floats) -> None:
        """Insert the waypoints of a path, (p, dim), as milestones; its motions are proved free in the scene.

        Nothing is inserted where joints turn so far that packed turns would overflow.
        """
        path, rules = np.ascontiguousarray(path), self.arrays["rules"]
        turns = np.rint((path - rules[at.MIDDLE]) / TURN)[:, rules[at.MULTI_TURN] > 0.0]
        steps = np.abs(np.diff(turns, axis=0))
        if np.abs(turns).max(initial=0.0) > MOST_TURNS or steps.max(initial=0.0) > AT_ONCE:
            return
        while True:
            if self._shape == (0, 0):
                # Working memory.
                self._allocate(2, 1)
            if _insert(address(self.header), address(path), len(path)):
                return
            self._grow()


@program
def _insert(header: int, path: int, rows: int) -> bool:
    """Add the waypoints of a path; return whether memory was enough."""
    s = search_at(header)
    h, waypoints, edges = s.header, matrix_at(path, (rows, s.header[at.DIM])), rows * (JOINED + 1)
    if rows > 0 and (
        h[at.NODES] + rows > h[at.CAPACITY]
        or h[at.EDGES_MADE] + edges > h[at.EDGES]
        or h[at.HALVES_MADE] + 2 * edges > h[at.HALVES]
    ):
        return False
    before, turned = -1, 0
    for row in range(rows):
        node, packed = _add_milestone(s, waypoints[row])
        if before >= 0 and before != node:
            _add_edge(s, before, node, packed - turned, PROVED)
        before, turned = node, packed
    return True


@quick
def _add_milestone(s: Search, q: Floats) -> tuple[int, int]:
    """Return the milestone at a free configuration, a new one if there is none, and its turns.

    A new one may be joined to its nearest ones by edges that are not evaluated yet.
    """
    h, dim, packed, count = s.header, s.header[at.DIM], 0, 0
    new, guest = h[at.NODES], h[at.TERMINALS]
    for k in range(dim):
        turn = np.rint((q[k] - s.rules[at.MIDDLE, k]) / TURN) if s.rules[at.MULTI_TURN, k] > 0.0 else 0.0
        s.terminals[guest, k], s.milestones[new, k] = q[k], q[k] - TURN * turn
        s.columns[k * h[at.CAPACITY] + new] = s.milestones[new, k]
        packed += int(turn) << (BITS * k)
    measure(s, guest)
    for i in range(new):
        away = s.away[guest * h[at.CAPACITY] + i]
        if (count == JOINED and away >= s.keys[JOINED - 1]) or s.nodes[i] == BLOCKED:
            continue
        if away == 0.0 and _same(s, i, new):
            s.nodes[i] = FREE
            return i, packed
        count = kept_in_order(s.keys, s.items, count, JOINED, away, i)
    s.nodes[new], s.first[new] = FREE, -1
    h[at.NODES] = new + 1
    for rank in range(count):
        i = s.items[rank]
        _add_edge(s, new, i, s.turns[guest, i] - packed, UNKNOWN)
    return new, packed


@quick
def _same(s: Search, a: int, b: int) -> bool:
    """Return whether two milestones are one configuration."""
    same = True
    for k in range(s.header[at.DIM]):
        same &= s.milestones[a, k] == s.milestones[b, k]
    return same


@quick
def _add_edge(s: Search, a: int, b: int, turns: int, state: int) -> None:
    """Join two milestones by a motion that leads past the second by packed turns."""
    h, edge, length = s.header, s.header[at.EDGES_MADE], length_of_edge(s, a, b, turns)
    h[at.EDGES_MADE] += 1
    s.edges[edge] = state
    for side in range(2):
        half, here = h[at.HALVES_MADE], a if side == 0 else b
        h[at.HALVES_MADE] += 1
        s.halves[half, at.OTHER], s.halves[half, at.NUMBER] = a + b - here, edge
        s.leads[half] = turns if side == 0 else -turns
        s.halves[half, at.NEXT], s.first[here] = s.first[here], half
        s.lengths[half] = length
