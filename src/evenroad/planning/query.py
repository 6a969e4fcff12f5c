"""Query: start, goals and options of one search along a roadmap."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import require_count, require_known
from evenroad.errors import InvalidValue
from evenroad.planning.connector import Connector, Smooth, require_smooth
from evenroad.roadmap.budget import Budget
from evenroad.roadmap.edges import EdgeCost, links_among
from evenroad.roadmap.search import FINDERS, Finder, find_any
from evenroad.space import Space
from evenroad.world import Apart

ProvesApart: TypeAlias = Callable[[Floats, Floats, bool], Apart | None]
"""Proves, quickly or not, that a start, (dim,), and goals, (g, dim), are apart: see ``world.ShowsApart``."""


@dataclass(frozen=True, eq=False)
class Query:
    """A start, goals and options; never changed.

    `start`, (dim,), and `goals`, (g, dim), are results of :func:`as_start_and_goals`.  `connector` plans and smooths in
    this kind of world, where there is one; the others are as in :class:`evenroad.PRM`.  UnknownName if there is no such
    search.
    """

    start: Floats
    goals: Floats
    _: KW_ONLY
    search: str = "full"
    success_only: bool = False
    smooth: Smooth = True
    edge_cost: EdgeCost | None = None
    links: int | None = None
    budget: Budget = field(default_factory=Budget)
    apart: ProvesApart | None = None
    connector: Connector | None = None

    def __post_init__(self) -> None:
        require_known("search", self.search, FINDERS)
        require_smooth(self.smooth)
        if self.links is not None:
            require_count("links", self.links)
        for array in (self.start, self.goals):
            array.setflags(write=False)

    @cached_property
    def start_and_goals(self) -> Floats:
        """The start, then the goals, (1 + g, dim)."""
        terminals = np.concatenate([self.start[np.newaxis], self.goals])
        terminals.setflags(write=False)
        return terminals

    def links_among(self, milestones: int) -> int:
        """Return the number of milestones that start and goals are linked to besides those of the rule."""
        return links_among(milestones, self.links)

    @property
    def find(self) -> Finder:
        """The search."""
        return find_any if self.success_only else FINDERS[self.search]

    @property
    def planner(self) -> str:
        """The name that results give the planner of this search."""
        return f"prm {'any' if self.success_only else self.search}"


def as_start_and_goals(start: npt.ArrayLike, goal: npt.ArrayLike, space: Space) -> tuple[Floats, Floats]:
    """Return start, (dim,), and goals, (g, dim), from one start and one or more goals.

    Raises InvalidValue if they do not have the dimension of the space, or are not finite.
    """
    dim = space.dim
    first, goals = _finite(start), _finite(goal)
    if first.shape != (dim,):
        raise InvalidValue(f"start must be {dim} finite numbers, got {start!r}")
    if goals.shape != (dim,) and (goals.ndim != 2 or goals.shape[1] != dim or not len(goals)):
        several = f"or an array (g, {dim}) of g >= 1 goals"
        raise InvalidValue(f"goal must be {dim} finite numbers, {several}, got {goal!r}")
    return first, goals.reshape(-1, dim)


def _finite(value: npt.ArrayLike) -> Floats:
    """Return a copy as floats; for anything but finite numbers an array of a shape that is refused."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.empty((0, 0))
    # Squares of most are finite, too, and faster to test.
    if math.isfinite(np.vdot(array, array)) or np.isfinite(array).all():
        return array
    return np.empty((0, 0))
