"""What is known of a graph in a world, and how much was asked to know it."""

from __future__ import annotations

import math
import time

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search.a_star import BLOCKED, FREE, UNKNOWN
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World


class BudgetSpent(Exception):
    """No further motion may be checked; caught where the budget was given."""


class Ledger:
    """The states of nodes and edges, filled in as the world is asked; nothing is ever asked twice.

    Parameters
    ----------
    world : World
        Who is asked.
    configurations : ndarray, shape (nodes, dim)
        Of the nodes.
    edges : ndarray of int32, shape (m, 2)
        Pairs of nodes; motions are asked in this direction.
    watch : Stopwatch, optional
        Gets the seconds of the world's answers, as the phases ``validity`` and ``motions``.
    most_motions : int, optional
        How many motions may be checked.
    deadline : float
        When no motion may be checked any more, on the clock of ``time.perf_counter``.

    Attributes
    ----------
    node_states, edge_states : ndarray of int8, shape (nodes,) and (m,)
        `UNKNOWN`, `FREE` or `BLOCKED`; to be filled in by callers who know more.
    configurations_checked, motions_checked : int
        How much was asked here.
    """

    def __init__(
        self,
        world: World,
        configurations: npt.NDArray[np.float64],
        edges: npt.NDArray[np.int32],
        watch: Stopwatch | None = None,
        most_motions: int | None = None,
        deadline: float = math.inf,
    ) -> None:
        self.world, self.configurations, self.edges = world, configurations, edges
        self.node_states = np.full(len(configurations), UNKNOWN)
        self.edge_states = np.full(len(edges), UNKNOWN)
        self.configurations_checked = self.motions_checked = 0
        self.watch = Stopwatch() if watch is None else watch
        self.most_motions, self.deadline = most_motions, deadline

    def ask_nodes(self, nodes: npt.NDArray[np.integer]) -> None:
        """Ask the world about those of the nodes that are not known yet."""
        unknown = nodes[self.node_states[nodes] == UNKNOWN]
        if unknown.size:
            with self.watch("validity"):
                free = self.world.valid(self.configurations[unknown])
            self.node_states[unknown] = np.where(free, FREE, BLOCKED)
            self.configurations_checked += len(unknown)

    def ask_edges(self, edges: npt.NDArray[np.integer]) -> None:
        """Ask the world about those of the edges that are not known yet, as many as the budget allows.

        Raises
        ------
        BudgetSpent
            If there were more of them; what was asked is kept.
        """
        unknown = edges[self.edge_states[edges] == UNKNOWN]
        wanted = len(unknown)
        if wanted and time.perf_counter() >= self.deadline:
            raise BudgetSpent
        if self.most_motions is not None:
            unknown = unknown[: self.most_motions - self.motions_checked]
        if unknown.size:
            pairs = self.edges[unknown]
            a, b = self.configurations[pairs[:, 0]], self.configurations[pairs[:, 1]]
            with self.watch("motions"):
                free = self.world.motion_valid(a, b)
            self.edge_states[unknown] = np.where(free, FREE, BLOCKED)
            self.motions_checked += len(unknown)
        if len(unknown) < wanted:
            raise BudgetSpent

    def open_edges(self) -> npt.NDArray[np.int32]:
        """Return the edges that are not known to be blocked, nor their nodes, shape (m', 2)."""
        open_nodes = (self.node_states[self.edges] != BLOCKED).all(axis=1)
        return self.edges[open_nodes & (self.edge_states != BLOCKED)]
