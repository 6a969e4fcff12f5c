"""A roadmap in one world: a planner that keeps the result of every check."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._checks import require_known
from evenroad._shared import OwnLock
from evenroad._time_limit import look_at_clock
from evenroad.planning.answer import answer, connected, in_its_time, shown_apart
from evenroad.planning.attempt import Attempt
from evenroad.planning.connector import Connector, Smooth
from evenroad.planning.connectors import connector_of
from evenroad.planning.problem import Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult
from evenroad.planning.terminals import as_start_and_goals
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.edges import BOUND, LINKS, EdgeCost, edge_costs, links_among, require_links
from evenroad.roadmap.neighbours import nearest_of
from evenroad.roadmap.roadmap import EdgeWeights, Roadmap
from evenroad.roadmap.search import (
    BLOCKED,
    FINDERS,
    FREE,
    UNKNOWN,
    EdgeStates,
    FixedPoint,
    SearchProblem,
    StateCache,
)
from evenroad.world import World

Entry = TypeVar("Entry", bound=np.generic)


class WorldRoadmap:
    """A roadmap with a cache of states in one world; made by :meth:`Roadmap.within`.

    A query's answer depends only on the roadmap, the world and the query; earlier queries only save checks.  Threads
    may share it; their queries are answered in sequence.

    `roadmap` has the milestones and candidate edges, and `world` checks them.
    """

    roadmap: Roadmap

    def __init__(self, roadmap: Roadmap, world: World, *, edge_cost: EdgeCost | None) -> None:
        self.roadmap, self.world, self._edge_cost = roadmap, world, edge_cost
        self._lock = OwnLock()
        # Milestones and edges come first; start, goals and their links follow.
        self._configurations, self._edges = roadmap.milestones, roadmap.edges
        self._weights: Ints | None = None
        self._cache = StateCache.nothing(len(self._configurations), len(self._edges))
        if edge_cost is not None:
            # Computed now, so that an invalid cost is refused here.
            self._costs = edge_costs(world.space, self._configurations, self._edges, edge_cost)
        states = EdgeStates(world, self._configurations, self._edges, cache=self._cache)
        states.evaluate_nodes(np.arange(len(self._configurations)))

    @property
    def evaluated(self) -> dict[str, int]:
        """Counts of the milestones and edges that are known to be free or blocked."""
        with self._lock:
            nodes = self._cache.nodes[: len(self.roadmap.milestones)].copy()
            edges = self._cache.edges[: len(self.roadmap.edges)].copy()
        return {
            f"{what}_{state}": int(np.count_nonzero(states == value))
            for what, states in (("milestones", nodes), ("edges", edges))
            for state, value in (("free", FREE), ("blocked", BLOCKED))
        }

    def plan(
        self,
        start: npt.ArrayLike,
        goal: npt.ArrayLike,
        *,
        budget: Budget | None = None,
        smooth: Smooth = True,
        search: str = "lazy",
        links: int | None = LINKS,
        connector: Connector | None = None,
    ) -> PlanResult:
        """Find a short free path from start to goal; nothing is checked twice.

        Both are joined to each other, to the milestones of the rule's :class:`Reach`, and to `links` nearest ones.
        Counts of checks are those of this query.  `planner` names the search that found the path: ``prm lazy``, or
        ``prm lazy, then trees``.

        Parameters
        ----------
        start, goal, search, smooth, links, budget
            As in :func:`plan`, with the same errors; by default lazily.
        connector : Connector, optional
            Smooths the path, and searches if the roadmap has no path; not with an `edge_cost`.
        """
        require_known("search", search, FINDERS)
        require_links(links)
        terminals = as_start_and_goals(start, goal, self.world.space)
        return self._solved(
            Problem(self.world, *terminals, budget=budget or Budget(), smooth=smooth), search, links, connector
        )

    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap in its world, like a planner of :func:`evenroad.plan`."""
        return self._solved(problem, "lazy", LINKS, connector_of(self.world))

    @in_its_time
    def _solved(self, problem: Problem, search: str, links: int | None, connector: Connector | None) -> PlanResult:
        roadmap = self.roadmap
        with self._lock:
            how = f"{roadmap.rule} of all points", connector, self._edge_cost, links
            attempt = Attempt(problem, f"prm {search}", roadmap.points.origin, *how)
            if (refused := refusal(attempt)) is not None:
                return refused
            with attempt.watch("neighbours"):
                states, graph = self._link(attempt)
            searched = attempt.search(FINDERS[search], states, graph)
            if connector is not None and searched.cost is None and not attempt.spent:
                joined = self._connect(attempt, states, connector)
                if joined is not None:
                    return joined
            return answer(attempt, searched, roadmap.points.n, keep_graph=False)

    def _connect(self, attempt: Attempt, states: EdgeStates, connector: Connector) -> PlanResult | None:
        """Return the result of a connector, or None if it finds nothing."""
        if self._edge_cost is not None or shown_apart(attempt) is not None:
            return None
        attempt.motions_checked += states.motions_checked
        connection = attempt.connect(connector)
        if connection.goal < 0:
            attempt.spent = True
            return None
        attempt.planner = f"{attempt.planner}, then {connector.planner}"
        result = connected(attempt, connection)
        return replace(result, counts=result.counts | {"edges_checked": attempt.motions_checked})

    def _link(self, attempt: Attempt) -> tuple[EdgeStates, SearchProblem]:
        """Append start and goals to the milestones, and their links to the edges."""
        roadmap, terminals, space = self.roadmap, attempt.start_and_goals, self.world.space
        distances = [roadmap.surroundings.distances(end) for end in terminals]
        look_at_clock()
        links = self._links(distances, attempt.links)
        n, m = len(roadmap.milestones), len(roadmap.edges)
        nodes, edges = n + len(terminals), m + len(links)
        cache = self._cache = StateCache(
            _with_capacity(self._cache.nodes, n, len(terminals)),
            _with_capacity(self._cache.edges, m, len(links)),
            _with_capacity(self._cache.confirmed, m, len(links)),
        )
        self._configurations = _with_capacity(self._configurations, n, len(terminals))
        self._edges = _with_capacity(self._edges, m, len(links))
        self._configurations[n:nodes], self._edges[m:edges] = terminals, links
        cache.nodes[n:nodes], cache.edges[m:edges], cache.confirmed[m:edges] = FREE, UNKNOWN, False
        q = self._configurations[:nodes]
        weights, unit = self._weigh(edge_costs(space, q, links, self._edge_cost), nodes)
        between = [space.distance(terminals, np.broadcast_to(goal, terminals.shape)) for goal in terminals[1:]]
        to_goal = np.min([np.append(*both) for both in zip(distances[1:], between, strict=True)], axis=0)
        bounds = unit.bounds(to_goal if self._edge_cost is None else BOUND * to_goal)
        graph = roadmap.graph.with_links(nodes, links, m)
        cache = StateCache(cache.nodes[:nodes], cache.edges[:edges], cache.confirmed[:edges])
        states = attempt.states(q, self._edges[:edges], cache=cache)
        return states, SearchProblem(n, np.arange(n + 1, nodes), graph, weights, bounds)

    def _links(self, distances: list[Floats], wanted: int | None) -> Ints32:
        """Return the links of start and goals, (l, 2), from their distances to the milestones."""
        n = len(self.roadmap.milestones)
        reach = self.roadmap.rule.reach(n, self.world.space)
        usable = self._cache.nodes[:n] == FREE
        links, most = [], links_among(n, wanted)
        for node, away in enumerate(distances, start=n):
            near = nearest_of(away, usable, reach.k, reach.radius)
            if most:
                near = np.union1d(near, nearest_of(away, usable, most))
            links.append(np.stack([near, np.full(len(near), node)], axis=1))
        goals = np.arange(n + 1, n + len(distances))
        links.append(np.stack([np.full(len(goals), n), goals], axis=1))
        return np.concatenate(links).astype(np.int32)

    def _weigh(self, links: Floats, nodes: int) -> tuple[Ints, FixedPoint]:
        """Return the weights of the edges, followed by those of these links, (l,), and their unit."""
        edge_weights, m = self._edge_weights, len(self.roadmap.edges)
        unit = FixedPoint.of(max(edge_weights.longest, float(links.max())), nodes)
        if unit != edge_weights.unit:
            costs = self.roadmap.lengths if self._edge_cost is None else self._costs
            return unit.weights(np.concatenate([costs, links])), unit
        self._weights = _with_capacity(edge_weights.weights if self._weights is None else self._weights, m, len(links))
        self._weights[m : m + len(links)] = unit.weights(links)
        return self._weights[: m + len(links)], unit

    @cached_property
    def _edge_weights(self) -> EdgeWeights:
        return self.roadmap.edge_weights if self._edge_cost is None else self.roadmap.weighted(self._costs)


def _with_capacity(array: npt.NDArray[Entry], kept: int, more: int) -> npt.NDArray[Entry]:
    """Return an array with capacity for more rows after those that are kept: the same array, or a longer copy."""
    if len(array) >= kept + more:
        return array
    # Twice the rows, so that few queries must copy.
    longer = np.zeros((kept + 2 * more, *array.shape[1:]), dtype=array.dtype)
    longer[:kept] = array[:kept]
    return longer
