"""A query of a roadmap in a scene."""

from __future__ import annotations

from time import perf_counter as now
from typing import NamedTuple

import numpy as np

from evenroad._arrays import Floats
from evenroad._native.robot_roadmap import ProvedSearch, SceneGraph
from evenroad.planning.arm_trees import checks_of
from evenroad.robot import ArmWorld

GREED = 3.0
"""Factor of the bound of the search: it needs a third of the checks of a shortest path, and after shortening its paths
are not longer."""

_SLICE = 1000
"""Batches of sixteen checks between two looks at the clock: about 10 ms."""


class Query(NamedTuple):
    """A start, (dim,), and goals, (g, dim), the largest number of links of each, and the factor of the bound."""

    start: Floats
    goals: Floats
    links: int
    greed: float = GREED

    @property
    def rules(self) -> tuple[int, float]:
        """Links and greed."""
        return self.links, self.greed


class SearchResult(NamedTuple):
    """How a search ended, e.g. ``found``: a path, (p, dim), and its goal or -1; numbers of configurations, motions and
    batches of sixteen checks.
    """

    ended: str
    path: Floats
    goal: int
    configurations: int
    motions: int
    batches: int = 0


def search(
    graph: SceneGraph, worlds: tuple[ArmWorld, ArmWorld], query: Query, most_motions: int, deadline: float
) -> SearchResult:
    """Search for a path all of whose motions are proved.

    The first world has everything; the second has what the roadmap did not check.
    """
    if worlds[0].fixed_contact is not None:
        # Native checks get no capsules that no joint moves.
        return SearchResult("not free", np.empty((0, len(query.start))), -1, 0, 0)
    everything, moved = map(checks_of, worlds)
    terminals = np.concatenate([query.start[np.newaxis], query.goals])
    finder = ProvedSearch(graph, terminals, query.rules, everything, moved)
    ended: str = finder.go_on(most_motions, _SLICE)
    while ended == "paused":
        ended = finder.go_on(most_motions, _SLICE) if now() < deadline else "spent"
    return SearchResult(ended, finder.path, finder.goal, *finder.counts)
