"""From what a search found and asked to the answer."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from evenroad.roadmap.cost import EdgeCost
from evenroad.roadmap.result import PlanResult, SearchedGraph, Status
from evenroad.roadmap.search import length_along, pieces
from evenroad.roadmap.search.a_star import BLOCKED, FREE
from evenroad.roadmap.search.find import Found
from evenroad.roadmap.search.ledger import Ledger
from evenroad.roadmap.shortcut import shortcut
from evenroad.roadmap.stopwatch import Stopwatch


def count(points: int, ledger: Ledger, configurations_checked: int = 0) -> dict[str, int]:
    """Return the counts of a search whose last two nodes are start and goal.

    `configurations_checked` are those that were checked before the ledger was begun.
    """
    return dict(
        points=points,
        valid=int(np.count_nonzero(ledger.node_states[:-2] == FREE)),
        configurations_checked=configurations_checked + ledger.configurations_checked,
        edges_considered=len(ledger.edges),
        edges_checked=ledger.motions_checked,
        edges_free=int(np.count_nonzero(ledger.edge_states == FREE)),
    )


def solved(
    found: Found,
    costs: npt.NDArray[np.float64],
    ledger: Ledger,
    watch: Stopwatch,
    *,
    shorten: bool,
    cost: EdgeCost | None,
    counts: dict[str, int],
    **common: Any,
) -> PlanResult:
    """Return the answer with a path, shortened if wanted; `costs` are those of the ledger's edges."""
    nodes, along = found
    path = milestone_path = ledger.configurations[nodes]
    milestone_cost = length = length_along(costs, along)
    if shorten:
        with watch("shortcut"):
            path, counts["shortcut_motions"] = shortcut(milestone_path, ledger.world, cost)
            measure = ledger.world.space.distance if cost is None else cost
            length = float(np.sum(measure(path[:-1], path[1:])))
    return PlanResult(
        status=Status.SOLVED,
        message=f"path of length {length:.6g} with {len(path)} waypoints"
        if cost is None
        else f"path of cost {length:.6g} with {len(path)} waypoints",
        path=path,
        milestone_path=milestone_path,
        cost=length,
        milestone_cost=milestone_cost,
        counts=counts,
        seconds=watch.seconds,
        **common,
    )


def not_connected(
    ledger: Ledger, watch: Stopwatch, *, counts: dict[str, int], rule: str, **common: Any
) -> PlanResult:
    """Return the answer that start and goal, the last two nodes, lie in two pieces, and how large those are."""
    label = pieces(len(ledger.node_states), ledger.open_edges())
    open_nodes = ledger.node_states[:-2] != BLOCKED
    for end, name in ((-2, "start_piece"), (-1, "goal_piece")):
        counts[name] = int(np.count_nonzero(open_nodes & (label[:-2] == label[end])))
    among = f"{counts['valid']} valid milestones"
    if (open_nodes & (ledger.node_states[:-2] != FREE)).any():
        among = f"{int(np.count_nonzero(open_nodes))} milestones not known to be invalid"
    return PlanResult(
        status=Status.NOT_CONNECTED,
        message=(
            f"start reaches {counts['start_piece']} and goal {counts['goal_piece']} of {among},"
            f" and the two pieces do not meet (n={counts['points']}, {rule}): try n={2 * counts['points']}"
            f"{_hint(rule)}"
        ),
        counts=counts,
        seconds=watch.seconds,
        rule=rule,
        **common,
    )


def searched_graph(ledger: Ledger) -> SearchedGraph:
    """Return the milestones not known to be invalid, start and goal, and the edges known to be free."""
    kept = ledger.node_states != BLOCKED
    number = np.cumsum(kept, dtype=np.int32) - 1
    edges = ledger.edges[ledger.edge_states == FREE]
    return SearchedGraph(ledger.configurations[kept], number[edges].astype(np.int32))


def _hint(rule: str) -> str:
    """Return what else may help under this rule; under ``complete`` nothing does."""
    if "radius" in rule:
        return " or a larger radius"
    return " or a larger k" if rule.startswith("k") else ""
