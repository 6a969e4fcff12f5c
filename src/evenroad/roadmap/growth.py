"""A roadmap that grows point by point, and what is known of it."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from evenroad.points.pointset import PointSet
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.cost import EdgeCost, edge_costs
from evenroad.roadmap.plan import question_between_last_two
from evenroad.roadmap.result import Stage
from evenroad.roadmap.rules import Rule
from evenroad.roadmap.search import FREE, BudgetSpent, Ledger, find_lazily
from evenroad.roadmap.search.find import Found
from evenroad.roadmap.search.memory import Memory
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import World

SETTLED = 0.01
"""A path counts as settled when doubling the points has shortened it by no more than this share."""


class Growth:
    """The milestones so far, what is known of them, and the best path."""

    def __init__(
        self,
        world: World,
        ends: npt.NDArray[np.float64],
        rule: Rule,
        edge_cost: EdgeCost | None,
        budget: Budget,
    ) -> None:
        self.world, self.ends, self.rule, self.edge_cost, self.budget = world, ends, rule, edge_cost, budget
        self.deadline = budget.deadline()
        self.watch = Stopwatch()
        self.memory = Memory()
        self.drawn = self.motions_checked = 0
        # Names: 0 and 1 are the ends, point i is i + 2.
        self.names = np.empty(0, dtype=np.int64)
        self.milestones = np.empty((0, world.space.dim))
        self.stages: list[Stage] = []
        self.best: tuple[Found, npt.NDArray[np.float64], Ledger] | None = None
        self.ledger: Ledger

    def take(self, points: PointSet) -> bool:
        """Search with these points, of which the first are known; return whether the budget was enough."""
        self._add_valid(points)
        configurations = np.concatenate([self.milestones, self.ends])
        names = np.concatenate([self.names, [0, 1]])
        with self.watch("neighbours"):
            edges = self.rule.edges(configurations, self.world.space, ends=2)
        most = None if self.budget.checks is None else self.budget.checks - self.motions_checked
        ledger = Ledger(self.world, configurations, edges, self.watch, most, self.deadline)
        self.ledger = ledger
        ledger.node_states[:] = FREE
        found: Found = np.empty(0, dtype=np.int32), np.empty(0, dtype=np.int32)
        enough = True
        with self.watch("search"):
            ledger.edge_states[:] = self.memory.recall(names[edges])
            costs = edge_costs(self.world.space, configurations, edges, self.edge_cost)
            try:
                found = find_lazily(question_between_last_two(ledger, costs), ledger)
            except BudgetSpent:
                enough = False
            self.memory.learn(names[edges], ledger.edge_states)
        self.motions_checked += ledger.motions_checked
        cost = float(np.sum(costs[found[1]])) if found[0].size else None
        if cost is not None and (self.best is None or cost < min(self._costs())):
            self.best = found, costs, ledger
        self.stages.append(Stage(points.n, len(self.milestones), self.motions_checked, cost))
        return enough and time.perf_counter() < self.deadline

    def is_done(self, until: str) -> bool:
        """Return whether the last stage ends the work."""
        if self.best is None or until == "budget":
            return False
        if until == "solved":
            return True
        before = [stage.cost for stage in self.stages[:-1] if stage.cost is not None]
        return bool(before) and min(self._costs()) >= (1.0 - SETTLED) * min(before)

    def _costs(self) -> Iterator[float]:
        return (stage.cost for stage in self.stages if stage.cost is not None)

    def _add_valid(self, points: PointSet) -> None:
        with self.watch("validity"):
            samples = self.world.space.from_cube(points.points[self.drawn :])
            valid = self.world.valid(samples)
        self.names = np.concatenate([self.names, self.drawn + 2 + np.flatnonzero(valid)])
        self.milestones = np.concatenate([self.milestones, samples[valid]])
        self.drawn = points.n
