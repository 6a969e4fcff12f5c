"""What is known of a graph's nodes and edges in a world, and how much was asked to know it."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints32
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World

UNKNOWN, FREE, BLOCKED = np.int8(0), np.int8(1), np.int8(2)
"""What is known of an edge or a node."""

_FIRST_BATCH = 32
"""Rows asked about at first where time is limited."""
_FAST = 0.02
"""Seconds.  While batches take less, they grow; while they take more, they shrink."""


class BudgetSpent(Exception):
    """Nothing more may be checked; caught where the budget was given."""


def in_time(rows: npt.NDArray[np.integer], deadline: float) -> Iterator[npt.NDArray[np.integer]]:
    """Yield `rows` in batches, all at once if there is no deadline.

    Raises BudgetSpent when the deadline (on the clock of ``time.perf_counter``) has passed and there are rows left.
    """
    size = _FIRST_BATCH if math.isfinite(deadline) else max(len(rows), 1)
    first = 0
    while first < len(rows):
        began = time.perf_counter()
        if began >= deadline:
            raise BudgetSpent
        yield rows[first : first + size]
        first += size
        size = 2 * size if time.perf_counter() - began < _FAST else max(size // 2, 1)


@dataclass(frozen=True, eq=False)
class Known:
    """What is known of nodes and edges: `UNKNOWN`, `FREE` or `BLOCKED`, (nodes,) and (m,) int8.

    `confirmed`, (m,), says which free edges have passed the strict check of a world that has one.
    """

    nodes: npt.NDArray[np.int8]
    edges: npt.NDArray[np.int8]
    confirmed: Bools

    @classmethod
    def nothing(cls, nodes: int, edges: int) -> Known:
        """Return that nothing is known yet."""
        return cls(np.full(nodes, UNKNOWN), np.full(edges, UNKNOWN), np.zeros(edges, dtype=np.bool_))


class EdgeStates:
    """The states of nodes and edges, filled in as the world checks them; nothing is ever checked twice.

    Parameters
    ----------
    configurations, edges : ndarray, shapes (nodes, dim) and (m, 2)
        The graph; motions are checked from the first node of an edge to the second.
    watch : Stopwatch, optional
        Gets the seconds of the world's answers, as the phases ``validity`` and ``motions``.
    most_motions : int, optional
        How many motions may be checked.
    deadline : float
        When nothing may be checked any more, on the clock of ``time.perf_counter``.
    known : Known, optional
        What is known already, to be added to in place; its arrays are `node_states`, `edge_states` and `confirmed`
        here.

    Attributes
    ----------
    configurations_checked, motions_checked : int
        How much was checked here.
    """

    def __init__(
        self,
        world: World,
        configurations: Floats,
        edges: Ints32,
        watch: Stopwatch | None = None,
        most_motions: int | None = None,
        deadline: float = math.inf,
        known: Known | None = None,
    ) -> None:
        self.world, self.configurations, self.edges = world, configurations, edges
        known = Known.nothing(len(configurations), len(edges)) if known is None else known
        self.node_states, self.edge_states, self.confirmed = known.nodes, known.edges, known.confirmed
        self.configurations_checked = self.motions_checked = 0
        self.watch = Stopwatch() if watch is None else watch
        self.most_motions, self.deadline = most_motions, deadline

    def ask_nodes(self, nodes: npt.NDArray[np.integer]) -> None:
        """Ask the world about those of the nodes that are not known yet.

        Raises BudgetSpent if the time was over before; what was asked is kept.
        """
        unknown = nodes[self.node_states[nodes] == UNKNOWN]
        for rows in in_time(unknown, self.deadline):
            with self.watch("validity"):
                free = self.world.valid(self.configurations[rows])
            self.node_states[rows] = np.where(free, FREE, BLOCKED)
            self.configurations_checked += len(rows)

    def ask_edges(self, edges: npt.NDArray[np.integer]) -> None:
        """Ask the world about those of the edges that are not known yet, as many as the budget allows.

        Raises BudgetSpent if there were more of them; what was asked is kept.
        """
        unknown = edges[self.edge_states[edges] == UNKNOWN]
        wanted = len(unknown)
        if self.most_motions is not None:
            unknown = unknown[: self.most_motions - self.motions_checked]
        for rows in in_time(unknown, self.deadline):
            pairs = self.edges[rows]
            a, b = self.configurations[pairs[:, 0]], self.configurations[pairs[:, 1]]
            with self.watch("motions"):
                free = self.world.motion_valid(a, b)
            self.edge_states[rows] = np.where(free, FREE, BLOCKED)
            self.motions_checked += len(rows)
        if len(unknown) < wanted:
            raise BudgetSpent

    def open_edges(self) -> Ints32:
        """Return the edges that are not known to be blocked, nor their nodes, shape (m', 2)."""
        open_nodes = (self.node_states[self.edges] != BLOCKED).all(axis=1)
        return self.edges[open_nodes & (self.edge_states != BLOCKED)]
