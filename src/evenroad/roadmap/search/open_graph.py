"""A graph of milestones that any start and goal can be linked to, one pair after the other."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.search.graph import Graph


class OpenGraph:
    """A fixed graph with room for a start, node n, and a goal, node n + 1.

    Every milestone keeps one slot for a link to the goal, and the start a row for links to all; searches go from
    the start to the goal, so the ways back are not needed.

    Attributes
    ----------
    milestones, base : int
        Number of fixed nodes and of fixed edges.
    in_use : int
        Number of edges, fixed ones and those of the present links.
    edges : ndarray of int32, shape (base + 2 n + 1, 2)
        The fixed edges, then room for links.
    graph : Graph
        What to search.
    """

    def __init__(self, milestones: int, edges: npt.NDArray[np.int32]) -> None:
        n = self.milestones = milestones
        self.base = self.in_use = len(edges)
        spare = np.ones(n + 2, dtype=np.int64)
        spare[n], spare[n + 1] = n + 1, 0
        fixed = Graph.of(n + 2, edges, spare)
        self.edges = np.zeros((self.base + 2 * n + 1, 2), dtype=np.int32)
        self.edges[: self.base] = edges
        self.graph = Graph(self.edges, fixed.first, fixed.other, fixed.edge)
        self._to_goal = fixed.first[1 : n + 1] - 1
        self.graph.other[self._to_goal] = n + 1

    def link(
        self, start_links: npt.NDArray[np.int32], goal_links: npt.NDArray[np.int32]
    ) -> npt.NDArray[np.int64]:
        """Link start and goal to these milestones, and to one another; return the numbers of the links."""
        n, graph = self.milestones, self.graph
        from_start = graph.first[n]
        graph.edge[self._to_goal] = -1
        graph.edge[from_start:] = -1
        count = len(start_links) + len(goal_links) + 1
        links = self.base + np.arange(count)
        of_start, of_goal = links[: len(start_links)], links[len(start_links) : -1]
        self.edges[of_start, 0], self.edges[of_start, 1] = start_links, n
        self.edges[of_goal, 0], self.edges[of_goal, 1] = goal_links, n + 1
        self.edges[links[-1]] = n, n + 1
        row = slice(from_start, from_start + len(start_links) + 1)
        graph.other[row] = np.append(start_links, n + 1)
        graph.edge[row] = np.append(of_start, links[-1])
        graph.edge[self._to_goal[goal_links]] = of_goal
        self.in_use = self.base + count
        return links
