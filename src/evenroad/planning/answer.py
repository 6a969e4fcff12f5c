"""Makers of the result that the caller gets from an attempt."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import wraps
from typing import Concatenate, ParamSpec, TypedDict, TypeVar

import numpy as np

from evenroad._arrays import Floats
from evenroad._time_limit import BudgetSpent, is_limited, look_at_clock, require_time_for, until, within
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import EvenroadError, InvalidValue
from evenroad.planning.attempt import Attempt, Searched
from evenroad.planning.connector import Connection
from evenroad.planning.make_result import make_result, out_of_time, path_message, solution
from evenroad.planning.problem import Problem
from evenroad.planning.result import PlanResult, SearchedGraph, Status
from evenroad.planning.shortcut import shortcut
from evenroad.points.pointset import Origin
from evenroad.roadmap.budget import BEFORE_REASONS
from evenroad.roadmap.neighbours import flat_metric
from evenroad.roadmap.search import BLOCKED, FREE, EdgeStates, components
from evenroad.space import Space
from evenroad.space.path import path_length
from evenroad.world import ShowsApart, ValidatesPaths
from evenroad.world.protocol import Apart

Solver = TypeVar("Solver")
More = ParamSpec("More")


def answer(
    attempt: Attempt,
    searched: Searched,
    points: int,
    *,
    best: Searched | None = None,
    keep_graph: bool = True,
) -> PlanResult:
    """Return the result of a search over this number of points, with its graph if that is wanted.

    If another search found a `best` path, that path is the answer.
    """
    states = searched.states
    counts = dict(
        points=points,
        valid=int(np.count_nonzero(states.node_states[: -1 - len(attempt.goals)] == FREE)),
        configurations_checked=attempt.checked + states.configurations_checked,
        edges_considered=len(states.edges),
        edges_checked=states.motions_checked,
        edges_free=int(np.count_nonzero(states.edge_states == FREE)),
    )
    graph = _searched_graph(states, 1 + len(attempt.goals)) if keep_graph else None
    best = searched if best is None else best
    if best.cost is not None:
        nodes, q = best.found.nodes, best.states.configurations
        goal = attempt.goals[nodes[-1] - len(q)]
        # Paths of a disk along a roadmap must stay equal to published results.
        by_connector = attempt.edge_cost is None and isinstance(attempt.world, ValidatesPaths)
        result = _with_path(attempt, q[nodes], best.cost, int(goal), counts, by_connector=by_connector)
        return replace(result, roadmap=graph)
    return replace(_no_path(attempt, searched, points, counts), counts=counts, roadmap=graph)


def _no_path(attempt: Attempt, searched: Searched, points: int, counts: dict[str, int]) -> PlanResult:
    """Return the result of a search that found no path, and add to the counts how far it reached, if there is time."""
    made, limits = f"(n={points}, {attempt.rule})", attempt.problem.budget.text(samples=attempt.grows)
    try:
        so_far, missing = _reach(attempt, searched, counts)
    except BudgetSpent:
        return failed(attempt, Status.BUDGET_SPENT, f"no path within {limits} {made}")
    if attempt.spent:
        return failed(attempt, Status.BUDGET_SPENT, f"no path within {limits}; {so_far} {made}")
    # With the rule ``complete``, only more points help.
    wider = "radius" if "radius" in attempt.rule else "k" if attempt.rule.startswith("k") else ""
    advice = f"try n={2 * points}" + (f" or a larger {wider}" if wider else "")
    with suppress(BudgetSpent):
        advice += _few_directions(attempt, points)
    return failed(attempt, Status.NOT_CONNECTED, f"{so_far}, {missing} {made}: {advice}")


def connected(attempt: Attempt, connection: Connection) -> PlanResult:
    """Return the result of a connector that found a path."""
    path, goal = connection.path, int(attempt.goals[connection.goal])
    length = path_length(path, attempt.world.space)
    return _with_path(attempt, path, length, goal, _counts_of(attempt, connection), by_connector=True)


def in_its_time(
    solve: Callable[Concatenate[Solver, Problem, More], PlanResult],
) -> Callable[Concatenate[Solver, Problem, More], PlanResult]:
    """Return a planner's `solve` that ends with the problem's time, and says so if it has no result by then."""

    @wraps(solve)
    def solved(planner: Solver, problem: Problem, /, *args: More.args, **more: More.kwargs) -> PlanResult:
        if problem.constraints is not None:
            raise InvalidValue("a planner knows no constraints: er.plan(..., constraints=...) divides such a problem")
        try:
            if is_limited():
                # The caller of the planner sets the deadline; the problem has the time that is left.
                return solve(planner, problem, *args, **more)
            with within(problem.budget.seconds):
                return solve(planner, problem, *args, **more)
        except BudgetSpent:
            return out_of_time(problem)

    return solved


def gave_up(attempt: Attempt, connection: Connection) -> PlanResult:
    """Return the result of a connector that found no path within the budget."""
    cut = ", and there was no time for a proof that there is none" if attempt.proof_cut else ""
    message = (
        f"no path within {attempt.problem.budget.text(samples=False)}: {connection.nodes} nodes were grown and"
        f" {connection.motions} motions checked{cut}; give it more time"
    )
    return failed(attempt, Status.BUDGET_SPENT, message, counts=_counts_of(attempt, connection))


def shown_apart(attempt: Attempt, *, quickly: bool = False) -> PlanResult | None:
    """Return the result with its reason if the world finds that no path leads to any goal; else None.

    The status is ``not_connected`` if that is proved.
    """
    with attempt.watch("proof"):
        attempt.proof_tried |= not quickly
        try:
            with until(attempt.time.part(attempt.began, BEFORE_REASONS)):
                found = apart_in(attempt.problem, quickly=quickly)
        except BudgetSpent:
            attempt.proof_cut = True
            return None
    if found is None:
        return None
    status = Status.NOT_CONNECTED if found.proved else Status.BUDGET_SPENT
    return failed(attempt, status, found.message)


def apart_in(problem: Problem, *, quickly: bool = False) -> Apart | None:
    """Return why no path of a problem exists, by a quick or full proof, or None; goal poses allow any posture."""
    world, given = problem.world, problem.given
    if not isinstance(world, ShowsApart):
        return None
    if problem.regions:
        # Imported late: few plans have regions. Their proof takes too long to be a quick one.
        from evenroad.driving.region_goals import apart_from_regions

        return None if quickly else apart_from_regions(world, problem.start, problem.regions)
    if given is None or not isinstance(world, ArmWorld):
        return world.apart(problem.start, problem.goals, quickly=quickly)
    # Imported late: few plans need the proof.
    require_time_for("evenroad.infeasibility.proof")
    from evenroad.infeasibility.proof import apart

    poses = [goal for goal, _ in given.poses]
    return apart(world, problem.start, problem.goals, poses, quickly=quickly, whole=given.whole)


def _counts_of(attempt: Attempt, connection: Connection) -> dict[str, int]:
    return dict(
        nodes=connection.nodes,
        configurations_checked=attempt.checked + connection.configurations,
        edges_checked=connection.motions,
    )


def _with_path(
    attempt: Attempt, raw: Floats, raw_cost: float, goal: int, counts: dict[str, int], *, by_connector: bool
) -> PlanResult:
    """Return the result with a path, smoothed if wanted: by the connector if there is one and costs are lengths."""
    world, problem = attempt.world, attempt.problem
    path, length, cost, is_cut = raw, raw_cost, attempt.edge_cost, False
    if problem.smooth:
        counts["shortcut_motions"] = 0
        with attempt.watch("shortcut"), until(attempt.time):
            try:
                if by_connector and attempt.connector is not None:
                    quick = problem.smooth == "quick"
                    path, counts["shortcut_motions"] = attempt.connector.smooth(world, raw, quick=quick)
                else:
                    path, counts["shortcut_motions"] = shortcut(world, raw, cost)
                    is_cut = attempt.time.is_over
            except BudgetSpent:
                is_cut = True
            if path is not raw:
                measure = world.space.distance if cost is None else cost
                length = float(np.sum(measure(path[:-1], path[1:])))
    named = "length" if cost is None else "cost"
    return solution(
        problem,
        path,
        goal,
        raw=raw,
        cost=length,
        raw_cost=raw_cost,
        message=path_message(path, length, goal, len(problem.goals), named, is_cut=is_cut),
        counts=counts,
        **_made_by(attempt),
    )


def _reach(attempt: Attempt, searched: Searched, counts: dict[str, int]) -> tuple[str, str]:
    """Return in words how far start and goals reach and what is missing; add the counts.

    Raises BudgetSpent where the time is over and there are edges to follow.
    """
    states = searched.states
    if searched.found.reached is not None:
        counts["start_component"] = reached = searched.found.reached - 1
        return f"the tree reached {reached} of {counts['valid']} valid milestones", "but not the goal"
    if len(states.edges):
        look_at_clock()
    start = len(states.node_states) - 1 - len(attempt.goals)
    goals = np.arange(start + 1, len(states.node_states), dtype=np.int32)
    is_open = (states.node_states[states.edges] != BLOCKED).all(axis=1) & (states.edge_states != BLOCKED)
    # The goals are one virtual node.
    edges = np.concatenate([states.edges[is_open], np.stack([goals, np.roll(goals, 1)], axis=1)])
    label = components(len(states.node_states), edges)
    open_nodes = states.node_states[:start] != BLOCKED
    for end, name in ((start, "start_component"), (start + 1, "goal_component")):
        counts[name] = int(np.count_nonzero(open_nodes & (label[:start] == label[end])))
    both = f"start reaches {counts['start_component']} and goal {counts['goal_component']}"
    return f"{both} of {counts['valid']} valid milestones", "and the two components do not meet"


def _few_directions(attempt: Attempt, points: int) -> str:
    """Return a hint for a Korobov lattice whose points have neighbours in too few directions."""
    space, d = attempt.world.space, attempt.world.space.cube_dim
    rule, method = re.match(r"k=(\d+) symmetrised", attempt.rule), attempt.origin.method
    lattice = re.match(r"rank-1 lattice (a|z)=([\d ]+), ", method)
    if rule is None or lattice is None:
        return ""
    k, scale = int(rule[1]), _axis_scales(space)
    if scale is None:
        return ""
    # Imported late: most plans are not on lattices.
    require_time_for("evenroad.points.measures.short_vectors")
    from evenroad.points.measures.rank_one import least_neighbours
    from evenroad.points.measures.short_vectors import MOST_AXES, lattice_basis

    # Nearest points come in opposite pairs, so at least this number is needed.
    least, advice = 2 * d - 1, f"at least {2 * d - 1} are needed"
    if d <= MOST_AXES and not ("permuted" in method and np.ptp(scale) > 1e-9 * scale[0]):
        numbers = [int(each) for each in lattice[2].split()]
        vector = [pow(numbers[0], i, points) for i in range(d)] if lattice[1] == "a" else numbers
        try:
            if (np.abs(lattice_basis(points, vector, scale)) >= points).any():
                # The box is too long, or there are too few points: neighbours would lie beyond it.
                return ""
            needed = least_neighbours(points, vector, scale)
        except EvenroadError:
            # The box is even longer, or some points of the lattice are missing.
            return ""
        # Fewer suffice if the right ones among equally near points are chosen.
        least, advice = needed, f"{max(needed, least)} would not"
    return f"; the nearest {k} of this lattice leave directions out, {advice}" if k < least else ""


def _axis_scales(space: Space) -> Floats | None:
    """Return the weight of each axis of the cube in a flat space, (d,), or None."""
    metric = flat_metric(space)
    if metric is None:
        return None
    corners = space.from_cube(np.vstack([np.zeros(space.cube_dim), 0.25 * np.eye(space.cube_dim)]))
    return np.asarray(4.0 * np.linalg.norm(metric.scale * (corners[1:] - corners[0]), axis=1))


def failed(attempt: Attempt, status: Status, message: str, **more: object) -> PlanResult:
    """Return the result of an attempt that found no path."""
    return make_result(attempt.problem, status, message, **_made_by(attempt), **more)


class _MadeBy(TypedDict):
    origin: Origin
    rule: str
    links: int | None
    planner: str
    timings: dict[str, float]


def _made_by(attempt: Attempt) -> _MadeBy:
    """Return the attributes of a result about its planner, points and times."""
    return dict(
        origin=attempt.origin,
        rule=attempt.rule,
        links=attempt.links,
        planner=attempt.planner,
        timings=attempt.watch.seconds,
    )


def _searched_graph(states: EdgeStates, terminals: int) -> SearchedGraph:
    """Return the graph of valid nodes and free edges; start and goals are the last `terminals` nodes."""
    kept = states.node_states != BLOCKED
    number = np.cumsum(kept, dtype=np.int32) - 1
    edges = states.edges[states.edge_states == FREE]
    return SearchedGraph(states.configurations[kept], number[edges].astype(np.int32), int(kept.sum()) - terminals)
