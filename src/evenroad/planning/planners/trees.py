"""Planners without a number of points, and the default of each kind of world.

Trees and a search over cells plan until there is a path, a proof that there is none, or the budget is spent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._native.planning import Answer
from evenroad._rng import variant_of
from evenroad._time_limit import seconds_left
from evenroad.errors import InvalidValue
from evenroad.planning.answer import connected, gave_up, in_its_time, shown_apart
from evenroad.planning.attempt import Attempt
from evenroad.planning.connector import Connection, Connector
from evenroad.planning.connectors import ARM_TREES, CELLS, RESTART, ArmTrees, connector_of, trees_for
from evenroad.planning.make_result import path_message, solution
from evenroad.planning.problem import Planner, Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult
from evenroad.roadmap.budget import BEFORE_PROOF
from evenroad.space.path import path_length
from evenroad.world import World

_NOTHING = Connection(np.empty((0, 0)), -1, 0, 0, 0)
"""The connection before the first search."""
TO_NEAREST = 300
"""Largest number of motions checked towards only the nearest of several goals."""


@explains_calls
@dataclass(frozen=True)
class RRTConnect:
    """Two trees that grow from start and goals until they meet (Kuffner and LaValle 2000), along an even sequence.

    Trees of arms are compiled, and every motion is proved free; trees in other worlds check batches of motions.  They
    first grow towards the nearest of several goals, for a short time, then towards all.  If they do not meet soon, a
    world that can prove that there is no path tries to.

    Parameters
    ----------
    improve : bool
        Continue after the first path until the budget is spent, and return the best path.  The count ``rounds`` is
        then the number of plans, and `stages` says when better paths were found.  Trees of arms then grow only where a
        path may be shorter, so that the path converges to the shortest.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.ArmWorld("ur5", "box-reach")
    >>> er.plan(world, "home", "inside", er.RRTConnect()).status
    <Status.SOLVED: 'solved'>
    """

    seconds: ClassVar[float] = 5.0

    improve: bool = False

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return a path, a proof that there is none, or a report of the search; see :class:`RRTConnect`."""
        return solve_by(problem, trees_for(problem.world, shortest=self.improve), improve=self.improve)


@explains_calls
@dataclass(frozen=True)
class GridSearch:
    """A search over the cells of a map for a disk: it is exact, and proves if there is no path.

    The path leads to the goal with the shortest way around obstacles.  With `improve`, a roadmap then grows until the
    budget is spent, to find better paths.

    Raises
    ------
    InvalidValue
        If the world of :meth:`solve` is no disk on a map.
    """

    seconds: ClassVar[float] = 5.0

    improve: bool = False

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return a path, or the proof that there is none; see :class:`GridSearch`."""
        # Imported late, like other planners and worlds here: a plan of an arm needs none of them.
        from evenroad.world.gridmap.disk_world import DiskWorld

        if not isinstance(problem.world, DiskWorld):
            raise InvalidValue(f"GridSearch plans for disks on maps, got {problem.world!r}")
        return solve_by(problem, CELLS, improve=self.improve)


def default_planner(world: World, *, improve: bool = False) -> Planner:
    """Return the default planner of this kind of world."""
    connector = connector_of(world)
    if connector is None:
        from evenroad.constraints.constrained_world import KeptWorld
        from evenroad.driving.car_space import CarSpace

        if isinstance(world.space, CarSpace):
            from evenroad.planning.planners.car import CarSearch

            return CarSearch()
        from evenroad.flight.flight_space import FlightSpace

        if isinstance(world.space, FlightSpace):
            from evenroad.planning.planners.flight import FlightSearch

            return FlightSearch()
        return RRTConnect(improve) if isinstance(world, KeptWorld) else _growing(improve)
    if connector is CELLS:
        return GridSearch(improve)
    return RRTConnect(improve) if improve else _TREES


_TREES = RRTConnect()


def _growing(improve: bool) -> Planner:
    from evenroad.planning.planners.growing import GrowingPRM

    return GrowingPRM(until="budget", informed=True) if improve else GrowingPRM(until="solved")


@dataclass(frozen=True)
class TreesGoOn:
    """Trees of an arm that continue after a first search without a path."""

    first: Answer

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Return the result of `RRTConnect`, which would begin with the same search."""
        return solve_by(problem, ARM_TREES, first=self.first)


def solve_by(
    problem: Problem, connector: Connector, *, improve: bool = False, first: Answer | None = None
) -> PlanResult:
    """Plan with a connector until there is a path, a proof that there is none, or the budget is spent.

    `first` is the answer of the first search, if that is done.
    """
    variant = variant_of(problem.rng)
    if first is None and isinstance(connector, ArmTrees) and len(problem.goals) == 1 and not improve:
        first = _answer(problem, connector, variant)
        if first.ended == "solved":
            return _solved(problem, connector, first)
    attempt = Attempt(problem, connector.planner, connector=connector)
    if (refused := refusal(attempt)) is not None:
        return refused
    connection = _first_path(attempt, connector, variant, first)
    if isinstance(connection, PlanResult):
        return connection
    if connection.goal >= 0 and not improve:
        return connected(attempt, connection)
    if connection.goal >= 0:
        # Imported late: most searches end before.
        from evenroad.planning.improve import improved

        result = connected(attempt, connection)
        return improved(attempt, connector, result, variant)
    if connection.spent or (left := attempt.left()) is None:
        return gave_up(attempt, connection)
    return _growing(improve).solve(replace(problem, budget=left, rng=0))


def _first_path(attempt: Attempt, connector: Connector, variant: int, first: Answer | None) -> Connection | PlanResult:
    """Search until there is a path or the budget is spent, or return the result that there is none.

    `first` is the answer of the first search, if that is done.
    """
    connection, is_tried = _NOTHING, False
    for number, search in enumerate(connector.searches(attempt.world.space.dim)):
        if number == 0 and first is not None:
            counts, is_spent = (first.nodes, first.configurations, first.motions), first.ended == "paused"
            found = Connection(first.raw, -1, *counts, spent=is_spent)
            attempt.take(found.motions, first.search_seconds)
        elif connector.varies:
            found = _connection(attempt, connector, search.most, variant + number)
        else:
            # The same search, with a larger budget.
            attempt.motions_checked -= connection.motions
            connection, found = _NOTHING, _connection(attempt, connector, search.most, variant)
        connection = _after(connection, found)
        if connection.goal >= 0:
            break
        has_ended = found.spent or found.motions < search.most or attempt.left() is None
        proof = "any" if has_ended and not is_tried else search.proof
        if proof != "none" and (apart_for := shown_apart(attempt, quickly=proof == "quick")) is not None:
            return apart_for
        is_tried |= proof == "any"
        if has_ended:
            break
    return connection


def _answer(problem: Problem, connector: ArmTrees, variant: int) -> Answer:
    """Return the answer of one call of compiled code, which suffices for most queries."""
    budget, most = problem.budget, RESTART
    return connector.answer(
        problem.arm,
        problem.start,
        problem.goals[0],
        variant=variant,
        most_motions=most if budget.motions is None else min(most, budget.motions),
        search_seconds=BEFORE_PROOF * seconds_left(),
        smooth=problem.smooth,
    )


def _solved(problem: Problem, connector: Connector, found: Answer) -> PlanResult:
    """Return the result of an answer with a path."""
    world, path, smoothing = problem.world, found.path, found.smoothing_motions
    counts = {"nodes": found.nodes, "configurations_checked": found.configurations, "edges_checked": found.motions}
    timings = {"search": found.search_seconds}
    if problem.smooth:
        counts["shortcut_motions"], timings["shortcut"] = smoothing, found.smoothing_seconds
    length = _length(path, found.length, world)
    return solution(
        problem,
        path,
        raw=found.raw if smoothing else None,
        cost=length,
        raw_cost=_length(found.raw, found.raw_length, world) if smoothing else None,
        message=path_message(path, length, 0, 1, is_cut=found.is_cut),
        planner=connector.planner,
        counts=counts,
        timings=timings,
    )


def _length(path: Floats, native: float, world: World) -> float:
    """Return the length of a path. NumPy sums eight or more numbers in another order, so the last bit may differ."""
    return native if len(path) <= 8 else path_length(path, world.space)


def _connection(attempt: Attempt, connector: Connector, most: int, variant: int) -> Connection:
    """Join the start to a goal, first by trees to the nearest one, because trees to many may meet a far one."""
    if len(attempt.goals) == 1 or not connector.varies:
        return attempt.connect(connector, variant, most)
    start, goals = attempt.problem.start, attempt.free_goals
    nearest = int(np.argmin(attempt.world.space.distance(np.broadcast_to(start, goals.shape), goals)))
    near = attempt.connect(connector, variant, min(most, TO_NEAREST), nearest)
    if near.goal >= 0 or near.spent or attempt.left() is None:
        return near
    found = attempt.connect(connector, variant, most - near.motions)
    return _after(near, found)


def _after(earlier: Connection, found: Connection) -> Connection:
    """Return a connection, with the work of an earlier search without a path added."""
    return replace(
        found,
        nodes=earlier.nodes + found.nodes,
        configurations=earlier.configurations + found.configurations,
        motions=earlier.motions + found.motions,
    )
