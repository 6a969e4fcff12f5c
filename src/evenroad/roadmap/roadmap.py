"""Roadmaps: points and the edges between them, for all worlds of a space; and a roadmap in one world, which plans."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._npz import Path
from evenroad._shared import OwnLock
from evenroad._time_limit import BudgetSpent, within
from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import answer, connected, out_of_time, refusal, shown_apart
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.connector import Connector, Smooth
from evenroad.roadmap.neighbours import Surroundings, nearest_of
from evenroad.roadmap.problem import Problem
from evenroad.roadmap.query import BOUND, LINKS, EdgeCost, Query, as_start_and_goals, edge_costs
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import Rule
from evenroad.roadmap.search import (
    BLOCKED,
    FREE,
    UNKNOWN,
    EdgeStates,
    FixedPoint,
    Graph,
    SearchProblem,
    StateCache,
    graph_of,
)
from evenroad.space import Space
from evenroad.world import World


class EdgeWeights(NamedTuple):
    """Edge weights of a roadmap, as integers (m,) of a unit that is large enough for nearly all links."""

    longest: float
    unit: FixedPoint
    weights: Ints


@dataclass(frozen=True, eq=False, repr=False)
class Roadmap:
    """Milestones and edges for any world of one space, made by ``er.build_roadmap``; never changed.

    The rule joins all points, valid or not.  Invalid ones take some of the k neighbours, so a larger k than in `plan`
    is wise: 20 rather than 10.

    Attributes
    ----------
    points : PointSet
        Points of the unit cube of the space.
    rule : Rule
        Which milestones are joined.
    milestones : ndarray, shape (n, dim)
        Their configurations, read-only.
    edges : ndarray of int32, shape (m, 2)
        Pairs of milestones that are joined, smaller row first, ascending; read-only.
    space : Space, optional
        None in a roadmap from a file: the first world sets it.
    measured : ndarray, shape (m,), optional
        Lengths of the edges, if they were read from a file.
    """

    points: PointSet
    rule: Rule
    milestones: Floats
    edges: Ints32
    space: Space | None = None
    measured: Floats | None = None

    def __repr__(self) -> str:
        return f"Roadmap({len(self.milestones)} milestones, {len(self.edges)} edges, {self.rule})"

    @cached_property
    def lengths(self) -> Floats:
        """Lengths of the edges in the metric of the space, (m,), measured on first use; read-only."""
        if self.measured is not None:
            return self.measured
        assert self.space is not None
        lengths = edge_costs(self.space, self.milestones, self.edges)
        lengths.setflags(write=False)
        return lengths

    def __getstate__(self) -> dict[str, Any]:
        """Return what is sent to another process, which makes a graph of its own."""
        return {name: value for name, value in self.__dict__.items() if name != "graph"}

    @cached_property
    def graph(self) -> Graph:
        """The edges by node."""
        return graph_of(len(self.milestones), self.edges)

    @cached_property
    def surroundings(self) -> Surroundings:
        """The milestones, with a query for those near a configuration."""
        assert self.space is not None
        return Surroundings(self.milestones, self.space)

    @cached_property
    def edge_weights(self) -> EdgeWeights:
        """The edge weights where costs are lengths."""
        return self.weighted(self.lengths)

    def weighted(self, costs: Floats) -> EdgeWeights:
        """Return the edge weights for these costs, (m,)."""
        n = len(self.milestones)
        # Two milestones are at most this far apart.
        across = 2.0 * float(self.surroundings.distances(self.milestones[0]).max()) if n else 0.0
        longest = max(float(costs.max(initial=0.0)), across)
        unit = FixedPoint.of(longest, n + 2)
        return EdgeWeights(longest, unit, unit.weights(costs))

    def within(self, world: World, *, edge_cost: EdgeCost | None = None) -> WorldRoadmap:
        """Return a planner in a world, for many queries.  It keeps the result of every check; threads may share it.

        Parameters
        ----------
        world : World
            Milestones are checked now, edges when a query needs them.
        edge_cost : callable, optional
            As in :class:`evenroad.PRM`.

        Raises
        ------
        InvalidValue
            If the world has another space: the points, or the distances, differ there.

        Examples
        --------
        >>> import evenroad as er
        >>> world = er.ArmWorld("ur5", "box-reach")
        >>> cell = er.build_roadmap(world, 1024).within(world)
        >>> er.plan(world, "home", "inside", cell).proof
        'certified'
        """
        if not self._fits(world.space):
            raise InvalidValue(
                f"the roadmap was built for another space than {world.space!r}: other joints, other limits or another"
                " metric; build it in a world of this space"
            )
        roadmap = replace(self, space=world.space) if self.space is None else self
        return WorldRoadmap(roadmap, world, edge_cost=edge_cost)

    def _fits(self, space: Space) -> bool:
        if space is self.space or space == self.space:
            return True
        if (space.dim, space.cube_dim) != (self.milestones.shape[1], self.points.d):
            return False
        a, b = self.milestones[self.edges[:, 0]], self.milestones[self.edges[:, 1]]
        same_points = np.array_equal(space.from_cube(self.points.points), self.milestones)
        return same_points and np.array_equal(space.distance(a, b), self.lengths)

    def save(self, file: Path) -> None:
        """Write its points, rule, milestones and edges, atomically; ``er.load_roadmap`` reads them.

        Raises BrokenFile if the file cannot be written; an earlier file is then untouched.
        """
        from evenroad.roadmap.npz import save_roadmap

        save_roadmap(file, self)


class WorldRoadmap:
    """A roadmap with a cache of states in one world; made by :meth:`Roadmap.within`.

    A query's answer depends on the roadmap, the world and the query alone: earlier queries only save checks.  Threads
    may share it; their queries are answered one after the other.

    `roadmap` has the milestones and candidate edges, and `world` checks them.
    """

    roadmap: Roadmap

    def __init__(self, roadmap: Roadmap, world: World, *, edge_cost: EdgeCost | None) -> None:
        self.roadmap, self.world, self._edge_cost = roadmap, world, edge_cost
        self._lock = OwnLock()
        # Milestones and edges come first; start, goals and their links go behind them.
        self._configurations, self._edges = roadmap.milestones, roadmap.edges
        self._weights: Ints | None = None
        self._cache = StateCache.nothing(len(self._configurations), len(self._edges))
        if edge_cost is not None:
            # Now, so that an invalid cost is refused here.
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

        Both are joined to one another, to milestones as the rule's :class:`Reach` says, and to as many as `links` says.
        Counts of checks are those of this query; `planner` says who found the path: ``prm lazy``, or ``prm lazy, then
        trees``.

        Parameters
        ----------
        start, goal, search, smooth, links, budget
            As in :func:`plan`, whose errors these are; by default lazily.
        connector : Connector, optional
            Smooths the path, and searches where the roadmap has no path; not with an `edge_cost`.
        """
        query = Query(
            *as_start_and_goals(start, goal, self.world.space),
            search=search,
            smooth=smooth,
            edge_cost=self._edge_cost,
            links=links,
            budget=budget or Budget(),
            connector=connector,
        )
        try:
            with within(query.budget.seconds):
                return self._answered(query, connector)
        except BudgetSpent:
            return out_of_time(Problem(self.world, query.start, query.goals, budget=query.budget))

    def _answered(self, query: Query, connector: Connector | None) -> PlanResult:
        roadmap = self.roadmap
        rule, planner = f"{roadmap.rule} of all points", query.planner
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
            return answer(attempt, searched, roadmap.points.n, keep_graph=False)

    def solve(self, problem: Problem) -> PlanResult:
        """Plan along the roadmap, in its world, as planners of :func:`evenroad.plan` do."""
        start, goals, how = problem.start, problem.goals, dict(budget=problem.budget, smooth=problem.smooth)
        return self.plan(start, goals, connector=problem.connector, **how)  # type: ignore[arg-type]

    def _connect(self, attempt: Attempt, states: EdgeStates, connector: Connector) -> PlanResult | None:
        """Return the result of a connector, or None if it finds nothing."""
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
        """Append start and goals to the milestones, and their links to the edges."""
        roadmap, terminals, space = self.roadmap, attempt.start_and_goals, self.world.space
        distances = [roadmap.surroundings.distances(end) for end in terminals]
        links = self._links(distances, attempt.query)
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

    def _links(self, distances: list[Floats], query: Query) -> Ints32:
        """Return the links of start and goals, (l, 2), from their distances to the milestones."""
        n = len(self.roadmap.milestones)
        reach = self.roadmap.rule.reach(n, self.world.space)
        usable = self._cache.nodes[:n] == FREE
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
        """Return the weights of the edges and then of these links, (l,), and their unit."""
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


def _with_capacity(array: npt.NDArray[Any], kept: int, more: int) -> npt.NDArray[Any]:
    """Return an array with capacity for more rows behind those that are kept: itself, or a longer copy."""
    if len(array) >= kept + more:
        return array
    # Twice the rows, so that few queries have to copy.
    longer = np.zeros((kept + 2 * more, *array.shape[1:]), dtype=array.dtype)
    longer[:kept] = array[:kept]
    return longer
