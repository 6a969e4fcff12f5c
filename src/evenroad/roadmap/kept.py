"""Roadmaps that are kept: built once for a space, asked often in a world."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._shared import OwnLock
from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import answer, connected, refusal, shown_apart
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.connector import Connector
from evenroad.roadmap.neighbours import Surroundings, nearest_of
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.query import BOUND, LINKS, EdgeCost, Query, edge_costs, read_places
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.roadmap.search import (
    BLOCKED,
    FREE,
    UNKNOWN,
    EdgeStates,
    FixedPoint,
    Graph,
    Known,
    SearchProblem,
)
from evenroad.space import Space
from evenroad.world import World


class Prices(NamedTuple):
    """What the edges of a roadmap cost, as integers (m,) of a unit that is large enough for nearly all links."""

    longest: float
    unit: FixedPoint
    weights: Ints


@dataclass(frozen=True, eq=False)
class Roadmap:
    """Milestones and candidate edges for any world of one space; made by :meth:`build`, never changed.

    The rule joins all points, whether a world will find them valid or not; invalid ones fill some of the k places,
    so that a larger k than in `plan` is wise: 20 rather than 10.  `points` are of the unit cube of `space`;
    `configurations`, (n, dim), the milestones in their order; `edges`, (m, 2), pairs of these to try, smaller first,
    ascending; both are read-only.
    """

    space: Space
    points: PointSet
    rule: Rule
    configurations: Floats
    edges: Ints32

    @classmethod
    def build(cls, space: Space, points: PointSet | int, rule: Rule | None = None) -> Roadmap:
        """Join the points (or so many even ones) by the rule, by default ``KNearest(20)``, or 2 d; memory O(m).

        The graphs of the last 64 sets that came from a pool (the bank, or the user's cache) are kept for the process.
        Raises InvalidValue if the points do not have the dimension of the space's cube.
        """
        points = as_points(points, space, rule)
        rule = KNearest(max(20, 2 * space.cube_dim)) if rule is None else rule
        # The sets of a pool come again and again, others hardly ever; a user's own space may not be hashable.
        from_pool = points.origin.replica is not None and isinstance(space, Hashable)
        joined: Callable[..., Any] = _joined_once if from_pool and isinstance(rule, Hashable) else _joined
        return cls(space, points, rule, *joined(space, points, rule))

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the edges in the metric of the space, (m,), measured when first asked for; read-only."""
        lengths = edge_costs(self.space, self.configurations, self.edges)
        lengths.setflags(write=False)
        return lengths

    @cached_property
    def graph(self) -> Graph:
        """The edges by node."""
        return Graph.of(len(self.configurations), self.edges)

    @cached_property
    def surroundings(self) -> Surroundings:
        """The milestones, ready to be asked which of them are near a configuration."""
        return Surroundings(self.configurations, self.space)

    @cached_property
    def prices(self) -> Prices:
        """The lengths as integers."""
        return self.priced(self.lengths)

    def priced(self, costs: Floats) -> Prices:
        """Return such costs of the edges, (m,), as integers."""
        n = len(self.configurations)
        # Two milestones are at most so far apart.
        across = 2.0 * float(self.surroundings.distances(self.configurations[0]).max()) if n else 0.0
        longest = max(float(costs.max(initial=0.0)), across)
        unit = FixedPoint.of(longest, n + 2)
        return Prices(longest, unit, unit.weights(costs))

    def in_world(
        self, world: World, *, lazy_milestones: bool = False, edge_cost: EdgeCost | None = None
    ) -> WorldRoadmap:
        """Return this roadmap in a world, to be asked many queries.

        Nothing is computed or asked for edges until a query needs them, unless there is an `edge_cost`.

        With `lazy_milestones` these are not checked now but where they could lie on a path; starts and goals are then
        joined to the nearest of all milestones, else to the nearest of the valid ones.  An `edge_cost` is as in
        :func:`plan`.  InvalidValue if the world has another space: the points, or the distances, differ there.
        """
        if not self._fits(world.space):
            raise InvalidValue(f"the roadmap was built for {self.space!r}, the world has {world.space!r}")
        return WorldRoadmap(self, world, lazy_milestones=lazy_milestones, edge_cost=edge_cost)

    def _fits(self, space: Space) -> bool:
        if space is self.space or space == self.space:
            return True
        if (space.dim, space.cube_dim) != (self.space.dim, self.space.cube_dim):
            return False
        a, b = self.configurations[self.edges[:, 0]], self.configurations[self.edges[:, 1]]
        same_points = np.array_equal(space.from_cube(self.points.points), self.configurations)
        return same_points and np.array_equal(space.distance(a, b), self.lengths)


class WorldRoadmap:
    """A roadmap with what is known of it in one world; made by :meth:`Roadmap.in_world`.

    A query's answer depends on the roadmap, the world and the query alone, not on what was asked before: earlier
    queries only save checks.  Threads may share it; their queries are answered one after the other.

    `roadmap` has the milestones and candidate edges, `world` is asked about them, and with `lazy_milestones` about
    milestones only where they could lie on a path.
    """

    def __init__(
        self, roadmap: Roadmap, world: World, *, lazy_milestones: bool, edge_cost: EdgeCost | None
    ) -> None:
        self.roadmap, self.world, self.lazy_milestones = roadmap, world, lazy_milestones
        self._edge_cost = edge_cost
        self._lock = OwnLock()
        # Of milestones and edges first; behind them there is room for the start, the goals and their links.
        self._configurations, self._edges = roadmap.configurations, roadmap.edges
        self._weights: Ints | None = None
        self._known = Known.nothing(len(self._configurations), len(self._edges))
        if edge_cost is not None:
            # Now, so that a cost that cannot be one is refused here.
            self._costs = edge_costs(world.space, self._configurations, self._edges, edge_cost)
        if not lazy_milestones:
            states = EdgeStates(world, self._configurations, self._edges, known=self._known)
            states.ask_nodes(np.arange(len(self._configurations)))

    @property
    def states(self) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.int8]]:
        """Copies of what is known: of each milestone, (n,), and each edge, (m,): 0 unknown, 1 free, 2 blocked."""
        with self._lock:
            nodes, edges = len(self.roadmap.configurations), len(self.roadmap.edges)
            return self._known.nodes[:nodes].copy(), self._known.edges[:edges].copy()

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
        with self._lock:
            self._known.nodes[: len(node_states)] = node_states
            self._known.edges[: len(edge_states)] = edge_states

    def query(
        self,
        start: npt.ArrayLike,
        goal: npt.ArrayLike,
        *,
        search: str = "lazy",
        success_only: bool = False,
        shorten: bool = True,
        keep_graph: bool = False,
        links: int | None = LINKS,
        connector: Connector | None = None,
        budget: Budget | None = None,
    ) -> PlanResult:
        """Find a short free path from start to goal; what is known is never asked again.

        Both are joined to one another, to milestones as the rule's :class:`Reach` says, and to as many as `links` says.
        Counts of checks are those of this query; `planner` says who found the path: ``prm lazy``, or ``prm lazy, then
        trees``.

        Parameters
        ----------
        start, goal, search, success_only, shorten, links, budget
            As in :func:`plan`, whose errors these are; by default lazily.
        connector : Connector, optional
            Smooths the path, and looks for one where the roadmap has none; not with an `edge_cost`.
        keep_graph : bool
            Put the searched graph into the result, for pictures.
        """
        query = Query(
            *read_places(start, goal, self.world.space),
            search=search,
            success_only=success_only,
            shorten=shorten,
            edge_cost=self._edge_cost,
            links=links,
            budget=budget or Budget(),
            connector=connector,
        )
        roadmap = self.roadmap
        rule, planner = f"{roadmap.rule} of all points", query.planner(self.lazy_milestones)
        with self._lock:
            attempt = Attempt(self.world, query, roadmap.points.origin, rule, planner)
            if (refused := refusal(attempt)) is not None:
                return refused
            with attempt.watch("neighbours"):
                states, problem = self._link(attempt)
            searched = attempt.search(query.find, states, problem)
            if connector is not None and searched.cost is None and not attempt.spent:
                joined = self._connect(attempt, states, connector)
                if joined is not None:
                    return joined
            return answer(attempt, searched, roadmap.points.n, keep_graph=keep_graph)

    def _connect(self, attempt: Attempt, states: EdgeStates, connector: Connector) -> PlanResult | None:
        """Return the result of a connector, or None where it finds nothing."""
        if self._edge_cost is not None or shown_apart(attempt):
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
        """Put start and goals behind the milestones, and their links behind the edges."""
        roadmap, ends, space = self.roadmap, attempt.start_and_goals, self.world.space
        distances = [roadmap.surroundings.distances(end) for end in ends]
        links = self._links(distances, attempt.query)
        n, m = len(roadmap.configurations), len(roadmap.edges)
        nodes, edges = n + len(ends), m + len(links)
        known = self._known = Known(
            _with_room(self._known.nodes, n, len(ends)),
            _with_room(self._known.edges, m, len(links)),
            _with_room(self._known.confirmed, m, len(links)),
        )
        self._configurations = _with_room(self._configurations, n, len(ends))
        self._edges = _with_room(self._edges, m, len(links))
        self._configurations[n:nodes], self._edges[m:edges] = ends, links
        known.nodes[n:nodes], known.edges[m:edges], known.confirmed[m:edges] = FREE, UNKNOWN, False
        q = self._configurations[:nodes]
        weights, unit = self._weigh(edge_costs(space, q, links, self._edge_cost), nodes)
        between = [space.distance(ends, np.broadcast_to(goal, ends.shape)) for goal in ends[1:]]
        to_goal = np.min([np.append(*both) for both in zip(distances[1:], between, strict=True)], axis=0)
        bounds = unit.bounds(to_goal if self._edge_cost is None else BOUND * to_goal)
        graph = roadmap.graph.with_links(nodes, links, m)
        known = Known(known.nodes[:nodes], known.edges[:edges], known.confirmed[:edges])
        states = attempt.states(q, self._edges[:edges], known=known)
        return states, SearchProblem(n, np.arange(n + 1, nodes), graph, weights, bounds)

    def _links(self, distances: list[Floats], query: Query) -> Ints32:
        """Return the links of the start and the goals, at such distances from the milestones, (l, 2)."""
        n = len(self.roadmap.configurations)
        reach = self.roadmap.rule.reach(n, self.roadmap.space)
        usable = np.ones(n, dtype=np.bool_) if self.lazy_milestones else self._known.nodes[:n] == FREE
        links, most = [], query.links_among(n)
        for node, away in enumerate(distances, start=n):
            near = nearest_of(away, usable, reach.k, reach.radius)
            if most:
                near = np.union1d(near, nearest_of(away, usable, most))
            links.append(np.stack([near, np.full(len(near), node)], axis=1))
        goals = np.arange(n + 1, n + len(distances))
        links.append(np.stack([np.full(len(goals), n), goals], axis=1))
        return np.concatenate(links).astype(np.int32)

    def _weigh(self, links: Floats, nodes: int) -> tuple[Ints, FixedPoint]:
        """Return the costs of the edges and then of these links, (l,), as integers, and their unit."""
        prices, m = self._prices, len(self.roadmap.edges)
        unit = FixedPoint.of(max(prices.longest, float(links.max())), nodes)
        if unit != prices.unit:
            costs = self.roadmap.lengths if self._edge_cost is None else self._costs
            return unit.weights(np.concatenate([costs, links])), unit
        self._weights = _with_room(prices.weights if self._weights is None else self._weights, m, len(links))
        self._weights[m : m + len(links)] = unit.weights(links)
        return self._weights[: m + len(links)], unit

    @cached_property
    def _prices(self) -> Prices:
        return self.roadmap.prices if self._edge_cost is None else self.roadmap.priced(self._costs)


def _with_room(array: npt.NDArray[Any], kept: int, more: int) -> npt.NDArray[Any]:
    """Return an array with room for so many rows behind those that are kept: itself, or a longer copy."""
    if len(array) >= kept + more:
        return array
    # Twice as many, so that few queries have to copy.
    longer = np.zeros((kept + 2 * more, *array.shape[1:]), dtype=array.dtype)
    longer[:kept] = array[:kept]
    return longer


def _joined(space: Space, points: PointSet, rule: Rule) -> tuple[Floats, Ints32]:
    """Return the milestones and the candidate edges, both read-only."""
    configurations = np.array(space.from_cube(points.points), dtype=np.float64)
    edges = rule.edges(configurations, space)
    for array in (configurations, edges):
        array.setflags(write=False)
    return configurations, edges


_joined_once = lru_cache(maxsize=64)(_joined)
