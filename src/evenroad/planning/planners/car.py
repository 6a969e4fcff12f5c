"""CarSearch: trees of curves and a lattice of poses for a car on a map."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from evenroad._arrays import Floats
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._native.drive import CarQuery, Steering
from evenroad._rng import variant_of
from evenroad._time_limit import BudgetSpent, until
from evenroad.driving.car_space import CarSpace, as_pieces, cusps_of
from evenroad.driving.car_world import LARGEST_ANGLE, CarWorld
from evenroad.errors import InvalidValue, shown
from evenroad.planning.answer import failed, in_its_time, shown_apart
from evenroad.planning.attempt import Attempt
from evenroad.planning.make_result import path_message, solution
from evenroad.planning.problem import Problem
from evenroad.planning.refusal import refusal
from evenroad.planning.result import PlanResult, Status
from evenroad.planning.terminals import turns_at_end
from evenroad.roadmap.budget import BEFORE_REASONS

SHORTCUTS, QUICK_SHORTCUTS = 200, 60
"""Largest numbers of shortcuts that are tried, and of those that are with ``smooth="quick"``."""
_BEFORE_PROOFS = (1, True), (4, False)
"""Numbers of rounds of the search before a proof that there is no path, and whether that is a quick one."""
_CELLS_A_ROUND, _MOST_ROUNDS = 15_000, 40
"""Number of cells of a map for which one more round comes before the full proof, which takes the longer the more there
are; and the largest number of such rounds."""
_FEW = 2
"""Number of goals in a region that are searched for before that proof."""
_SAME = 1e-7
"""Largest distance of the end of a path from its goal: rounding, in cells and radians."""


@explains_calls
@dataclass(frozen=True)
class CarSearch:
    """Two trees of curves that grow from start and goal, and a lattice of poses that takes turns with them.

    It is the default for a car on a map, and the only planner for one that drives only forwards.  What is returned is
    proved as it is driven from the start.

    Parameters
    ----------
    cusp_cost : float, optional
        Length that a change between forwards and backwards counts, >= 0, in map units.  Default: the turning radius.
        With a larger one the path has fewer of them and is longer.

    Raises
    ------
    InvalidValue
        If it is no such number.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> from evenroad.planning import CarSearch
    >>> grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    >>> car = grid.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=1.0)
    >>> result = er.plan(car, (2, 2, 0), (4, 2, 0), CarSearch(cusp_cost=2.0))
    >>> result.pieces.tolist(), result.proof
    ([[0.0, 2.0]], 'exact')
    """

    cusp_cost: float | None = None
    seconds: ClassVar[float] = 5.0
    is_directed: ClassVar[bool] = True
    """Whether it plans in spaces whose motions differ from their reverse."""

    def __post_init__(self) -> None:
        if self.cusp_cost is not None:
            require_positive("cusp_cost", self.cusp_cost, or_zero=True, at_most=1e9)

    @in_its_time
    def solve(self, problem: Problem) -> PlanResult:
        """Plan until there is a path, a proof that there is none, or the budget is spent.

        Parameters
        ----------
        problem : Problem
            Of a :class:`evenroad.driving.CarWorld` that is not holonomic.

        Returns
        -------
        PlanResult
            With the `pieces` that are driven; the path is sampled along them, a cell apart.

        Raises
        ------
        InvalidValue
            If the world is another one, or an angle is probably in degrees.
        """
        world, space = problem.world, problem.world.space
        if not isinstance(world, CarWorld) or not isinstance(space, CarSpace):
            raise InvalidValue(f"CarSearch plans for a car on a map, got {shown(world)}")
        _require_radians(problem.start_and_goals)
        attempt = Attempt(problem, "curves")
        if (refused := refusal(attempt)) is not None:
            return refused
        cusp = (space.turning_radius or space.spot) if self.cusp_cost is None else float(self.cusp_cost)
        steering = Steering(space.turning_radius, space.spot, space.reverse, cusp)
        variant, goals = variant_of(problem.rng), attempt.free_goals
        queries = [CarQuery(world.vehicle, steering, problem.start, goal, variant) for goal in goals]
        order = [0]
        if len(goals) > 1:
            lengths = space.distance(np.broadcast_to(problem.start, goals.shape), goals)
            order = np.argsort(lengths, kind="stable").tolist()
        found = _searched(attempt, queries, order)
        return found if isinstance(found, PlanResult) else _result(attempt, queries, found, space)


def _searched(attempt: Attempt, queries: Sequence[CarQuery], order: list[int]) -> int | PlanResult:
    """Return which query found a path first, or the result that there is none."""
    world = attempt.world
    assert isinstance(world, CarWorld), "cars drive in their own world"
    # Of a region there are many goals, and a proof about all of it is worth more than a search to each.
    is_region = bool(attempt.problem.regions)
    for rounds, quickly in _BEFORE_PROOFS:
        more = 0 if quickly else min(world.grid.occupied.size // _CELLS_A_ROUND, _MOST_ROUNDS)
        tried = order[:_FEW] if is_region and quickly else order
        quickly = quickly and not is_region
        with attempt.watch("search"):
            for number in tried:
                if queries[number].search(rounds + more):
                    return number
        if (apart := shown_apart(attempt, quickly=quickly)) is not None:
            return apart
    with attempt.watch("search"), until(attempt.time.part(attempt.began, BEFORE_REASONS)):
        try:
            while True:
                for number in order:
                    if queries[number].search(1):
                        return number
        except BudgetSpent:
            message = (
                f"no path within {attempt.problem.budget.text(samples=False)}: {sum(each.nodes for each in queries)}"
                f" nodes were grown and {sum(each.motions for each in queries)} motions checked; give it more time"
            )
            return failed(attempt, Status.BUDGET_SPENT, message, counts=_counts(queries))


def _result(attempt: Attempt, queries: Sequence[CarQuery], number: int, space: CarSpace) -> PlanResult:
    """Return the result with the path of a query, made shorter if that is wanted."""
    problem, world, query = attempt.problem, attempt.world, queries[number]
    assert isinstance(world, CarWorld), "cars drive in their own world"
    tries = 0 if not problem.smooth else QUICK_SHORTCUTS if problem.smooth == "quick" else SHORTCUTS
    goal = int(attempt.goals[number])
    with attempt.watch("shortcut"), until(attempt.time):
        rows, raw = query.path(tries)
    path = milestones = sampled(problem, space, rows, goal, world.grid.resolution)
    length = raw_length = _length(rows)
    if raw is not rows:
        milestones, raw_length = sampled(problem, space, raw, goal, world.grid.resolution), _length(raw)
    pieces, counts = as_pieces(rows, space), _counts(queries)
    counts["shortcut_motions"] = query.shortcuts
    said = f"{path_message(path, length, goal, len(problem.goals))}, {len(pieces)} pieces and {cusps_of(pieces)} cusps"
    return solution(
        problem,
        path,
        goal,
        raw=milestones,
        cost=length,
        raw_cost=raw_length,
        message=said + turns_at_end(world, path, problem.goals[goal]),
        planner=attempt.planner,
        counts=counts,
        timings=attempt.watch.seconds,
        pieces=pieces,
    )


def sampled(problem: Problem, space: CarSpace, rows: Floats, goal: int, step: float) -> Floats:
    """Return the poses along pieces, (p, 3), from the very start to the very goal, up to whole turns."""
    path = space.steering.poses_along(problem.start, rows, step)
    if len(path) == 1:
        path = np.vstack([path, path])
    x, y, angle = problem.goals[goal].tolist()
    end = path[-1].tolist()
    wanted = x, y, angle + 2.0 * math.pi * round((end[2] - angle) / (2.0 * math.pi))
    if math.dist(end, wanted) > _SAME * max(1.0, abs(x), abs(y), abs(angle)):
        raise AssertionError(
            "the path of a car does not end at its goal: this is a fault of evenroad's, please report it"
        )
    path[-1] = wanted
    path.setflags(write=False)
    return path


def _length(rows: Floats) -> float:
    return float(np.abs(rows[:, 1]).sum())


def _counts(queries: Sequence[CarQuery]) -> dict[str, int]:
    return {
        "nodes": sum(each.nodes for each in queries),
        "configurations_checked": sum(each.poses for each in queries),
        "edges_checked": sum(each.motions for each in queries),
    }


def _require_radians(terminals: Floats) -> None:
    for row, angle in enumerate(terminals[:, 2].tolist()):
        if abs(angle) > LARGEST_ANGLE:
            raise InvalidValue(
                f"the angle of the {'goal' if row else 'start'} must be at most 4 pi in radians, got {angle:g};"
                f" are these degrees? math.radians({angle:g}) is {math.radians(angle):.6g}"
            )
