"""From what an attempt found to the result that the caller gets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.attempt import Attempt, Searched
from evenroad.roadmap.proof import proof_of
from evenroad.roadmap.result import PlanResult, SearchedGraph, Status
from evenroad.roadmap.search import BLOCKED, FREE, EdgeStates, components, length_along
from evenroad.roadmap.shortcut import shortcut
from evenroad.space.path import motion_lengths
from evenroad.world import Connection, Explains, Rechecks, Separates

PROVED = "proved: there is no path; start and goal lie in two components of the free space"


def refusal(attempt: Attempt) -> PlanResult | None:
    """Return the result if the start or all goals are in collision; else None, and the attempt knows the free goals."""
    places, world = attempt.query.start_and_goals, attempt.world
    free = attempt.valid_ends()
    if free[0] and attempt.goals.size:
        return None
    row, status, name = (1, Status.GOAL_INVALID, "goal") if free[0] else (0, Status.START_INVALID, "start")
    reason = f": {world.explain(places[row])}" if isinstance(world, Explains) else ""
    if row and len(places) > 2:
        return _result(attempt, status, f"all {len(places) - 1} goals are in collision; the first{reason}")
    return _result(attempt, status, f"the {name} is in collision{reason}")


def answer(
    attempt: Attempt,
    searched: Searched,
    points: int,
    *,
    best: Searched | None = None,
    keep_graph: bool = True,
    reached: int | None = None,
) -> PlanResult:
    """Return the result of a search over so many points.

    Parameters
    ----------
    attempt : Attempt
        Which searched.
    searched : Searched
        The search whose graph is counted and kept.
    points : int
        How many were given or drawn.
    best : Searched, optional
        The search whose path is the answer; default: `searched`.
    keep_graph : bool
        Whether the result has a `roadmap`.
    reached : int, optional
        Nodes in the tree, if the planner grew one.
    """
    states = searched.states
    counts = _counts(attempt, states, points)
    graph = searched_graph(states, 1 + len(attempt.goals)) if keep_graph else None
    best = searched if best is None else best
    if best.solved:
        return _solved(attempt, best, counts, graph)
    message = _not_connected(attempt, states, counts, reached)
    if attempt.spent:
        limits = attempt.query.budget.text(samples=attempt.grows)
        status, message = Status.BUDGET_SPENT, f"no path within {limits}; {message.partition(':')[0]}"
    else:
        status = Status.NOT_CONNECTED
    return replace(_result(attempt, status, message), counts=counts, roadmap=graph)


def connected(attempt: Attempt, connection: Connection) -> PlanResult:
    """Return the result of a world that found a path by itself."""
    return _with_path(
        attempt,
        connection.path,
        float(np.sum(motion_lengths(connection.path, attempt.world.space))),
        int(attempt.goals[connection.goal]),
        _counts_of(attempt, connection),
        by_world=True,
    )


def gave_up(attempt: Attempt, connection: Connection) -> PlanResult:
    """Return the result of a world that found no path by itself within the budget."""
    message = (
        f"no path within {attempt.query.budget.text(samples=False)}: {connection.nodes} nodes were grown and"
        f" {connection.motions} motions checked; give it more time"
    )
    return replace(_result(attempt, Status.BUDGET_SPENT, message), counts=_counts_of(attempt, connection))


def proved_apart(attempt: Attempt) -> PlanResult:
    """Return the result of a world in which no path can join the start to a goal."""
    return _result(attempt, Status.NOT_CONNECTED, PROVED)


def are_apart(attempt: Attempt) -> bool:
    """Return whether the world can prove that no path leads from the start to any goal."""
    world, query = attempt.world, attempt.query
    return isinstance(world, Separates) and not any(
        world.may_connect(query.start, goal) for goal in query.goals[attempt.goals]
    )


def _counts_of(attempt: Attempt, connection: Connection) -> dict[str, int]:
    return dict(
        nodes=connection.nodes,
        configurations_checked=attempt.checked + connection.configurations,
        edges_checked=connection.motions,
    )


def _counts(attempt: Attempt, states: EdgeStates, points: int) -> dict[str, int]:
    return dict(
        points=points,
        valid=int(np.count_nonzero(states.node_states[: -1 - len(attempt.goals)] == FREE)),
        configurations_checked=attempt.checked + states.configurations_checked,
        edges_considered=len(states.edges),
        edges_checked=states.motions_checked,
        edges_free=int(np.count_nonzero(states.edge_states == FREE)),
    )


def _solved(
    attempt: Attempt, searched: Searched, counts: dict[str, int], graph: SearchedGraph | None
) -> PlanResult:
    nodes, along = searched.found
    states, goals = searched.states, attempt.goals
    goal = int(goals[int(nodes[-1]) - (len(states.configurations) - len(goals))])
    raw = states.configurations[nodes]
    # A disk's paths along a roadmap keep the bits that published rows have.
    by_world = attempt.query.edge_cost is None and isinstance(attempt.world, Rechecks)
    cost = length_along(searched.costs, along)
    return _with_path(attempt, raw, cost, goal, counts, by_world=by_world, graph=graph)


def _with_path(
    attempt: Attempt,
    raw: npt.NDArray[np.float64],
    raw_cost: float,
    goal: int,
    counts: dict[str, int],
    *,
    by_world: bool,
    graph: SearchedGraph | None = None,
) -> PlanResult:
    """Return the result with a path, shortened if wanted: by the world itself where it can and may."""
    world, query = attempt.world, attempt.query
    path, length, cost = raw, raw_cost, query.edge_cost
    if query.shorten:
        with attempt.watch("shortcut"):
            if by_world and attempt.own_planner is not None:
                path, counts["shortcut_motions"] = attempt.own_planner.shorten(raw)
            else:
                path, counts["shortcut_motions"] = shortcut(raw, world, cost, attempt.deadline)
            measure = world.space.distance if cost is None else cost
            length = float(np.sum(measure(path[:-1], path[1:])))
    named = "length" if cost is None else "cost"
    to = f" to goal {goal}" if len(query.goals) > 1 else ""
    return replace(
        _result(attempt, Status.SOLVED, f"path of {named} {length:.6g} with {len(path)} waypoints{to}"),
        goal_index=goal,
        path=path,
        milestone_path=raw,
        proof=proof_of(world),
        cost=length,
        milestone_cost=raw_cost,
        counts=counts,
        roadmap=graph,
    )


def _not_connected(attempt: Attempt, states: EdgeStates, counts: dict[str, int], reached: int | None) -> str:
    """Return in words how far start and goals reach, and count it."""
    n, rule = counts["points"], attempt.rule
    if reached is not None:
        counts["start_component"] = reached - 1
        return (
            f"the tree reached {reached - 1} of {counts['valid']} valid milestones, but not the goal"
            f" (n={n}, {rule}): try n={2 * n} or a larger k"
        )
    start = len(states.node_states) - 1 - len(attempt.goals)
    goals = np.arange(start + 1, len(states.node_states), dtype=np.int32)
    # The goals are one virtual node.
    edges = np.concatenate([states.open_edges(), np.stack([goals, np.roll(goals, 1)], axis=1)])
    label = components(len(states.node_states), edges)
    open_nodes = states.node_states[:start] != BLOCKED
    for end, name in ((start, "start_component"), (start + 1, "goal_component")):
        counts[name] = int(np.count_nonzero(open_nodes & (label[:start] == label[end])))
    among = f"{counts['valid']} valid milestones"
    if (open_nodes & (states.node_states[:start] != FREE)).any():
        among = f"{int(np.count_nonzero(open_nodes))} milestones not known to be invalid"
    return (
        f"start reaches {counts['start_component']} and goal {counts['goal_component']} of {among},"
        f" and the two components do not meet (n={n}, {rule}): try n={2 * n}{_hint(rule)}"
    )


def _result(attempt: Attempt, status: Status, message: str) -> PlanResult:
    return PlanResult(
        status=status,
        message=message,
        start=attempt.query.start,
        goals=attempt.query.goals,
        origin=attempt.origin,
        rule=attempt.rule,
        links=attempt.query.links,
        planner=attempt.planner,
        seconds=attempt.watch.seconds,
    )


def searched_graph(states: EdgeStates, ends: int) -> SearchedGraph:
    """Return what is not known to be invalid, with start and goals as the last `ends`, and the free edges."""
    kept = states.node_states != BLOCKED
    number = np.cumsum(kept, dtype=np.int32) - 1
    edges = states.edges[states.edge_states == FREE]
    return SearchedGraph(states.configurations[kept], number[edges].astype(np.int32), int(kept.sum()) - ends)


def _hint(rule: str) -> str:
    """Return what else may help under this rule; under ``complete`` nothing does."""
    if "radius" in rule:
        return " or a larger radius"
    return " or a larger k" if rule.startswith("k") else ""
