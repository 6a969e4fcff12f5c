"""Planners, and the list of them by name: trees, roadmaps, roadmaps that grow, a search of a map's cells.

A new planner is a frozen class with ``solve(problem)``, in its own file here, and a line in `PLANNERS`.
"""

from __future__ import annotations

from collections.abc import Callable

from evenroad.planning.planners.prm import FMT, PRM
from evenroad.planning.planners.trees import RRTConnect
from evenroad.planning.problem import Planner

PLANNERS: dict[str, Callable[[], Planner]] = {"rrtconnect": RRTConnect, "prm": PRM, "fmt": FMT}
"""Planners by name."""
