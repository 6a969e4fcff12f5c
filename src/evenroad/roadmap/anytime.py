"""Anytime planning: more and more points of one sequence, on which every check made is used again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count, require_known
from evenroad._clock import now
from evenroad._rng import RngLike
from evenroad.errors import InvalidValue
from evenroad.points.pointset import PointSet
from evenroad.points.samplers import Sampler, make_sampler
from evenroad.roadmap.answer import answer, refusal
from evenroad.roadmap.attempt import Attempt, Searched
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.query import LINKS, EdgeCost, Query, as_points, read_places
from evenroad.roadmap.result import PlanResult, Stage
from evenroad.roadmap.rules import Rule, default_rule
from evenroad.roadmap.search import FREE, UNKNOWN, find_lazily
from evenroad.world import World

UNTIL = ("solved", "settled", "budget")
GROWING = 5
"""Largest dimension in which a lattice that grows was compared with Sobol's points (studies/docs/sequences.md)."""

SETTLED = 0.01
"""A path counts as settled when doubling the points has shortened it by no more than this share."""


def plan_anytime(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    sampler: Sampler | None = None,
    *,
    first: int = 64,
    until: str = "solved",
    links: int | None = LINKS,
    budget: Budget | None = None,
    rng: RngLike = 0,
    rule: Rule | None = None,
    edge_cost: EdgeCost | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Plan with `first` points, then with twice as many, and so on, lazily, until the answer is good enough.

    Each stage finds what ``plan(..., search="lazy")`` finds with its points, but nothing that an earlier stage has
    checked is checked again.  The best path of all stages is the answer.

    Parameters
    ----------
    world, start, goal, rule, edge_cost, shorten, links
        As in :func:`plan`.
    sampler : Sampler, optional
        Whose sets of more points begin with those of fewer; default: ``growing``, which needs 6 % fewer checks of
        motions than scrambled Sobol points, and these from six dimensions on, where it was not tried.
    first : int
        Points of the first stage.
    until : {"solved", "settled", "budget"}
        Stop with the first path, or when a path has become at most 1 % shorter from one stage to the next, or
        only when the budget is spent.
    budget : Budget, optional
        Default: 65536 samples and a minute.
    rng : int or SeedSequence
        For the sampler.

    The status is ``budget_spent`` when there was no path until then; ``stages`` tells how it went.  Counts are those of
    the last stage, checks those of all.  Raises as :func:`plan`, and InvalidValue if the sampler's sets do not begin
    with the smaller ones.
    """
    require_known("until", until, UNTIL)
    first = require_count("first", first)
    rule = default_rule(world.space) if rule is None else rule
    budget = budget or Budget()
    places = read_places(start, goal, world.space)
    query = Query(*places, shorten=shorten, edge_cost=edge_cost, links=links, budget=budget)
    if sampler is None:
        # By name: the module of Sobol's points imports scipy.stats, half a second that nobody else needs.
        sampler = make_sampler("growing" if world.space.cube_dim <= GROWING else "sobol")
    points = _draw(sampler, min(first, budget.samples), world, rng, None)
    attempt = Attempt(world, query, points.origin, str(rule), "prm anytime", grows=True)
    if (refused := refusal(attempt)) is not None:
        return refused
    growth = _Growth(attempt, rule)
    while growth.take(points) and not growth.is_done(until) and points.n < budget.samples:
        points = _draw(sampler, min(2 * points.n, budget.samples), world, rng, points)
    return growth.result(points.n)


class _Growth:
    """A roadmap that grows point by point: the milestones so far, what is known of them, and the best path."""

    def __init__(self, attempt: Attempt, rule: Rule) -> None:
        self.attempt, self.rule, self.pairs, self.drawn = attempt, rule, KnownPairs(), 0
        self.names = np.empty(0, dtype=np.int64)
        self.milestones = np.empty((0, attempt.world.space.dim))
        self.stages: list[Stage] = []
        self.best: Searched | None = None
        self.last: Searched

    def take(self, points: PointSet) -> bool:
        """Search with these points, of which the first are known; return whether the budget was enough."""
        attempt, ends = self.attempt, len(self.attempt.start_and_goals)
        samples = attempt.world.space.from_cube(points.points[self.drawn :])
        valid = attempt.valid(samples)
        # Names of nodes: start and goals are the first, point i comes so many later.
        self.names = np.concatenate([self.names, ends + self.drawn + np.flatnonzero(valid)])
        self.milestones = np.concatenate([self.milestones, samples[valid]])
        self.drawn = points.n
        states = attempt.candidates(self.rule, self.milestones)
        states.node_states[:] = FREE
        with attempt.watch("search"):
            named = np.concatenate([self.names, np.arange(ends)])[states.edges]
            states.edge_states[:] = self.pairs.recall(named)
        self.last = attempt.search(find_lazily, states)
        with attempt.watch("search"):
            self.pairs.learn(named, states.edge_states)
        attempt.motions_checked += states.motions_checked
        cost, checked = self.last.cost, attempt.motions_checked
        if cost is not None and cost < min(self._costs(), default=np.inf):
            self.best = self.last
        self.stages.append(Stage(points.n, len(self.milestones), checked, cost, attempt.elapsed()))
        return not attempt.spent and now() < attempt.deadline

    def is_done(self, until: str) -> bool:
        """Return whether the last stage ends the work."""
        if self.best is None or until == "budget":
            return False
        if until == "solved":
            return True
        before = self._costs()[:-1] if self.last.cost is not None else self._costs()
        return bool(before) and min(self._costs()) >= (1.0 - SETTLED) * min(before)

    def result(self, points: int) -> PlanResult:
        """Return the result: the best path of all stages, with the graph of the last one."""
        self.attempt.spent = True
        result = answer(self.attempt, self.last, points, best=self.best)
        counts = result.counts | {"edges_checked": self.attempt.motions_checked}
        return replace(result, counts=counts, stages=tuple(self.stages))

    def _costs(self) -> list[float]:
        return [stage.cost for stage in self.stages if stage.cost is not None]


class KnownPairs:
    """Verdicts on pairs of names below 2^31, which stay while the numbers of nodes change; memory O(pairs)."""

    def __init__(self) -> None:
        self._states: dict[int, int] = {}

    def recall(self, pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int8]:
        """Return what is known of each pair, (m, 2) -> (m,)."""
        return np.array([self._states.get(key, UNKNOWN) for key in _keys(pairs)], dtype=np.int8)

    def learn(self, pairs: npt.NDArray[np.int64], states: npt.NDArray[np.int8]) -> None:
        """Take note of verdicts, the later one of two; those that are `UNKNOWN` are passed over."""
        new = states != UNKNOWN
        self._states.update(zip(_keys(pairs[new]), states[new].tolist(), strict=True))


def _keys(pairs: npt.NDArray[np.int64]) -> list[int]:
    return (pairs.min(axis=1) << 32 | pairs.max(axis=1)).tolist()


def _draw(sampler: Sampler, n: int, world: World, rng: RngLike, before: PointSet | None) -> PointSet:
    """Draw n points, and make sure that they go on where those `before` ended."""
    points = as_points(sampler.draw(n, world.space.cube_dim, rng=rng), world.space)
    if before is not None and not np.array_equal(points.points[: before.n], before.points):
        raise InvalidValue(
            f"the {n} points of {sampler.name} do not begin with its {before.n} points: growing needs a sequence"
            " (growing, sequence, sobol, halton, uniform) and a seed, not a Generator"
        )
    return points
