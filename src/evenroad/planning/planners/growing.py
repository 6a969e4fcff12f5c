"""Anytime planning: a roadmap with a growing number of points of one sequence; no check is made twice."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from time import perf_counter as now
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._call import explains_calls
from evenroad._checks import require_count, require_known
from evenroad._time_limit import BudgetSpent, seconds_left
from evenroad.errors import InvalidValue
from evenroad.planning.answer import answer, in_its_time
from evenroad.planning.attempt import Attempt, Searched
from evenroad.planning.connectors import connector_of
from evenroad.planning.problem import Interrupted, Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult, Stage
from evenroad.points.pointset import PointSet
from evenroad.roadmap.edges import LINKS, EdgeCost, require_links
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, UNKNOWN, find_lazily

if TYPE_CHECKING:
    from evenroad.points.samplers import Sampler

UNTIL = ("solved", "settled", "budget")
GROWING = 5
"""Largest dimension in which `growing` was compared with Sobol's points (studies/docs/sequences.md)."""

SETTLED = 0.01
"""Largest share by which a settled path gets shorter when the points are doubled."""

LONGER = 3.0
"""Largest ratio of the times to make the graphs of a stage and of the one before."""


@explains_calls
@dataclass(frozen=True)
class GrowingPRM:
    """A lazy roadmap that grows: `first` points of one sequence, then twice as many, until the answer is good.

    Each stage finds the path of ``PRM(points)`` with its points, but makes no check of an earlier stage again.  The
    best path of all stages is the answer.

    Parameters
    ----------
    sampler : Sampler, optional
        Sampler whose larger sets begin with its smaller ones.  Default: ``growing``, which needs 6 % fewer checks
        of motions than scrambled Sobol points; from six dimensions on, which were not measured, Sobol points.
    first : int
        Number of points of the first stage.
    until : {"solved", "settled", "budget"}
        Stop at the first path, or when a stage makes the path at most 1 % shorter, or when the budget is spent.
    rule, edge_cost, links
        As in :class:`evenroad.PRM`.
    informed : bool
        Once there is a path, omit points that no shorter path can pass (Gammell et al. 2014): the sum of their
        distances to start and goal is not less than the path's length.  Stages then find other paths than
        ``PRM(points)``.

    Without a path the status is ``budget_spent``; ``stages`` lists the stages.  Counts are those of the last stage, but
    checks of all.  Errors are those of :class:`evenroad.PRM`, and InvalidValue if the sampler's larger sets do not
    begin with its smaller ones.
    """

    seconds: ClassVar[float] = 5.0

    sampler: Sampler | None = None
    _: KW_ONLY
    first: int = 64
    until: str = "solved"
    rule: Rule | None = None
    edge_cost: EdgeCost | None = None
    links: int | None = LINKS
    informed: bool = False

    def __post_init__(self) -> None:
        require_known("until", self.until, UNTIL)
        require_count("first", self.first)
        require_links(self.links)
        if self.informed and self.edge_cost is not None:
            raise InvalidValue("informed must be False where edge_cost is given: costs may be below distances")

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return the best path of all stages; see :class:`GrowingPRM`."""
        world, budget = problem.world, problem.budget
        rule = default_rule(world.space) if self.rule is None else self.rule
        sampler = self.sampler
        if sampler is None:
            from evenroad.points.samplers import make_sampler

            sampler = make_sampler("growing" if world.space.cube_dim <= GROWING else "sobol")
        points = _draw(sampler, min(self.first, budget.samples), problem, None)
        how = str(rule), connector_of(world), self.edge_cost, self.links
        attempt = Attempt(problem, "prm anytime", points.origin, *how, grows=True)
        if (refused := refusal(attempt)) is not None:
            return refused
        growth = _Growth(attempt, rule, informed=self.informed)
        try:
            while growth.take(points) and not growth.is_done(self.until) and points.n < budget.samples:
                if not growth.has_time():
                    break
                points = _draw(sampler, min(2 * points.n, budget.samples), problem, points)
        except BudgetSpent:
            if not growth.stages:
                raise
        except KeyboardInterrupt:
            if growth.best is None:
                raise
            raise Interrupted(growth.result()) from None
        return growth.result()


class _Growth:
    """A roadmap that grows: the milestones so far, their checked states, and the best path."""

    def __init__(self, attempt: Attempt, rule: Rule, *, informed: bool) -> None:
        self.attempt, self.rule, self.pairs, self.drawn = attempt, rule, PairCache(), 0
        self.informed = informed
        self.names = np.empty(0, dtype=np.int64)
        self.milestones = np.empty((0, attempt.world.space.dim))
        self.stages: list[Stage] = []
        self.best: Searched | None = None
        self.last: Searched
        self.began, self.prepared = now(), 0.0

    def has_time(self) -> bool:
        """Return whether there is time to make the graph of the next stage, of twice as many points."""
        return seconds_left() > LONGER * self.prepared

    def take(self, points: PointSet) -> bool:
        """Search with these points, which begin with earlier ones; return whether the budget was enough.

        Raises BudgetSpent where the time is over before the points are placed; earlier stages stay.
        """
        attempt, terminals = self.attempt, len(self.attempt.start_and_goals)
        samples = attempt.world.space.from_cube(points.points[self.drawn :])
        drawn = now() - self.began
        # Names of nodes: start and goals first, then the points.
        names = terminals + np.arange(self.drawn, points.n)
        if self.best is not None and self.informed:
            kept, new = self._may_shorten(self.milestones), self._may_shorten(samples)
            self.names, self.milestones = self.names[kept], self.milestones[kept]
            names, samples = names[new], samples[new]
        valid = attempt.valid(samples)
        self.names = np.concatenate([self.names, names[valid]])
        self.milestones = np.concatenate([self.milestones, samples[valid]])
        self.drawn = points.n
        began = now()
        states = attempt.candidates(self.rule, self.milestones)
        states.node_states[:] = FREE
        with attempt.watch("search"):
            named = np.concatenate([self.names, np.arange(terminals)])[states.edges]
            states.edge_states[:] = self.pairs.recall(named)
        self.prepared = drawn + now() - began
        self.last = attempt.search(find_lazily, states)
        self.began = now()
        with attempt.watch("search"):
            self.pairs.store(named, states.edge_states)
        attempt.motions_checked += states.motions_checked
        cost, checked = self.last.cost, attempt.motions_checked
        if cost is not None and cost < min(self._costs(), default=np.inf):
            self.best = self.last
        self.stages.append(Stage(points.n, len(self.milestones), checked, cost, attempt.elapsed()))
        return not attempt.spent and not attempt.time.is_over

    def _may_shorten(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), a path shorter than the best may pass: (n,)."""
        assert self.best is not None
        assert self.best.cost is not None
        distance, (start, *goals) = self.attempt.world.space.distance, self.attempt.start_and_goals
        behind = [distance(q, np.broadcast_to(goal, q.shape)) for goal in goals]
        lengths: Floats = distance(np.broadcast_to(start, q.shape), q) + np.min(behind, axis=0)
        return lengths < self.best.cost

    def is_done(self, until: str) -> bool:
        """Return whether the last stage was the final one."""
        if self.best is None or until == "budget":
            return False
        if until == "solved":
            return True
        before = self._costs()[:-1] if self.last.cost is not None else self._costs()
        return bool(before) and min(self._costs()) >= (1.0 - SETTLED) * min(before)

    def result(self) -> PlanResult:
        """Return the result: the best path of all stages, with the graph of the last one."""
        self.attempt.spent = True
        result = answer(self.attempt, self.last, self.stages[-1].points, best=self.best)
        counts = result.counts | {"edges_checked": self.attempt.motions_checked}
        return replace(result, counts=counts, stages=tuple(self.stages))

    def _costs(self) -> list[float]:
        return [stage.cost for stage in self.stages if stage.cost is not None]


class PairCache:
    """States of pairs of nodes, by names below 2^31 that stay when nodes are renumbered; memory O(pairs)."""

    def __init__(self) -> None:
        self._keys, self._states = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int8)

    def recall(self, pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int8]:
        """Return the state of each pair, (m, 2) -> (m,)."""
        keys = _keys(pairs)
        at = np.searchsorted(self._keys, keys)
        known = np.append(self._keys, -1)[at] == keys
        return np.where(known, np.append(self._states, UNKNOWN)[at], UNKNOWN).astype(np.int8)

    def store(self, pairs: npt.NDArray[np.int64], states: npt.NDArray[np.int8]) -> None:
        """Store states of distinct pairs, replacing earlier ones; `UNKNOWN` is ignored."""
        new = states != UNKNOWN
        keys = np.concatenate([_keys(pairs[new]), self._keys])
        self._keys, first = np.unique(keys, return_index=True)
        self._states = np.concatenate([states[new], self._states])[first]


def _keys(pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    keys: npt.NDArray[np.int64] = pairs.min(axis=1) << 32 | pairs.max(axis=1)
    return keys


def _draw(sampler: Sampler, n: int, problem: Problem, before: PointSet | None) -> PointSet:
    """Draw n points; InvalidValue if they do not begin with those `before`."""
    space = problem.world.space
    points = as_points(sampler.draw(n, space.cube_dim, rng=problem.rng), space)
    if before is not None and not np.array_equal(points.points[: before.n], before.points):
        raise InvalidValue(
            f"the {n} points of {sampler.name} do not begin with its {before.n} points: growing needs a sequence"
            " (growing, sequence, sobol, halton, uniform) and a seed, not a Generator"
        )
    return points
