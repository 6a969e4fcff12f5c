"""Attempt: the budget, world and counts of one query, which all planners share."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field, replace
from time import perf_counter as now
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Bools, Floats, Ints32
from evenroad._time_limit import BudgetSpent, Deadline, look_at_clock, until
from evenroad.planning.connector import Connection, Connector
from evenroad.planning.problem import Problem
from evenroad.planning.result import NO_POINTS
from evenroad.points.pointset import Origin
from evenroad.roadmap.budget import BEFORE_PROOF, BEFORE_REASONS, Budget, Stopwatch
from evenroad.roadmap.edges import BOUND, EdgeCost, edge_costs, links_among
from evenroad.roadmap.neighbours import Surroundings, nearest_of
from evenroad.roadmap.search import (
    FREE,
    NOT_FOUND,
    EdgeStates,
    Finder,
    Found,
    SearchProblem,
    StateCache,
    Terminals,
    confirm,
    find_any,
    length_along,
    search_problem,
)
from evenroad.world import World

if TYPE_CHECKING:
    from evenroad.roadmap.rules import Rule

NO_LIMIT = 2**31 - 1
"""Number of motions that means no limit."""


@dataclass(frozen=True, eq=False)
class Searched:
    """The states of a graph after a search, and the path with its cost, if there is one."""

    states: EdgeStates
    found: Found = NOT_FOUND
    cost: float | None = None


@dataclass(eq=False)
class Attempt:
    """One search for the path of a problem, by one thread.

    `planner`, `origin`, `rule` and `links` are those of :class:`PlanResult`.  The `connector`, if there is one, smooths
    paths unless edges have another `edge_cost` than their lengths.  `grows` says whether the planner draws its points
    itself, until the budget is spent.  `checked` configurations were checked outside a graph, and `motions_checked`
    motions in earlier graphs; both count for the budget.  `spent` says whether it ran out.  `proof_tried` says whether
    the world has tried to prove that there is no path, or cannot.  `proof_cut` says that there was no time for it.
    `goals` are the rows of the problem's goals, (g,); after `valid_terminals` only the free ones.
    """

    problem: Problem
    planner: str
    origin: Origin = NO_POINTS
    rule: str = "none"
    connector: Connector | None = None
    edge_cost: EdgeCost | None = None
    links: int | None = None
    _: KW_ONLY
    grows: bool = False
    watch: Stopwatch = field(default_factory=Stopwatch)
    checked: int = 0
    motions_checked: int = 0
    spent: bool = False
    proof_tried: bool = False
    proof_cut: bool = False

    def __post_init__(self) -> None:
        self.began = now()
        self.time = Deadline.after(self.problem.budget.seconds)
        self.goals = np.arange(len(self.problem.goals))

    @property
    def world(self) -> World:
        """The world of the problem."""
        return self.problem.world

    @property
    def free_goals(self) -> Floats:
        """The goals that are not known to be blocked, (g, dim)."""
        all_goals = self.problem.goals
        return all_goals if len(self.goals) == len(all_goals) else all_goals[self.goals]

    @property
    def start_and_goals(self) -> Floats:
        """The start, then the goals that are free, (1 + g, dim)."""
        terminals: Floats = self.problem.start_and_goals[np.append(0, 1 + self.goals)]
        return terminals

    def valid_terminals(self) -> Bools:
        """Return which of the start and all goals are free, (1 + g,), and drop the other goals."""
        terminals = self.problem.start_and_goals
        with self.watch("validity"):
            free = self.world.valid(terminals)
        self.checked += len(terminals)
        (self.goals,) = free[1:].nonzero()
        return free

    def valid(self, samples: Floats) -> Bools:
        """Return which of the samples, (n, dim), are known to be free, (n,); the deadline may leave some unknown."""
        states = self.states(samples, np.empty((0, 2), dtype=np.int32))
        try:
            with until(self.search_end()):
                states.evaluate_nodes(np.arange(len(samples)))
        except BudgetSpent:
            self.spent = True
        self.checked += states.configurations_checked
        free: Bools = states.node_states == FREE
        return free

    def candidates(self, rule: Rule, milestones: Floats) -> EdgeStates:
        """Return the graph of milestones, start and goals, with the edges of the rule and the links.

        It has no edges where the time is over before they are found.
        """
        configurations = np.concatenate([milestones, self.start_and_goals])
        edges = np.empty((0, 2), dtype=np.int32)
        with self.watch("neighbours"):
            try:
                edges = self._edges(rule, configurations, len(milestones))
            except BudgetSpent:
                self.spent = True
        return self.states(configurations, edges)

    def _edges(self, rule: Rule, configurations: Floats, n: int) -> Ints32:
        """Return the edges among `n` milestones and the start and goals behind them, (m, 2)."""
        # Imported late: trees have no rule.
        from evenroad.roadmap.rules import ascending

        space, terminals = self.world.space, configurations[n:]
        look_at_clock()
        edges = rule.edges(configurations, space, terminals=len(terminals))
        if not (most := links_among(n, self.links)):
            return edges
        surroundings, usable = Surroundings(configurations[:n], space), np.ones(n, dtype=np.bool_)
        links = []
        for node, end in enumerate(terminals, start=n):
            look_at_clock()
            near = nearest_of(surroundings.distances(end), usable, most)
            links.append(np.stack([near, np.full(len(near), node)], axis=1))
        look_at_clock()
        return ascending(np.concatenate([edges, *links]), len(configurations))

    def states(self, configurations: Floats, edges: Ints32, cache: StateCache | None = None) -> EdgeStates:
        """Return the states of a graph, by default unknown; the rest of the budget serves to evaluate them."""
        most = self.problem.budget.motions
        most = None if most is None else most - self.motions_checked
        return EdgeStates(self.world, configurations, edges, self.watch, most, cache)

    def search(self, find: Finder, states: EdgeStates, graph: SearchProblem | None = None) -> Searched:
        """Find a path that the world confirms, over all edges of `states` or those of a `graph`."""
        space, q, edges = self.world.space, states.configurations, states.edges
        cost, goals = self.edge_cost, len(self.goals)
        with self.watch("search"), until(self.search_end()):
            try:
                if graph is not None or find is find_any:
                    what = graph or Terminals.last(len(q), goals)
                else:
                    look_at_clock()
                    costs, bound = edge_costs(space, q, edges, cost), 1.0 if cost is None else BOUND
                    look_at_clock()
                    what = search_problem(states, costs, goals, bound=bound)
                while not confirm(states, found := find(what, states)):
                    pass
            except BudgetSpent:
                self.spent = True
                return Searched(states)
            if not len(found.nodes):
                return Searched(states, found)
            return Searched(states, found, length_along(edge_costs(space, q, edges[found.edges], cost)))

    def connect(
        self, connector: Connector, variant: int = 0, most: int = NO_LIMIT, goal: int | None = None
    ) -> Connection:
        """Join the start to one of the free goals, or to this one, within the rest of the budget.

        A variant >= 1 searches differently if the connector `varies`.  The search stops after `most` motions.
        """
        start, goals, motions = self.problem.start, self.free_goals, self.problem.budget.motions
        goals = goals if goal is None else goals[goal : goal + 1]
        if motions is not None:
            most = min(most, max(motions - self.motions_checked, 1))
        with self.watch("search"), until(self.search_end()):
            try:
                found = connector.connect(self.world, start, goals, variant=variant, most_motions=most)
            except BudgetSpent:
                found = Connection(np.empty((0, len(start))), -1, 0, 0, 0, spent=True)
        self.motions_checked += found.motions
        return found if goal is None or found.goal < 0 else replace(found, goal=goal)

    def search_end(self) -> Deadline:
        """Return the deadline of a search. It leaves time for a proof that there is no path, and for the reasons."""
        # `isinstance` of a protocol would take as long as a short search.
        is_proof_due = not (self.grows or self.proof_tried) and hasattr(self.world, "apart")
        return self.time.part(self.began, BEFORE_PROOF if is_proof_due else BEFORE_REASONS)

    def take(self, motions: int, seconds: float) -> None:
        """Count the motions and time of an earlier search."""
        self.motions_checked += motions
        self.watch.seconds["search"] = self.watch.seconds.get("search", 0.0) + seconds
        self.began -= seconds
        self.time = Deadline(self.time.at - seconds)

    def elapsed(self) -> float:
        """Return the seconds since the query began."""
        return now() - self.began

    def left(self) -> Budget | None:
        """Return the rest of the budget, or None if it is spent."""
        budget, motions = self.problem.budget, self.problem.budget.motions
        seconds = self.time.left
        if seconds <= 0.0 or (motions is not None and motions <= self.motions_checked):
            return None
        return replace(
            budget,
            seconds=None if budget.seconds is None else seconds,
            motions=None if motions is None else motions - self.motions_checked,
        )
