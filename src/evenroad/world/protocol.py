"""World: the checks that a planner needs of a robot among its obstacles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from evenroad._arrays import Bools, Floats
from evenroad.space import Space


class World(Protocol):
    """Validity of configurations and of motions, always for a batch.

    Implementations never write to their arguments, give every row the verdict that it would get alone, and
    raise InvalidValue for a wrong shape or an entry that is not finite.  A motion is the shortest
    interpolation of the space; it is free only if both of its ends are, and reversing it changes nothing.

    A world may have a text `proof` that says what its verdict on a motion shows: ``exact`` (no gap, up to rounding),
    ``certified`` (no gap) or ``resolution`` (states close together).  Of others nothing more is claimed than the last.
    """

    @property
    def space(self) -> Space:
        """The space that the configurations live in."""

    def valid(self, q: Floats) -> Bools:
        """Return for each configuration, (n, dim), whether it is free: (n,)."""

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return for each pair of rows of two (m, dim) arrays whether the motion is free: (m,)."""


@runtime_checkable
class Explains(Protocol):
    """A world that can say in words why a configuration is not free; planners put it into their answers."""

    def explain(self, q: Floats) -> str:
        """Return for one configuration, (dim,), that is not free, what it collides with."""


@runtime_checkable
class ExplainsStarts(Explains, Protocol):
    """A world that knows more of why a robot cannot start."""

    def explain_start(self, q: Floats) -> str:
        """Return as `explain` why a start, (dim,), is not free, and what to do about it."""


@runtime_checkable
class ValidatesPaths(Protocol):
    """A world whose verdicts on motions have gaps, and that can look closer at the path that is handed out."""

    @property
    def proof(self) -> str:
        """What `validate` shows: ``resolution`` (states closer than planned with) or ``certified`` (no gap)."""

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free by the strict check: (p - 1,)."""


@runtime_checkable
class MeasuresPaths(Protocol):
    """A world that can tell how near a path comes to an obstacle."""

    def path_clearance(self, path: Floats) -> float | None:
        """Return how far a path, (p, dim), stays from all obstacles, never more than it does; None says nothing."""


@dataclass(frozen=True)
class Apart:
    """What keeps a start from its goals."""

    message: str
    """In a sentence: of which bodies, and by what."""
    proved: bool
    """Whether there is no path at all; else the world can find none, and others may be."""


@runtime_checkable
class ShowsApart(Protocol):
    """A world that says what keeps a start from all of its goals, those among them that it calls blocked, too."""

    def apart(self, start: Floats, goals: Floats, *, quickly: bool = False) -> Apart | None:
        """Return what keeps the start, (dim,), from the goals, (g, dim); None says nothing.

        Asked `quickly`, it takes no more than some milliseconds.
        """
