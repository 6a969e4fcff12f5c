"""World: the interface to the checks of a robot among its obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from evenroad._arrays import Bools, Floats
from evenroad.space import Space


class World(Protocol):
    """Validity of configurations and of motions, always for a batch.

    Implementations never write to their arguments, give every row the result that it would get alone, and raise
    InvalidValue for a wrong shape or an entry that is not finite.

    A motion is the curve of the space from one configuration to another: `space.distance` is its length, and
    `space.interpolate` returns the points on it.  It is free only if both endpoints are.  In most spaces a motion is a
    straight line, and its reverse has the same result.  A car drives curves, and the waypoints of its path are joined
    by curves, too.  Where a space `is_directed`, the motion back is a different one.

    A world may have a text `proof`, the kind of proof of a motion's check: ``exact`` (no gap, up to rounding),
    ``certified`` (no gap) or ``resolution`` (states close together), which is the default.
    """

    @property
    def space(self) -> Space:
        """The space of the configurations."""

    def valid(self, q: Floats) -> Bools:
        """Return for each configuration, (n, dim), whether it is free: (n,)."""

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return for each pair of rows of two (m, dim) arrays whether the motion is free: (m,)."""


@runtime_checkable
class Explains(Protocol):
    """A world that explains in words why a configuration is not free; planners use the text in their messages."""

    def explain(self, q: Floats) -> str:
        """Return why one configuration, (dim,), is not free, such as the bodies in collision."""


@runtime_checkable
class ExplainsStarts(Explains, Protocol):
    """A world that explains in more detail why a robot cannot start."""

    def explain_start(self, q: Floats) -> str:
        """Return why a start, (dim,), is not free, like `explain`, and what to do about it."""


@runtime_checkable
class ValidatesPaths(Protocol):
    """A world whose checks of motions have gaps, with a strict check for the final path."""

    @property
    def proof(self) -> str:
        """Kind of proof of `validate`: ``resolution`` (states closer than in planning) or ``certified`` (no gap)."""

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free by the strict check: (p - 1,)."""


@runtime_checkable
class MeasuresPaths(Protocol):
    """A world that measures the clearance of a path."""

    def path_clearance(self, path: Floats) -> float | None:
        """Return a lower bound of the distance of a path, (p, dim), from all obstacles; None if unknown."""


@runtime_checkable
class NamesNearest(Protocol):
    """A world that names the body and obstacle nearest to contact."""

    def nearest_along(self, path: Floats) -> tuple[str, str] | None:
        """Return the names of the robot's body and the obstacle that come nearest along a path, (p, dim)."""


@runtime_checkable
class BoundsLengths(Protocol):
    """A world with a better lower bound of path lengths than the straight distance."""

    def least_length(self, start: Floats, goals: Floats) -> float:
        """Return a lower bound of the length of paths from the start, (dim,), to any goal, (g, dim)."""


@dataclass(frozen=True)
class Apart:
    """A proof that no path leads from a start to its goals."""

    message: str
    """One sentence: the bodies that it is about, and the argument."""
    proved: bool
    """Whether it is proved that there is no path; else none can be found for the bodies or postures of the message."""


@runtime_checkable
class ShowsApart(Protocol):
    """A world that can show that no path leads from a start to its goals, including blocked ones."""

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return the reason why no path leads from the start, (dim,), to the goals, (g, dim); None if unknown.

        With `quickly` it takes some milliseconds at most.
        """
