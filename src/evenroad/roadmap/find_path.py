"""A path without a number of points: by the world's own planner where it has one, else with points that grow."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from evenroad.errors import InvalidValue
from evenroad.points.pointset import Origin
from evenroad.roadmap.anytime import plan_anytime
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.result import PlanResult, Status
from evenroad.roadmap.stopwatch import Stopwatch
from evenroad.world import ConnectsItself, Explains, Separates, World

SECONDS = 5.0
"""Wall time of a budget that is not given."""

PROVED = "proved: there is no path; start and goal lie in two components of the free space"


def find_path(
    world: World,
    start: npt.ArrayLike,
    goal: npt.ArrayLike,
    *,
    budget: Budget | None = None,
    shorten: bool = True,
) -> PlanResult:
    """Plan until there is a path, it is proved that there is none, or the budget is spent.

    A world that connects itself plans; where it finds nothing, one that separates components is asked whether there can
    be a path at all; then, and with any other world, points are added until they suffice.

    Parameters
    ----------
    world, start, goal, shorten
        As in :func:`plan`.
    budget : Budget, optional
        Default: five seconds.

    Returns
    -------
    PlanResult
        ``not_connected`` is proved; without path and proof the status is ``budget_spent``.

    Raises
    ------
    InvalidValue
        If start or goal does not have the dimension of the space, or is not finite.
    """
    budget = Budget(seconds=SECONDS) if budget is None else budget
    first, last = (_place(name, value, world.space.dim) for name, value in (("start", start), ("goal", goal)))
    watch = Stopwatch()

    def result(status: Status, message: str, **more: object) -> PlanResult:
        return PlanResult(
            status=status,
            message=message,
            start=first,
            goal=last,
            origin=Origin(family="none", method="no points"),
            rule="none",
            planner="the world's own",
            seconds=watch.seconds,
            **more,  # type: ignore[arg-type]
        )

    with watch("validity"):
        free = world.valid(np.stack([first, last]))
    for is_free, place, name, status in (
        (free[0], first, "start", Status.START_INVALID),
        (free[1], last, "goal", Status.GOAL_INVALID),
    ):
        if not is_free:
            reason = f": {world.explain(place)}" if isinstance(world, Explains) else ""
            return result(status, f"the {name} is in collision{reason}")
    if isinstance(world, ConnectsItself):
        most = 2**31 - 1 if budget.checks is None else budget.checks
        seconds = np.inf if budget.seconds is None else budget.seconds
        with watch("search"):
            connection = world.connect(first, last[np.newaxis], most_motions=most, seconds=seconds)
        counts = dict(
            nodes=connection.nodes,
            configurations_checked=2 + connection.configurations,
            edges_checked=connection.motions,
        )
        if connection.goal >= 0:
            path = connection.path
            raw = float(np.sum(world.space.distance(path[:-1], path[1:])))
            if shorten:
                with watch("shortcut"):
                    path, counts["shortcut_motions"] = world.shorten(path)
            length = float(np.sum(world.space.distance(path[:-1], path[1:])))
            return result(
                Status.SOLVED,
                f"path of length {length:.6g} with {len(path)} waypoints",
                path=path,
                milestone_path=connection.path,
                cost=length,
                milestone_cost=raw,
                counts=counts,
            )
    if isinstance(world, Separates):
        with watch("components"):
            possible = world.may_connect(first, last)
        if not possible:
            return result(
                Status.NOT_CONNECTED,
                PROVED,
            )
    return plan_anytime(world, first, last, budget=budget, shorten=shorten)


def _place(name: str, value: npt.ArrayLike, dim: int) -> npt.NDArray[np.float64]:
    try:
        place = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        place = np.empty(0)
    if place.shape != (dim,) or not np.isfinite(place).all():
        raise InvalidValue(f"{name} must be {dim} finite numbers, got {value!r}")
    return place
