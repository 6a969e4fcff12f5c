"""WorldRoadmap: a roadmap in one world, which remembers what is free over thousands of queries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import UnknownName
from evenroad.roadmap.answer import count, not_connected, searched_graph, solved
from evenroad.roadmap.cost import EdgeCost, edge_costs
from evenroad.roadmap.ends import end_in_collision, read_ends
from evenroad.roadmap.neighbours.newcomer import Surroundings, nearest_of
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.search import BLOCKED, FREE, UNKNOWN, Ledger, Question, Ruler
from evenroad.roadmap.search.find import FINDERS, find_any
from evenroad.roadmap.search.open_graph import OpenGraph
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.roadmap.build import Roadmap


class WorldRoadmap:
    """A roadmap with what is known of it in one world; made by :meth:`Roadmap.in_world`.

    A query's answer depends on the roadmap, the world and the query alone, not on what was asked before: earlier
    queries only save checks.  Not to be shared between threads.

    Attributes
    ----------
    roadmap : Roadmap
        The milestones and candidate edges.
    world : World
        Who is asked about them.
    lazy_milestones : bool
        Whether milestones are checked only where they could lie on a path.
    """

    def __init__(
        self,
        roadmap: Roadmap,
        world: World,
        *,
        lazy_milestones: bool = False,
        edge_cost: EdgeCost | None = None,
    ) -> None:
        self.roadmap, self.world, self.lazy_milestones = roadmap, world, lazy_milestones
        self._edge_cost = edge_cost
        n = len(roadmap.configurations)
        self._graph = OpenGraph(n, roadmap.edges)
        configurations = np.concatenate([roadmap.configurations, np.zeros((2, roadmap.space.dim))])
        self._ledger = Ledger(world, configurations, self._graph.edges)
        if not lazy_milestones:
            self._ledger.ask_nodes(np.arange(n))
        self._surroundings = Surroundings(roadmap.configurations, roadmap.space)
        base = edge_costs(world.space, roadmap.configurations, roadmap.edges, edge_cost)
        self._costs = np.zeros(len(self._graph.edges))
        self._costs[: len(base)] = base
        # Links are not known yet; hardly one is longer than any two milestones can be apart.
        across = self._surroundings.distances(configurations[0]).max(initial=0.0) if n else 0.0
        self._longest = max(float(base.max(initial=0.0)), 2.0 * float(across))
        self._ruler = Ruler.of(self._longest, n + 2)
        self._weights = self._ruler.weights(self._costs)

    @property
    def states(self) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.int8]]:
        """Copies of what is known: of each milestone, (n,), and each edge, (m,): 0 unknown, 1 free, 2 blocked."""
        return self._ledger.node_states[:-2].copy(), self._ledger.edge_states[: self._graph.base].copy()

    @property
    def known(self) -> dict[str, int]:
        """How many milestones and edges are known to be free or blocked so far."""
        nodes, edges = self.states
        return {
            f"{what}_{state}": int(np.count_nonzero(states == value))
            for what, states in (("milestones", nodes), ("edges", edges))
            for state, value in (("free", FREE), ("blocked", BLOCKED))
        }

    def recall(self, node_states: npt.NDArray[np.int8], edge_states: npt.NDArray[np.int8]) -> None:
        """Take over `states` that were found in the same world before; nothing tests that it is the same."""
        self._ledger.node_states[:-2] = node_states
        self._ledger.edge_states[: self._graph.base] = edge_states

    def query(
        self,
        start: npt.ArrayLike,
        goal: npt.ArrayLike,
        *,
        search: str = "lazy",
        success_only: bool = False,
        shorten: bool = False,
        keep_graph: bool = False,
    ) -> PlanResult:
        """Find a short free path from start to goal.

        The two are joined to the milestones as the rule's :class:`Reach` says, and to one another.

        Parameters
        ----------
        start, goal : array_like, shape (dim,)
            Configurations, in the units of the space.
        search, success_only : see :func:`plan`
            By default lazily; what is known is never asked again.
        shorten : bool
            Also shortcut the path, which takes longer than finding it.
        keep_graph : bool
            Put the searched graph into the result, for pictures.

        Returns
        -------
        PlanResult
            Its counts ``edges_checked`` and ``configurations_checked`` are those of this query.

        Raises
        ------
        InvalidValue
            If start or goal are not finite or of another dimension.
        UnknownName
            If there is no such search.
        """
        if search not in FINDERS:
            raise UnknownName.among("search", search, FINDERS)
        ends = read_ends(start, goal, self.world.space.dim)
        name = "any" if success_only else search
        answer: dict[str, Any] = dict(
            start=ends[0],
            goal=ends[1],
            origin=self.roadmap.points.origin,
            rule=f"{self.roadmap.rule} of all points",
            planner=f"prm {name}{' + lazy milestones' if self.lazy_milestones else ''}",
        )
        watch = Stopwatch()
        with watch("validity"):
            free_ends = self.world.valid(ends)
        if not free_ends.all():
            return PlanResult(
                **end_in_collision(free_ends, ends, self.world), **answer, seconds=watch.seconds
            )
        ledger = self._ledger
        ledger.watch = watch
        ledger.configurations_checked = ledger.motions_checked = 0
        with watch("neighbours"):
            question = self._join(ends)
        with watch("search"):
            found = (find_any if success_only else FINDERS[search])(question, ledger)
        counts = count(self.roadmap.points.n, ledger, 2)
        counts["edges_considered"] = self._graph.in_use
        answer["counts"] = counts
        if keep_graph:
            answer["roadmap"] = searched_graph(ledger)
        if not found[0].size:
            return not_connected(ledger, watch, **answer)
        return solved(found, self._costs, ledger, watch, shorten=shorten, cost=self._edge_cost, **answer)

    def _join(self, ends: npt.NDArray[np.float64]) -> Question:
        """Put start and goal into the graph, in place of those of the query before."""
        space, ledger, graph = self.world.space, self._ledger, self._graph
        reach = self.roadmap.rule.reach(graph.milestones, self.roadmap.space)
        usable = np.ones(graph.milestones, dtype=np.bool_)
        if not self.lazy_milestones:
            usable = ledger.node_states[:-2] == FREE
        away = [self._surroundings.distances(end) for end in ends]
        near = [nearest_of(distances, usable, reach.k, reach.radius) for distances in away]
        ledger.configurations[-2:] = ends
        ledger.node_states[-2:] = FREE
        links = graph.link(*near)
        ledger.edge_states[graph.base :] = BLOCKED
        ledger.edge_states[links] = UNKNOWN
        self._costs[links] = edge_costs(space, ledger.configurations, ledger.edges[links], self._edge_cost)
        longest = float(self._costs[links].max())
        ruler, weights = self._ruler, self._weights
        if longest > self._longest:
            ruler = Ruler.of(longest, graph.milestones + 2)
            weights = ruler.weights(self._costs)
        else:
            weights[links] = ruler.weights(self._costs[links])
        apart = space.distance(ends[:1], ends[1:])
        to_goal = np.concatenate([away[1], apart, [0.0]])
        return Question(graph.graph, weights, ruler.bounds(to_goal), graph.milestones, graph.milestones + 1)
