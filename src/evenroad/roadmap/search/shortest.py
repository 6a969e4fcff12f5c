"""The shortest path by A* (Hart, Nilsson and Raphael 1968), over integer lengths.

With floats, two paths over the same lengths can differ in the last bit by the order of their edges.  The shortest one
then depends on the edges that were searched.  With integer lengths, and ties to the lower node, the shortest path is
unique, so that a lazy search and a full one find the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._native import roadmap as native
from evenroad._native.roadmap import Graph as Graph
from evenroad.roadmap.search.edge_states import FREE, States


class Found(NamedTuple):
    """The nodes of a path, start first, and its edges; both are empty if there is none.

    `reached` are the nodes of the tree, for searches that grow one.
    """

    nodes: Ints32
    edges: Ints32
    reached: int | None = None


NOT_FOUND = Found(np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32))
MOST = 1 << 61
"""Largest bound. Its sum with any path's length is still a 64-bit integer."""
_NEXT_TO_ZERO = 1e-280
"""Smallest value of the longest length. A quantum for a shorter one would lose its digits, or be 0."""


@dataclass(frozen=True)
class FixedPoint:
    """Lengths as integer multiples of a quantum, such that every path fits into 61 bits.

    The quantum is ``longest / 2^bits`` with up to 52 bits.  Below 512 nodes it is as fine as floats are for the longest
    edge.  It is one bit coarser with each doubling of the graph (2^-41 of the longest edge at a million nodes).
    """

    quantum: float

    @classmethod
    def of(cls, longest: float, nodes: int) -> FixedPoint:
        """Return the quantum for paths of up to `nodes` edges, none above `longest`."""
        bits = min(52, 61 - max(nodes, 1).bit_length())
        # If all lengths are zero or nearly so, any quantum works.
        return cls(longest / 2.0**bits if longest > _NEXT_TO_ZERO else 1.0)

    def weights(self, lengths: Floats) -> Ints:
        """Return lengths rounded up, at least 1, so that no cycle is free."""
        return np.maximum(np.ceil(lengths / self.quantum), 1.0).astype(np.int64)

    def bounds(self, distances: Floats) -> Ints:
        """Return lower bounds, rounded down by a little more than the rounding of a distance."""
        within = np.minimum(distances, self.quantum * MOST)
        least = np.floor(within / self.quantum * (1.0 - 2.0**-45)) - 2.0
        return np.clip(least, 0.0, float(MOST)).astype(np.int64)


@dataclass(frozen=True, eq=False)
class Terminals:
    """The node of the start and those of the goals, (g,)."""

    start: int
    goals: Ints

    @classmethod
    def last(cls, nodes: int, goals: int) -> Terminals:
        """Return terminals that are the last nodes: the start and then this number of goals."""
        return cls(nodes - goals - 1, np.arange(nodes - goals, nodes))


@dataclass(frozen=True, eq=False)
class SearchProblem(Terminals):
    """A search between terminals of a graph: `weights`, (m,), are lengths of its edges, >= 1 (see `FixedPoint`).

    `bounds`, (nodes,), are lower bounds of the path from each node to the nearest goal.
    """

    graph: Graph
    weights: Ints
    bounds: Ints


def best_path(problem: SearchProblem, edge_states: States, node_states: States) -> Found:
    """Return the one shortest path from start to the nearest goal over nodes and edges that are not `BLOCKED`.

    The goals are joined by edges of length 0 to one virtual node, and the path to that node is the answer.  Among
    equally short paths it is the one that, followed back from there, always goes to the lowest node.  So it depends on
    the graph alone, and does not change when other edges are removed.  A path of unchecked edges that proves to be free
    is therefore the path that a search of the free edges finds.
    """
    costs, states = (problem.weights, problem.bounds), (edge_states, node_states)
    return Found(*native.shortest_path(problem.graph, costs, states, problem.start, problem.goals))


def shortest_path(
    nodes: int, edges: Ints32, lengths: Floats, bounds: Floats, start: int, goal: int
) -> tuple[Ints32, float]:
    """Return the :func:`best_path` over edges, (m, 2), that are all free, and its length.

    `lengths`, (m,), are >= 0, and `bounds`, (nodes,), are consistent lower bounds of the paths to the goal.  If it
    cannot be reached, the path is empty and its length inf.
    """
    unit = FixedPoint.of(float(lengths.max(initial=0.0)), nodes)
    graph, weights, to_goal = graph_of(nodes, edges), unit.weights(lengths), unit.bounds(bounds)
    problem = SearchProblem(start, np.array([goal]), graph, weights, to_goal)
    path, along, _ = best_path(problem, np.full(len(edges), FREE), np.full(nodes, FREE))
    return path, length_along(lengths[along]) if path.size else np.inf


def length_along(lengths: Floats) -> float:
    """Return the sum of the lengths along a path, (p - 1,), added in order from its start."""
    total = 0.0
    for length in lengths.tolist():
        total += length
    return total


def graph_of(nodes: int, edges: Ints32) -> Graph:
    """Return the graph of undirected edges, (m, 2), numbered from 0, without links."""
    return Graph(nodes, np.ascontiguousarray(edges, dtype=np.int32))


def components(nodes: int, edges: Ints32) -> Ints32:
    """Return a label for every node, shape (nodes,): the lowest node of its connected component."""
    label = np.arange(nodes, dtype=np.int32)
    join(label, edges)
    return label


def join(label: Ints32, edges: Ints32) -> None:
    """Join components along edges, in place: `label` holds for every node the lowest node of its component."""
    native.join(label, np.ascontiguousarray(edges, dtype=np.int32))
