"""The states of a graph's nodes and edges in a world, and the number of checks made."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats, Ints32
from evenroad._time_limit import BudgetSpent, Pace, in_time
from evenroad.roadmap.budget import Stopwatch
from evenroad.world import World

States: TypeAlias = npt.NDArray[np.int8]

UNKNOWN, FREE, BLOCKED = np.int8(0), np.int8(1), np.int8(2)
"""State of an edge or a node."""


@dataclass(frozen=True, eq=False)
class StateCache:
    """States of nodes and edges: `UNKNOWN`, `FREE` or `BLOCKED`, (nodes,) and (m,) int8.

    `confirmed`, (m,), are the free edges that have passed the strict check of a world that has one.
    """

    nodes: States
    edges: States
    confirmed: Bools

    @classmethod
    def nothing(cls, nodes: int, edges: int) -> StateCache:
        """Return a cache in which every state is unknown."""
        return cls(np.full(nodes, UNKNOWN), np.full(edges, UNKNOWN), np.zeros(edges, dtype=np.bool_))


class EdgeStates:
    """The states of nodes and edges, filled in as the world checks them; nothing is checked twice.

    The nodes are `configurations`, (nodes, dim); the motions of `edges`, (m, 2), are checked from the first node to the
    second.  `cache` holds earlier states and is updated in place.  At most `most_motions` are checked before the
    deadline.  `configurations_checked` and `motions_checked` count checks; `watch` times the phases ``validity`` and
    ``motions``.
    """

    def __init__(
        self,
        world: World,
        configurations: Floats,
        edges: Ints32,
        watch: Stopwatch | None = None,
        most_motions: int | None = None,
        cache: StateCache | None = None,
    ) -> None:
        self.world, self.configurations, self.edges = world, configurations, edges
        cache = StateCache.nothing(len(configurations), len(edges)) if cache is None else cache
        self.node_states, self.edge_states, self.confirmed = cache.nodes, cache.edges, cache.confirmed
        self.configurations_checked = self.motions_checked = 0
        self.watch = Stopwatch() if watch is None else watch
        self.most_motions = most_motions
        self._node_pace, self._edge_pace = Pace(), Pace()

    def evaluate_nodes(self, nodes: npt.NDArray[np.integer]) -> None:
        """Check the nodes whose state is unknown; BudgetSpent if the time is too short for all."""
        unknown = nodes[self.node_states[nodes] == UNKNOWN]
        for rows in in_time(unknown, self._node_pace):
            with self.watch("validity"):
                free = self.world.valid(self.configurations[rows])
            self.node_states[rows] = np.where(free, FREE, BLOCKED)
            self.configurations_checked += len(rows)

    def evaluate_edges(self, edges: npt.NDArray[np.integer]) -> None:
        """Check the edges whose state is unknown; BudgetSpent if there are too many."""
        unknown = edges[self.edge_states[edges] == UNKNOWN]
        wanted = len(unknown)
        if self.most_motions is not None:
            unknown = unknown[: self.most_motions - self.motions_checked]
        for rows in in_time(unknown, self._edge_pace):
            pairs = self.edges[rows]
            a, b = self.configurations[pairs[:, 0]], self.configurations[pairs[:, 1]]
            with self.watch("motions"):
                free = self.world.motion_valid(a, b)
            self.edge_states[rows] = np.where(free, FREE, BLOCKED)
            self.motions_checked += len(rows)
        if len(unknown) < wanted:
            raise BudgetSpent
