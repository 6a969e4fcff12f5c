"""The frame of all planners: from a query to its result."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from evenroad.points.pointset import Origin
from evenroad.roadmap.cost import BOUND, edge_costs
from evenroad.roadmap.neighbours.find import Surroundings, nearest_of
from evenroad.roadmap.proof import confirm, proof_of
from evenroad.roadmap.query import Query
from evenroad.roadmap.result import PlanResult, SearchedGraph, Status
from evenroad.roadmap.rules import Rule
from evenroad.roadmap.rules.near import ascending
from evenroad.roadmap.search import (
    BLOCKED,
    FREE,
    BudgetSpent,
    EdgeStates,
    Found,
    SearchProblem,
    components,
    length_along,
    search_problem,
)
from evenroad.roadmap.search.edge_states import Known, in_time
from evenroad.roadmap.search.finders import NOT_FOUND
from evenroad.roadmap.shortcut import shortcut
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.space.path import motion_lengths
from evenroad.world import Connection, ConnectsItself, Explains, Rechecks, World

PROVED = "proved: there is no path; start and goal lie in two components of the free space"


@dataclass(frozen=True, eq=False)
class Searched:
    """A graph after a search of it.

    Attributes
    ----------
    states : EdgeStates
        What is known of it; its last nodes are the start and the goals.
    costs : ndarray, shape (m,)
        Of the edges.
    found : Found
        The path, if there is one.
    spent : bool
        Whether the budget was spent before the search had an answer.
    """

    states: EdgeStates
    costs: npt.NDArray[np.float64]
    found: Found
    spent: bool = False

    @property
    def solved(self) -> bool:
        """Whether there is a path."""
        return self.found[0].size > 0


@dataclass(eq=False)
class Attempt:
    """One query on its way to a result; of one thread.

    Attributes
    ----------
    world, query
        Who is asked, and what.
    origin, rule, planner
        As in :class:`PlanResult`.
    goals : ndarray of int64, shape (g,)
        Rows of the query's goals that are free, once `refused` was asked; the others are left out.
    grows : bool
        Whether the planner draws its points itself, until the budget is spent.
    checked : int
        Configurations checked outside of a graph.
    motions_checked : int
        Motions checked in earlier graphs, which count for the budget.
    spent : bool
        Whether the budget was spent too early.
    """

    world: World
    query: Query
    origin: Origin
    rule: str
    planner: str
    grows: bool = False
    watch: Stopwatch = field(default_factory=Stopwatch)
    checked: int = 0
    motions_checked: int = 0
    spent: bool = False

    def __post_init__(self) -> None:
        self.deadline = self.query.budget.deadline()
        self.goals = np.arange(len(self.query.goals))

    @property
    def start_and_goals(self) -> npt.NDArray[np.float64]:
        """The start, then the goals that are free, (1 + g, dim)."""
        return self.query.start_and_goals[np.append(0, 1 + self.goals)]

    def refused(self) -> PlanResult | None:
        """Return the result if the start or all goals are in collision; else None."""
        places = self.query.start_and_goals
        with self.watch("validity"):
            free = self.world.valid(places)
        self.checked += len(places)
        self.goals = np.flatnonzero(free[1:])
        if free[0] and self.goals.size:
            return None
        row, status, name = (
            (1, Status.GOAL_INVALID, "goal") if free[0] else (0, Status.START_INVALID, "start")
        )
        reason = f": {self.world.explain(places[row])}" if isinstance(self.world, Explains) else ""
        if row and len(self.query.goals) > 1:
            return self._result(
                status, f"all {len(self.query.goals)} goals are in collision; the first{reason}"
            )
        return self._result(status, f"the {name} is in collision{reason}")

    def valid(self, samples: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which of the samples, (n, dim), are known to be free, as far as the time allows: (n,)."""
        free = np.zeros(len(samples), dtype=np.bool_)
        with self.watch("validity"):
            try:
                for rows in in_time(np.arange(len(samples)), self.deadline):
                    free[rows] = self.world.valid(samples[rows])
                    self.checked += len(rows)
            except BudgetSpent:
                self.spent = True
        return free

    def candidates(self, rule: Rule, milestones: npt.NDArray[np.float64]) -> EdgeStates:
        """Return the graph of milestones, start and goals: the edges of the rule, and the links that the query adds."""
        space, ends = self.world.space, self.start_and_goals
        configurations = np.concatenate([milestones, ends])
        n = len(milestones)
        with self.watch("neighbours"):
            edges = rule.edges(configurations, space, ends=len(ends))
            if most := self.query.links_among(n):
                surroundings, usable = Surroundings(milestones, space), np.ones(n, dtype=np.bool_)
                near = [nearest_of(surroundings.distances(end), usable, most) for end in ends]
                links = [np.stack([rows, np.full(len(rows), n + i)], axis=1) for i, rows in enumerate(near)]
                edges = ascending(np.concatenate([edges, *links]), len(configurations))
        return self.states(configurations, edges)

    def states(
        self,
        configurations: npt.NDArray[np.float64],
        edges: npt.NDArray[np.int32],
        known: Known | None = None,
    ) -> EdgeStates:
        """Return what is known of a graph (default: nothing), with what is left of the budget for asking more."""
        most = self.query.budget.motions
        most = None if most is None else most - self.motions_checked
        return EdgeStates(self.world, configurations, edges, self.watch, most, self.deadline, known)

    def search(
        self,
        find: Callable[[SearchProblem, EdgeStates], Found],
        states: EdgeStates,
        costs: npt.NDArray[np.float64] | None = None,
        problem: SearchProblem | None = None,
    ) -> Searched:
        """Find a path that the world confirms, over all edges of `states`, or as `problem` says."""
        query = self.query
        with self.watch("search"):
            if costs is None:
                costs = edge_costs(self.world.space, states.configurations, states.edges, query.edge_cost)
            if problem is None:
                bound = 1.0 if query.edge_cost is None else BOUND
                problem = search_problem(states, costs, len(self.goals), bound=bound)
            try:
                while not confirm(states, found := find(problem, states)):
                    pass
            except BudgetSpent:
                self.spent = True
                return Searched(states, costs, NOT_FOUND, spent=True)
        return Searched(states, costs, found)

    def connect(self, world: ConnectsItself) -> Connection:
        """Let the world join the start to one of the free goals, within what is left of the budget."""
        budget = self.query.budget
        with self.watch("search"):
            return world.connect(
                self.query.start,
                self.query.goals[self.goals],
                most_motions=2**31 - 1 if budget.motions is None else budget.motions,
                seconds=max(self.deadline - time.perf_counter(), 1e-3),
            )

    def connected(self, connection: Connection) -> PlanResult:
        """Return the result of a world that found a path by itself."""
        return self._with_path(
            connection.path,
            float(np.sum(motion_lengths(connection.path, self.world.space))),
            int(self.goals[connection.goal]),
            self._counts_of(connection),
            by_world=True,
        )

    def gave_up(self, connection: Connection) -> PlanResult:
        """Return the result of a world that found no path by itself within the budget."""
        counts = self._counts_of(connection)
        message = (
            f"no path within {self.query.budget.text(samples=False)}: {connection.nodes} nodes were grown and"
            f" {connection.motions} motions checked; give it more time"
        )
        return replace(self._result(Status.BUDGET_SPENT, message), counts=counts)

    def proved_apart(self) -> PlanResult:
        """Return the result of a world in which no path can join the start to a goal."""
        return self._result(Status.NOT_CONNECTED, PROVED)

    def left(self) -> float | None:
        """Return the seconds that are left, or None when the time or the motions are spent."""
        left = self.deadline - time.perf_counter()
        return left if left > 0.0 and self.query.budget.motions is None else None

    def _counts_of(self, connection: Connection) -> dict[str, int]:
        return dict(
            nodes=connection.nodes,
            configurations_checked=self.checked + connection.configurations,
            edges_checked=connection.motions,
        )

    def result(
        self,
        searched: Searched,
        points: int,
        *,
        best: Searched | None = None,
        keep_graph: bool = True,
        reached: int | None = None,
    ) -> PlanResult:
        """Return the result of a search over so many points.

        Parameters
        ----------
        searched : Searched
            The search whose graph is counted and kept.
        points : int
            How many were given or drawn.
        best : Searched, optional
            The search whose path is the answer; default: `searched`.
        keep_graph : bool
            Whether the result has a `roadmap`.
        reached : int, optional
            Nodes in the tree, if the planner grew one.
        """
        states = searched.states
        counts = self._counts(states, points)
        graph = searched_graph(states, 1 + len(self.goals)) if keep_graph else None
        best = searched if best is None else best
        if best.solved:
            return self._solved(best, counts, graph)
        message = self._not_connected(states, counts, reached)
        if self.spent:
            limits = self.query.budget.text(samples=self.grows)
            status, message = Status.BUDGET_SPENT, f"no path within {limits}; {message.partition(':')[0]}"
        else:
            status = Status.NOT_CONNECTED
        return replace(self._result(status, message), counts=counts, roadmap=graph)

    def _counts(self, states: EdgeStates, points: int) -> dict[str, int]:
        return dict(
            points=points,
            valid=int(np.count_nonzero(states.node_states[: -1 - len(self.goals)] == FREE)),
            configurations_checked=self.checked + states.configurations_checked,
            edges_considered=len(states.edges),
            edges_checked=states.motions_checked,
            edges_free=int(np.count_nonzero(states.edge_states == FREE)),
        )

    def _solved(
        self,
        searched: Searched,
        counts: dict[str, int],
        graph: SearchedGraph | None,
    ) -> PlanResult:
        nodes, along = searched.found
        states = searched.states
        goal = int(self.goals[int(nodes[-1]) - (len(states.configurations) - len(self.goals))])
        raw = states.configurations[nodes]
        # A disk's paths along a roadmap keep the bits that published rows have.
        by_world = self.query.edge_cost is None and isinstance(self.world, Rechecks)
        cost = length_along(searched.costs, along)
        return self._with_path(raw, cost, goal, counts, by_world=by_world, graph=graph)

    def _with_path(
        self,
        raw: npt.NDArray[np.float64],
        raw_cost: float,
        goal: int,
        counts: dict[str, int],
        *,
        by_world: bool,
        graph: SearchedGraph | None = None,
    ) -> PlanResult:
        """Return the result with a path, shortened if wanted: by the world itself where it can and may."""
        path, length, cost = raw, raw_cost, self.query.edge_cost
        if self.query.shorten:
            with self.watch("shortcut"):
                if by_world and isinstance(self.world, ConnectsItself):
                    path, counts["shortcut_motions"] = self.world.shorten(raw)
                else:
                    path, counts["shortcut_motions"] = shortcut(raw, self.world, cost, self.deadline)
                measure = self.world.space.distance if cost is None else cost
                length = float(np.sum(measure(path[:-1], path[1:])))
        named = "length" if cost is None else "cost"
        to = f" to goal {goal}" if len(self.query.goals) > 1 else ""
        message = f"path of {named} {length:.6g} with {len(path)} waypoints{to}"
        return replace(
            self._result(Status.SOLVED, message),
            goal_index=goal,
            path=path,
            milestone_path=raw,
            proof=proof_of(self.world),
            cost=length,
            milestone_cost=raw_cost,
            counts=counts,
            roadmap=graph,
        )

    def _not_connected(self, states: EdgeStates, counts: dict[str, int], reached: int | None) -> str:
        """Return in words how far start and goals reach, and count it."""
        n, rule = counts["points"], self.rule
        if reached is not None:
            counts["start_component"] = reached - 1
            return (
                f"the tree reached {reached - 1} of {counts['valid']} valid milestones, but not the goal"
                f" (n={n}, {rule}): try n={2 * n} or a larger k"
            )
        start = len(states.node_states) - 1 - len(self.goals)
        goals = np.arange(start + 1, len(states.node_states), dtype=np.int32)
        # The goals are one virtual node.
        edges = np.concatenate([states.open_edges(), np.stack([goals, np.roll(goals, 1)], axis=1)])
        label = components(len(states.node_states), edges)
        open_nodes = states.node_states[:start] != BLOCKED
        for end, name in ((start, "start_component"), (start + 1, "goal_component")):
            counts[name] = int(np.count_nonzero(open_nodes & (label[:start] == label[end])))
        among = f"{counts['valid']} valid milestones"
        if (open_nodes & (states.node_states[:start] != FREE)).any():
            among = f"{int(np.count_nonzero(open_nodes))} milestones not known to be invalid"
        return (
            f"start reaches {counts['start_component']} and goal {counts['goal_component']} of {among},"
            f" and the two components do not meet (n={n}, {rule}): try n={2 * n}{_hint(rule)}"
        )

    def _result(self, status: Status, message: str) -> PlanResult:
        return PlanResult(
            status=status,
            message=message,
            start=self.query.start,
            goals=self.query.goals,
            origin=self.origin,
            rule=self.rule,
            links=self.query.links,
            planner=self.planner,
            seconds=self.watch.seconds,
        )


def searched_graph(states: EdgeStates, ends: int) -> SearchedGraph:
    """Return what is not known to be invalid, with start and goals as the last `ends`, and the free edges."""
    kept = states.node_states != BLOCKED
    number = np.cumsum(kept, dtype=np.int32) - 1
    edges = states.edges[states.edge_states == FREE]
    return SearchedGraph(states.configurations[kept], number[edges].astype(np.int32), int(kept.sum()) - ends)


def _hint(rule: str) -> str:
    """Return what else may help under this rule; under ``complete`` nothing does."""
    if "radius" in rule:
        return " or a larger radius"
    return " or a larger k" if rule.startswith("k") else ""
