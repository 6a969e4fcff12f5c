"""Searches of a benchmark, by name: what is asked of a roadmap in its world."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from evenroad.errors import UnknownName
from evenroad.research.bench.connect import is_connected, milestones_until_connected
from evenroad.roadmap.cost import edge_costs
from evenroad.roadmap.search import FINDERS, EdgeStates, length_along, search_problem


@dataclass(frozen=True)
class Finding:
    """What a search says.

    Attributes
    ----------
    solved : bool
        Whether there is a path.
    valid_at_solution : int or None
        Of search ``stock``: valid milestones that had been added when there was one.
    length : float
        Of the shortest path along the roadmap; NaN where none was looked for or found.
    """

    solved: bool
    valid_at_solution: int | None = None
    length: float = math.nan


def search_named(name: str) -> Callable[[EdgeStates], Finding]:
    """Return the search of this name: from a ledger whose last two nodes are start and goal to what it says.

    Raises
    ------
    UnknownName
        If there is none; the text lists them.
    """
    if name not in SEARCHES:
        raise UnknownName.among("search", name, SEARCHES)
    return SEARCHES[name]


def _connect(ledger: EdgeStates) -> Finding:
    return Finding(is_connected(ledger))


def _stock(ledger: EdgeStates) -> Finding:
    needed = milestones_until_connected(ledger)
    return Finding(needed is not None, needed)


def _full(ledger: EdgeStates) -> Finding:
    return _shortest(ledger, "full")


def _lazy(ledger: EdgeStates) -> Finding:
    return _shortest(ledger, "lazy")


def _shortest(ledger: EdgeStates, search: str) -> Finding:
    costs = edge_costs(ledger.world.space, ledger.configurations, ledger.edges)
    nodes, along = FINDERS[search](search_problem(ledger, costs), ledger)
    if not nodes.size:
        return Finding(False)
    return Finding(True, length=length_along(costs, along))


SEARCHES: dict[str, Callable[[EdgeStates], Finding]] = {
    "connect": _connect,
    "stock": _stock,
    "full": _full,
    "lazy": _lazy,
}
"""Name -> search; what they do is said at :class:`~evenroad.research.bench.task.Task`."""
