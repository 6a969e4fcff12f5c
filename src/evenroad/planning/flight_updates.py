"""Flights among obstacles that move: what remains of a flight is proved again, or a new one takes its place."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from time import perf_counter as now

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_positive
from evenroad._native.flight import FlightQuery
from evenroad._rng import RngLike, variant_of
from evenroad._time_limit import BudgetSpent, within
from evenroad.errors import shown
from evenroad.flight.flight_world import FlightWorld
from evenroad.geometry.pose import Pose
from evenroad.planning.make_result import make_result, solution
from evenroad.planning.planners.flight import searched
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, Status
from evenroad.planning.terminals import as_start_and_goals

_TRIES = 40
"""Number of shortcuts of a new flight: it has to be there within a millisecond or two."""
_SECONDS = 0.02
"""Time after the first round after which a search ends [s]."""


class FlightUpdates:
    """The flight of a ball to its goal among obstacles that move: see :class:`evenroad.Replanner`."""

    def __init__(self, world: FlightWorld, goal: object, rng: RngLike) -> None:
        self.world = world
        _, self._goals = as_start_and_goals(np.zeros(6), goal, world.space)
        self._variant, self._failures = variant_of(rng), 0
        self.path: Floats | None = None
        self.stop: Floats | None = None

    @property
    def goals(self) -> str:
        """The goal, in words."""
        return shown(self._goals[0].tolist())

    def update(
        self,
        q: object,
        moved: Mapping[str, Pose | Sequence[float]] | None,
        velocities: Mapping[str, Sequence[float]] | None,
        elapsed: float,
    ) -> PlanResult:
        """Return the flight from a state, (6,), that is proved from now on, `elapsed` seconds after the last update."""
        began, elapsed = now(), require_positive("elapsed", elapsed, or_zero=True)
        start, _ = as_start_and_goals(q, self._goals, self.world.space)
        positions = {name: at.xyz if isinstance(at, Pose) else at for name, at in (moved or {}).items()}
        self.world = self.world.with_moved(positions, velocities or {}, elapsed)
        result = self._updated(start, elapsed, began)
        self.path = result.path
        stop = self.world.airspace.stop(start)
        self.stop = stop if self.world.validate(stop).all() else None
        return result

    def _updated(self, start: Floats, elapsed: float, began: float) -> PlanResult:
        problem = Problem(self.world, start, self._goals)
        airspace = self.world.airspace
        if self.path is not None and len(rest := airspace.follow(self.path, elapsed, start)):
            goal = int(np.flatnonzero((self._goals == rest[-1]).all(axis=1))[0])
            return solution(problem, rest, goal, planner="kept", timings={"search": now() - began})
        free = self.world.valid(problem.start_and_goals)
        if not free[0] or not free[1:].any():
            status = Status.GOAL_INVALID if free[0] else Status.START_INVALID
            state = start if not free[0] else self._goals[0]
            message = f"the {'goal' if free[0] else 'start'} is in collision: {self.world.explain(state)}"
            return make_result(problem, status, message, timings={"search": now() - began})
        goal = int(np.argmax(free[1:]))
        query = FlightQuery(airspace, start, self._goals[goal], self._variant + self._failures)
        try:
            # The detours of the first round are always finished: those of the next update would be the same.
            if not query.search(1):
                with within(_SECONDS):
                    searched([query], [0])
        except BudgetSpent:
            self._failures += 1
            message = (
                "no flight was found in time: the next update tries another sequence; fly the stop, if there is one"
            )
            return make_result(problem, Status.BUDGET_SPENT, message, timings={"search": now() - began})
        path = query.shorten(_TRIES)
        return solution(problem, path, goal, planner="flight", timings={"search": now() - began})
