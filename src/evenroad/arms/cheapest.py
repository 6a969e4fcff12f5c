"""The cheapest of many goals: near ones first, then those that could still be cheaper than what was reached."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.roadmap import Budget, PlanResult
from evenroad.roadmap.answer import connected, gave_up, refusal
from evenroad.roadmap.attempt import Attempt
from evenroad.roadmap.find_path import NO_POINTS, find_path, with_reasons
from evenroad.roadmap.query import AsksApart, Query, read_places
from evenroad.space.path import path_length
from evenroad.world import Connection, ConnectsItself, World

FIRST = (1, 4)
"""Of the nearest goals, so many are tried first."""

MOTIONS = 300
"""After so many motions others are."""

ROUNDS = 4
"""So often, a goal that could be cheaper than the one that was reached is looked for."""

_WORTH_WHILE = 0.98
"""Goals are looked at that are nearer than this share of the path's length."""


def find_cheapest(
    world: World,
    start: Floats,
    goals: Floats,
    *,
    budget: Budget,
    shorten: bool,
    improve: bool,
    apart: AsksApart | None = None,
) -> PlanResult:
    """Plan as `find_path`; of many goals not to the first one that trees happen to meet, but to a cheap one.

    No goal can be cheaper than its distance: once there is a path, only those are looked at that are nearer than it is
    long.
    """
    if improve or len(goals) == 1 or not isinstance(world, ConnectsItself):
        return find_path(world, start, goals, budget=budget, shorten=shorten, improve=improve, apart=apart)
    query = Query(*read_places(start, goals, world.space), shorten=shorten, budget=budget)
    attempt = Attempt(world, query, NO_POINTS, "none", "none")
    attempt.planner = world.planner
    if (refused := refusal(attempt)) is not None:
        return refused
    goals = query.goals[attempt.goals]
    away = world.space.distance(np.broadcast_to(query.start, goals.shape), goals)
    order = np.argsort(away, kind="stable")
    search = _Search(attempt, world, goals)
    with attempt.watch("search"):
        for count in FIRST:
            if search.reach(order[:count]):
                break
        left = set(order.tolist())
        for _ in range(ROUNDS):
            if search.best is None:
                break
            left.discard(search.last)
            nearer = [k for k in order.tolist() if k in left and away[k] < _WORTH_WHILE * search.cost]
            if not (nearer and search.reach(np.array(nearer))):
                break
    if search.best is not None:
        return connected(attempt, replace(search.grown, path=search.best.path, goal=search.best.goal))
    if (rest := attempt.left()) is None:
        return with_reasons(world, gave_up(attempt, search.grown))
    return find_path(world, start, query.goals, budget=rest, shorten=shorten, apart=apart)


class _Search:
    """What was reached so far, and at what cost."""

    def __init__(self, attempt: Attempt, world: ConnectsItself, goals: Floats) -> None:
        self.attempt, self.world, self.goals = attempt, world, goals
        self.best: Connection | None = None
        self.cost, self.last = np.inf, -1
        self.grown = Connection(goals[:0], -1, 0, 0, 0)

    def reach(self, rows: Ints) -> bool:
        """Try some goals for a short while; return whether one was reached, and keep its path if it is the best."""
        attempt, world = self.attempt, self.world
        if (left := attempt.left()) is None:
            return False
        most = MOTIONS if left.motions is None else min(MOTIONS, left.motions)
        seconds = 1e8 if left.seconds is None else min(left.seconds, 1e8)
        found = world.connect(attempt.query.start, self.goals[rows], most_motions=most, seconds=seconds)
        self.grown = replace(
            found,
            nodes=self.grown.nodes + found.nodes,
            configurations=self.grown.configurations + found.configurations,
            motions=self.grown.motions + found.motions,
        )
        attempt.motions_checked += found.motions
        if found.goal < 0:
            return False
        path = world.shorten(found.path)[0] if attempt.query.shorten else found.path
        self.last = int(rows[found.goal])
        if (cost := path_length(path, world.space)) < self.cost:  # type: ignore[attr-defined]
            self.cost, self.best = cost, replace(found, goal=self.last)
        return True
