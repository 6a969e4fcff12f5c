"""Roadmaps that are kept: built once for a space, asked often in a world."""

from __future__ import annotations

import threading
from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.roadmap.answer import answer, are_apart, connected, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.cost import BOUND, EdgeCost, edge_costs
from evenroad.roadmap.neighbours.find import Surroundings, nearest_of
from evenroad.roadmap.query import LINKS, Query, as_points, read_places
from evenroad.roadmap.result import PlanResult
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.roadmap.search import BLOCKED, FREE, UNKNOWN, EdgeStates, FixedPoint, Graph, SearchProblem
from evenroad.roadmap.search.edge_states import Known
from evenroad.space import Space
from evenroad.world import ConnectsItself, World


@dataclass(frozen=True, eq=False)
class Roadmap:
    """Milestones and candidate edges for any world of one space; made by :meth:`build`, never changed.

    The rule joins all points, whether a world will find them valid or not; invalid ones fill some of the k places,
    so that a larger k than in `plan` is wise: 20 rather than 10.

    Attributes
    ----------
    space : Space
        Where the milestones are.
    points : PointSet
        Of its unit cube.
    rule : Rule
        Which joined them.
    configurations : ndarray, shape (n, dim)
        The milestones, in the order of the points; read-only.
    edges : ndarray of int32, shape (m, 2)
        Pairs of milestones to try, smaller first, ascending; read-only.
    """

    space: Space
    points: PointSet
    rule: Rule
    configurations: npt.NDArray[np.float64]
    edges: npt.NDArray[np.int32]

    @classmethod
    def build(cls, space: Space, points: PointSet | int, rule: Rule | None = None) -> Roadmap:
        """Join the points (or so many even ones) by the rule, by default ``KNearest(20)``; memory O(m).

        The graphs of the last 64 sets that came from a pool (the bank, or the user's cache) are kept for the process.

        Raises
        ------
        InvalidValue
            If the points do not have the dimension of the space's cube.
        """
        points = as_points(points, space)
        rule = KNearest(20) if rule is None else rule
        # The sets of a pool come again and again, others hardly ever; a user's own space may not be hashable.
        from_pool = points.origin.replica is not None and isinstance(space, Hashable)
        joined: Callable[..., Any] = _joined_once if from_pool and isinstance(rule, Hashable) else _joined
        return cls(space, points, rule, *joined(space, points, rule))

    @cached_property
    def lengths(self) -> npt.NDArray[np.float64]:
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
    def across(self) -> float:
        """A length that hardly any link to a start or goal exceeds: any two milestones are at most so far apart."""
        if not len(self.configurations):
            return 0.0
        return 2.0 * float(self.surroundings.distances(self.configurations[0]).max())

    @cached_property
    def weights(self) -> npt.NDArray[np.int64]:
        """The lengths as integers, (m,); read-only."""
        longest = max(float(self.lengths.max(initial=0.0)), self.across)
        weights = FixedPoint.of(longest, len(self.configurations) + 2).weights(self.lengths)
        weights.setflags(write=False)
        return weights

    def in_world(
        self, world: World, *, lazy_milestones: bool = False, edge_cost: EdgeCost | None = None
    ) -> WorldRoadmap:
        """Return this roadmap in a world, to be asked many queries.

        Nothing is computed or asked for edges until a query needs them, unless there is an `edge_cost`.

        Parameters
        ----------
        world : World
            Of the same space.
        lazy_milestones : bool
            Do not check the milestones now but where they could lie on a path.  Starts and goals are then
            joined to the nearest of all milestones, else to the nearest of the valid ones.
        edge_cost : callable, optional
            As in `plan`.

        Raises
        ------
        InvalidValue
            If the world has another space: the points, or the distances along the edges, differ there.
        """
        self._require_space(world.space)
        return WorldRoadmap(self, world, lazy_milestones=lazy_milestones, edge_cost=edge_cost)

    def _require_space(self, space: Space) -> None:
        if space is self.space or space == self.space:
            return
        if (space.dim, space.cube_dim) == (self.space.dim, self.space.cube_dim):
            a, b = self.configurations[self.edges[:, 0]], self.configurations[self.edges[:, 1]]
            same_points = np.array_equal(space.from_cube(self.points.points), self.configurations)
            if same_points and np.array_equal(space.distance(a, b), self.lengths):
                return
        raise InvalidValue(f"the roadmap was built for {self.space!r}, the world has {space!r}")


class WorldRoadmap:
    """A roadmap with what is known of it in one world; made by :meth:`Roadmap.in_world`.

    A query's answer depends on the roadmap, the world and the query alone, not on what was asked before: earlier
    queries only save checks.  Threads may share it; their queries are answered one after the other.

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
        self._lock = threading.Lock()
        # Of milestones and edges first; behind them there is room for the start, the goals and their links.
        self._configurations, self._edges = roadmap.configurations, roadmap.edges
        self._known = Known.nothing(len(self._configurations), len(self._edges))
        self._priced = False
        if edge_cost is not None:
            # Now, so that a cost that cannot be one is refused here.
            self._costs = edge_costs(world.space, self._configurations, self._edges, edge_cost)
        if not lazy_milestones:
            states = EdgeStates(world, self._configurations, self._edges, known=self._known)
            states.ask_nodes(np.arange(len(self._configurations)))

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_lock"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__ |= state | {"_lock": threading.Lock()}

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
        shorten: bool = False,
        keep_graph: bool = False,
        links: int | None = LINKS,
        connect: bool = True,
        budget: Budget | None = None,
    ) -> PlanResult:
        """Find a short free path from start to goal.

        Both are joined to one another, to milestones as the rule's :class:`Reach` says, and to as many as `links` says.
        Where one of them is cut off from the other, the world joins them itself if it can.

        Parameters
        ----------
        start, goal, search, success_only, links, budget
            As in :func:`plan`; by default lazily.  What is known is never asked again.
        shorten : bool
            Also shortcut the path, which takes longer than finding it.
        connect : bool
            Let a world that connects itself look for a path where the roadmap has none; not with an `edge_cost`.
        keep_graph : bool
            Put the searched graph into the result, for pictures.

        Returns
        -------
        PlanResult
            Its counts ``edges_checked`` and ``configurations_checked`` are those of this query.  `planner` says who
            found the path: ``prm lazy``, or ``prm lazy, then trees``.

        Raises
        ------
        InvalidValue
            If start or goal are not finite or of another dimension.
        UnknownName
            If there is no such search.
        """
        query = Query(
            *read_places(start, goal, self.world.space),
            search=search,
            success_only=success_only,
            shorten=shorten,
            edge_cost=self._edge_cost,
            links=links,
            budget=Budget() if budget is None else budget,
        )
        roadmap = self.roadmap
        rule, planner = f"{roadmap.rule} of all points", query.planner(self.lazy_milestones)
        with self._lock:
            attempt = Attempt(self.world, query, roadmap.points.origin, rule, planner)
            if (refused := refusal(attempt)) is not None:
                return refused
            with attempt.watch("neighbours"):
                states, costs, problem = self._link(attempt)
            searched = attempt.search(query.find, states, costs, problem)
            if connect and not (searched.solved or searched.spent) and isinstance(self.world, ConnectsItself):
                joined = self._connect(attempt, self.world, states)
                if joined is not None:
                    return joined
            return answer(attempt, searched, roadmap.points.n, keep_graph=keep_graph)

    def _connect(self, attempt: Attempt, world: ConnectsItself, states: EdgeStates) -> PlanResult | None:
        """Return the result of the world's own planner, or None where it finds nothing."""
        query = attempt.query
        if query.edge_cost is not None or are_apart(attempt):
            return None
        attempt.motions_checked += states.motions_checked
        connection = attempt.connect(world)
        if connection.goal < 0:
            attempt.spent = True
            return None
        attempt.planner = f"{attempt.planner}, then {world.planner}"
        result = connected(attempt, connection)
        return replace(result, counts=result.counts | {"edges_checked": attempt.motions_checked})

    def _link(self, attempt: Attempt) -> tuple[EdgeStates, npt.NDArray[np.float64], SearchProblem]:
        """Put start and goals behind the milestones, and their links behind the edges."""
        roadmap, ends = self.roadmap, attempt.start_and_goals
        n, m, nodes = len(roadmap.configurations), len(roadmap.edges), len(roadmap.configurations) + len(ends)
        distances = [roadmap.surroundings.distances(end) for end in ends]
        links = self._links(distances, attempt.query)
        self._make_room(nodes, m + len(links))
        q, edges = self._configurations[:nodes], self._edges[: m + len(links)]
        costs, weights = self._costs[: len(edges)], self._weights[: len(edges)]
        q[n:], edges[m:] = ends, links
        known = Known(
            self._known.nodes[:nodes], self._known.edges[: len(edges)], self._known.confirmed[: len(edges)]
        )
        known.nodes[n:], known.edges[m:], known.confirmed[m:] = FREE, UNKNOWN, False
        costs[m:] = edge_costs(self.world.space, q, links, self._edge_cost)
        fixed_point = FixedPoint.of(max(self._longest, float(costs[m:].max())), nodes)
        if fixed_point == self._fixed_point:
            weights[m:] = fixed_point.weights(costs[m:])
        else:
            weights = fixed_point.weights(costs)
        between = [self.world.space.distance(ends, np.broadcast_to(goal, ends.shape)) for goal in ends[1:]]
        to_goal = np.min([np.append(*both) for both in zip(distances[1:], between, strict=True)], axis=0)
        bounds = fixed_point.bounds(to_goal if self._edge_cost is None else BOUND * to_goal)
        graph = roadmap.graph.with_links(nodes, links, m)
        return (
            attempt.states(q, edges, known=known),
            costs,
            SearchProblem(graph, weights, bounds, n, np.arange(n + 1, nodes)),
        )

    def _links(self, distances: list[npt.NDArray[np.float64]], query: Query) -> npt.NDArray[np.int32]:
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

    def _price(self) -> None:
        """Know what the edges of the roadmap cost, before the first query."""
        if self._edge_cost is None:
            self._costs, self._weights = self.roadmap.lengths, self.roadmap.weights
        self._longest = max(float(self._costs.max(initial=0.0)), self.roadmap.across)
        self._fixed_point = FixedPoint.of(self._longest, len(self.roadmap.configurations) + 2)
        if self._edge_cost is not None:
            self._weights = self._fixed_point.weights(self._costs)
        self._priced = True

    def _make_room(self, nodes: int, edges: int) -> None:
        """Have room for so many nodes and edges, and know what the edges of the roadmap cost."""
        roadmap, known = self.roadmap, self._known
        if not self._priced:
            self._price()
        if len(self._configurations) < nodes:
            self._configurations = _lengthened(self._configurations, nodes)
            self._known = known = replace(known, nodes=_lengthened(known.nodes, nodes))
        if len(self._edges) < edges:
            # Twice the links, so that few queries have to copy.
            size = 2 * edges - len(roadmap.edges)
            self._edges = _lengthened(self._edges, size)
            self._costs, self._weights = _lengthened(self._costs, size), _lengthened(self._weights, size)
            self._known = replace(
                known, edges=_lengthened(known.edges, size), confirmed=_lengthened(known.confirmed, size)
            )


def _lengthened(array: npt.NDArray[Any], size: int) -> npt.NDArray[Any]:
    longer = np.zeros((size, *array.shape[1:]), dtype=array.dtype)
    longer[: len(array)] = array
    return longer


def _joined(
    space: Space, points: PointSet, rule: Rule
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """Return the milestones and the candidate edges, both read-only."""
    configurations = np.array(space.from_cube(points.points), dtype=np.float64)
    edges = rule.edges(configurations, space)
    for array in (configurations, edges):
        array.setflags(write=False)
    return configurations, edges


_joined_once = lru_cache(maxsize=64)(_joined)
