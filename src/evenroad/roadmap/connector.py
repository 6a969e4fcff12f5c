"""Connector: what joins a start to a goal without a roadmap, as trees do, or a search of a map's cells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from evenroad._arrays import Floats


@dataclass(frozen=True, eq=False)
class Connection:
    """What a connector found between a start and its goals."""

    path: Floats
    """Waypoints from the start to one goal, (p, dim), every motion free; (0, dim) when there is none."""
    goal: int
    """Which of the goals the path ends at; -1 when there is none."""
    nodes: int
    """Grown."""
    configurations: int
    """Checked."""
    motions: int
    """Checked."""


class Connector(Protocol):
    """A way to find a path in worlds of one kind, and to smooth it."""

    @property
    def planner(self) -> str:
        """What results call it."""

    @property
    def varies(self) -> bool:
        """Whether each variant finds another path: a planner that improves then asks for many."""

    @property
    def stages(self) -> tuple[tuple[int, bool], ...]:
        """After how many motions the world is asked whether there can be a path, and whether quickly."""

    def connect(
        self, world: Any, start: Floats, goals: Floats, *, variant: int, most_motions: int, seconds: float
    ) -> Connection:
        """Join the start, (dim,), to one of the goals, (g, dim), within the budget; the same variant, the same path."""

    def smooth(self, world: Any, path: Floats) -> tuple[Floats, int]:
        """Return a path, (q, dim), that is not longer than `path`, (p, dim), and how many motions were checked."""
