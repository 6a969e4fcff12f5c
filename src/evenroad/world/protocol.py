"""World: the checks that a planner needs of a robot among its obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from evenroad._arrays import Bools, Floats
from evenroad.space import Space


class World(Protocol):
    """Validity of configurations and of motions, always for a batch.

    Implementations never write to their arguments, give every row the result that it would get alone, and raise
    InvalidValue for a wrong shape or an entry that is not finite.  A motion is the shortest
    interpolation of the space; it is free only if both of its endpoints are, and reversing it changes nothing.

    A world may have a text `proof` that says what its check of a motion shows: ``exact`` (no gap, up to rounding),
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
    """A world that explains, in words, why a configuration is not free; planners put it into their answers."""

    def explain(self, q: Floats) -> str:
        """Return what one configuration, (dim,), that is not free collides with."""


@runtime_checkable
class ExplainsStarts(Explains, Protocol):
    """A world that explains in more detail why a robot cannot start."""

    def explain_start(self, q: Floats) -> str:
        """Return as `explain` why a start, (dim,), is not free, and what to do about it."""


@runtime_checkable
class ValidatesPaths(Protocol):
    """A world whose checks of motions have gaps, with a strict check for the final path."""

    @property
    def proof(self) -> str:
        """What `validate` shows: ``resolution`` (states closer than in planning) or ``certified`` (no gap)."""

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free by the strict check: (p - 1,)."""


@runtime_checkable
class MeasuresPaths(Protocol):
    """A world that measures the clearance of a path."""

    def path_clearance(self, path: Floats) -> float | None:
        """Return a lower bound of the distance of a path, (p, dim), from all obstacles; None if unknown."""


@runtime_checkable
class NamesNearest(Protocol):
    """A world that names what comes nearest to contact."""

    def nearest_along(self, path: Floats) -> tuple[str, str] | None:
        """Return the names of the robot's body and the obstacle that come nearest along a path, (p, dim)."""


@runtime_checkable
class BoundsLengths(Protocol):
    """A world that knows more of how short a path can be than the straight distance."""

    def least_length(self, start: Floats, goals: Floats) -> float:
        """Return a length that no path from the start, (dim,), to any goal, (g, dim), falls below."""


@dataclass(frozen=True)
class Apart:
    """A proof that no path leads from a start to its goals."""

    message: str
    """One sentence: of which bodies, and by which argument."""
    proved: bool
    """Whether there is no path at all; else the world can find none, and others may be."""


@runtime_checkable
class ShowsApart(Protocol):
    """A world that can show that no path leads from a start to its goals, blocked ones included."""

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return the reason why no path leads from the start, (dim,), to the goals, (g, dim); None if unknown.

        With `quickly` it takes some milliseconds at most.
        """
