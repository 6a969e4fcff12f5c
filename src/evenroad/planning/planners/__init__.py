"""Planners, and the list of them by name: trees, roadmaps, roadmaps that grow, a search of a map's cells.

A new planner is a frozen class with ``solve(problem)``, in its own file here, and a line in `PLANNERS`.
"""

from __future__ import annotations

from collections.abc import Callable

from evenroad._hints import hint_of_module
from evenroad.errors import UnknownName, shown
from evenroad.planning.planners.trees import RRTConnect
from evenroad.planning.problem import Planner


def _prm() -> Planner:
    # Imported late, as below: an arm's plan needs no roadmap.
    from evenroad.planning.planners.prm import PRM

    return PRM()


def _fmt() -> Planner:
    from evenroad.planning.planners.prm import FMT

    return FMT()


PLANNERS: dict[str, Callable[[], Planner]] = {"rrtconnect": RRTConnect, "prm": _prm, "fmt": _fmt}
"""Planners by name."""
_OTHERWISE = {"rrtc": "rrtconnect", "birrt": "rrtconnect", "connect": "rrtconnect", "fmt*": "fmt", "fmtstar": "fmt"}
"""Other names of planners -> theirs, both in small letters alone."""


def planner_of(name: str) -> Callable[[], Planner] | None:
    """Return what makes a planner of a name in any spelling, as ``RRT-Connect`` or ``rrt_connect``; None if unknown."""
    plain = "".join(each for each in name.casefold() if each not in "-_ ").removesuffix("planner")
    return PLANNERS.get(_OTHERWISE.get(plain, plain))


def unknown_planner(name: str) -> UnknownName:
    """Return the error of a name that is no planner's, with what comes nearest to that planner here."""
    hint = hint_of_module(name.replace("*", "star").replace("-", "").replace(" ", ""), ())
    known = f"known: {', '.join(sorted(PLANNERS))}"
    return UnknownName(f"unknown planner {shown(name)}; {f'{hint}; {known}' if hint else known}")
