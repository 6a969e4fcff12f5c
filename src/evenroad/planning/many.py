"""``er.plan_many``: answers to many queries, the same as of ``er.plan``, on all processors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints
from evenroad._call import explains_calls, require_options
from evenroad._checks import as_batch, require_count
from evenroad._native.planning import ManyQueries
from evenroad._rng import RngLike, variant_of
from evenroad._threads import in_order, processors
from evenroad._time_limit import within
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue, shown
from evenroad.planning.connector import Smooth, require_smooth
from evenroad.planning.connectors import RESTART, drivers_of, smoothing_of
from evenroad.planning.many_results import Part, PlanResults, joined
from evenroad.planning.plan import budget_of, plan
from evenroad.planning.planners.trees import TreesGoOn
from evenroad.planning.read_problem import is_world
from evenroad.planning.result import PlanResult
from evenroad.planning.terminals import from_start_to_goal
from evenroad.roadmap.budget import BEFORE_PROOF, Budget
from evenroad.world import World

_SLICE = 0.1
"""Time between two checks for interrupts, and between reports of progress [s]."""


class QueryOptions(TypedDict, total=False):
    """Options of each of many queries, as :func:`evenroad.plan` takes them."""

    seconds: float | None
    limits: Budget | Mapping[str, int] | None
    smooth: Smooth
    rng: RngLike


@explains_calls
def plan_many(
    worlds: World | Sequence[World],
    starts: npt.ArrayLike,
    goals: npt.ArrayLike,
    *,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    **options: Unpack[QueryOptions],
) -> PlanResults:
    """Plan many paths, in one world or each in its own.

    Every answer is that of :func:`evenroad.plan` for this world, start and goal with the same options, unless a query's
    time runs out.  The number of threads does not change it.  Compiled code answers queries of arms, except those that
    are hard or have no path.

    Parameters
    ----------
    worlds : World, or sequence of m Worlds
        One world, or one per query; all have the same number of coordinates.  A world may occur several times.
    starts, goals : array_like, shape (m, dim)
        Configurations.  Row i of both is one query.  If its start or goal is not free, its status says so.
    threads : int, optional
        Number of threads, >= 1.  Default: one a processor.
    progress : callable, optional
        Called a few times a second with the number of queries answered and the number of all.
    **options
        ``seconds=5``, the largest wall time of each query [s], > 0; ``limits``, its other limits; ``smooth=True``; and
        ``rng=0``, the seed of all queries: as :func:`evenroad.plan` takes them.

    Returns
    -------
    PlanResults

    Raises
    ------
    InvalidValue, UnknownName
        If an argument is not one of these; the message names the row.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.ArmWorld("ur5", "box-reach")
    >>> home = world.robot.configuration("home")
    >>> er.plan_many(world, [home] * 2, [(0.5, -1.57, 0, -1.57, 0, 0), (3, 0.5, 0, 0, 0, 0)])
    PlanResults(2 queries: 1 solved, 1 goal_invalid)
    """
    require_options("plan_many", options, QueryOptions)
    different, of = _read_worlds(worlds)
    dim = different[0].space.dim
    first, last = as_batch("starts", starts, dim), as_batch("goals", goals, dim)
    count = len(first)
    if len(last) != count:
        raise InvalidValue(f"starts and goals must have one row a query, got {count} and {len(last)} rows")
    if of is None:
        of = np.zeros(count, dtype=np.int64)
    if len(of) != count:
        raise InvalidValue(f"worlds must be one, or one a query: {count}, got {len(of)}")
    workers = processors() if threads is None else require_count("threads", threads)
    smooth, variant = options.get("smooth", True), variant_of(options.get("rng", 0))
    require_smooth(smooth)
    budget = budget_of(None, options.get("seconds"), options.get("limits"))

    def report(done: int) -> None:
        if progress is not None:
            progress(done, count)

    def query(row: int) -> PlanResult:
        # Another thread may continue a query. Its time is the rest after the first search.
        answer = solved.pathless.get(row)
        spent, planner = (0.0, None) if answer is None else (answer.search_seconds, TreesGoOn(answer))
        rest = None if budget.seconds is None else budget.seconds - spent
        with within(rest):
            return plan(different[of[row]], first[row], last[row], planner, limits=budget, smooth=smooth, rng=variant)

    terminals = np.stack([first, last], axis=1)
    solved = by_compiled_code(different, of, terminals, budget, smooth, variant, min(workers, 1024), report)
    rest, others = np.setdiff1d(np.arange(count), solved.rows), []
    for result in in_order(query, ((row,) for row in rest.tolist()), workers):
        others.append(result)
        report(len(solved.rows) + len(others))
    report(count)
    return joined(tuple(different), of, dim, solved, rest, others)


def _read_worlds(worlds: object) -> tuple[list[World], Ints | None]:
    """Return the different worlds, and the number of the world of each query; None if there is one for all."""
    if is_world(worlds):
        return [worlds], None
    if not isinstance(worlds, Sequence) or isinstance(worlds, str) or not len(worlds):
        raise InvalidValue(
            f"worlds must be a World, such as er.ArmWorld(robot, scene), or several, got {shown(worlds)}"
        )
    numbers: dict[int, int] = {}
    different: list[World] = []
    of = np.empty(len(worlds), dtype=np.int64)
    for row, world in enumerate(worlds):
        if id(world) not in numbers:
            if not is_world(world):
                raise InvalidValue(
                    f"worlds must be Worlds, such as er.ArmWorld(robot, scene); row {row} is {shown(world)}"
                )
            if different and world.space.dim != different[0].space.dim:
                raise InvalidValue(
                    f"worlds must have one number of coordinates, {different[0].space.dim} in row 0; row {row} has"
                    f" {world.space.dim}"
                )
            numbers[id(world)] = len(different)
            different.append(world)
        of[row] = numbers[id(world)]
    return different, of


def by_compiled_code(
    different: list[World],
    of: Ints,
    terminals: Floats,
    budget: Budget,
    smooth: Smooth,
    variant: int,
    threads: int,
    report: Callable[[int], None],
) -> Part:
    """Return the answers of queries of arms, each by one call of compiled code; starts and goals are (m, 2, dim)."""
    dim, is_arm = terminals.shape[2], np.array([isinstance(world, ArmWorld) for world in different])
    rows = np.flatnonzero(is_arm[of])
    arms = [world for world in different if isinstance(world, ArmWorld)]
    smoothing, first = smoothing_of(smooth), RESTART
    seconds = np.inf if budget.seconds is None else budget.seconds
    queries = ManyQueries(
        [world.checker for world in arms],
        [world.roomier.checker if smoothing == "with clearance" else None for world in arms],
        (np.cumsum(is_arm) - 1)[of[rows]],
        np.ascontiguousarray(terminals[rows]).reshape(-1, dim),
        drivers_of(dim, variant),
        first if budget.motions is None else min(first, budget.motions),
        (BEFORE_PROOF * seconds, seconds),
        smoothing,
    )
    while (done := queries.go_on(threads, _SLICE)) < len(rows):
        report(done)
    columns = queries.columns
    solved = columns.solved
    pathless = {int(rows[number]): queries.answer(number) for number in np.flatnonzero(~solved).tolist()}
    counts = np.diff(columns.begins)[solved]
    waypoints, counts = _led(different, of[rows[solved]], columns.waypoints, counts, terminals[rows[solved]])
    return Part(rows[solved], counts, waypoints, columns.lengths[solved], columns.seconds[solved], pathless)


def _led(different: list[World], of: Ints, waypoints: Floats, counts: Ints, terminals: Floats) -> tuple[Floats, Ints]:
    """Return paths that begin at the exact numbers of their starts, and the number of waypoints of each."""
    if not any(world.space.flat.wraps for world in different if isinstance(world, ArmWorld)):
        return waypoints, counts
    paths = [
        from_start_to_goal(different[world].space, path, *pair)
        for world, path, pair in zip(of.tolist(), np.split(waypoints, np.cumsum(counts)[:-1]), terminals, strict=True)
    ]
    return np.concatenate([waypoints[:0], *paths]), np.array([len(path) for path in paths], dtype=np.int64)
