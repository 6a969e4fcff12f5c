"""Connector: a search that joins a start to a goal without a roadmap, by trees or over a map's cells."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, TypeAlias

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue, shown
from evenroad.world import World

Smooth: TypeAlias = bool | Literal["quick"]
"""Whether a path is smoothed; "quick": by straight shortcuts alone."""


def require_smooth(smooth: object) -> None:
    """Raise InvalidValue unless this is a value of `Smooth`."""
    if smooth not in (True, False, "quick"):
        raise InvalidValue(f'smooth must be True, False or "quick", got {shown(smooth)}')


@dataclass(frozen=True, eq=False)
class Connection:
    """The result of a connector between a start and its goals."""

    path: Floats
    """Waypoints from the start to one goal, (p, dim), every motion free; (0, dim) without a path."""
    goal: int
    """Row of the goal that the path ends at; -1 without a path."""
    nodes: int
    """Number of nodes of the trees."""
    configurations: int
    """Number of configurations checked."""
    motions: int
    """Number of motions checked."""
    spent: bool = False
    """Whether the time ran out before the search ended."""


class Search(NamedTuple):
    """One search for a path."""

    most: int
    """Largest number of motions checked."""
    proof: Literal["none", "quick", "any"]
    """Kind of proof that there is no path, which the world tries afterwards."""


class Connector(Protocol):
    """A search for paths in worlds of one kind, which also smooths them."""

    @property
    def planner(self) -> str:
        """Its name in results."""

    @property
    def varies(self) -> bool:
        """Whether each variant finds another path, so that a planner that improves uses many."""

    def searches(self, dim: int) -> Iterator[Search]:
        """Yield the searches to make in a space of this dimension, each of another variant if it `varies`."""

    def connect(self, world: World, start: Floats, goals: Floats, *, variant: int, most_motions: int) -> Connection:
        """Join the start, (dim,), to one of the goals, (g, dim), within the budget.

        The same variant gives the same path.  When the time of this thread is over, it raises BudgetSpent, or returns
        a connection that is `spent`.
        """

    def smooth(self, world: World, path: Floats, *, quick: bool = False) -> tuple[Floats, int]:
        """Return a path, (q, dim), that is not longer than `path`, (p, dim), and how many motions were checked."""
