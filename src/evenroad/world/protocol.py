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
class Rechecks(Protocol):
    """A world whose verdicts on motions have gaps, and that can look closer at the path that is handed out."""

    @property
    def proof(self) -> str:
        """What `recheck` shows: ``resolution`` (states closer than planned with) or ``certified`` (no gap)."""

    def recheck(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are free by the strict check: (p - 1,)."""


@dataclass(frozen=True, eq=False)
class Connection:
    """What a world that plans by itself found between a start and its goals."""

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


@runtime_checkable
class MeasuresPaths(Protocol):
    """A world that can tell how near a path comes to an obstacle."""

    def path_clearance(self, path: Floats) -> float | None:
        """Return how far a path, (p, dim), stays from all obstacles, never more than it does; None says nothing."""


@runtime_checkable
class Shortens(Protocol):
    """A world with a compiled way of making paths shorter."""

    def shorten(self, path: Floats) -> tuple[Floats, int]:
        """Return a path that is not longer and passes the strict check, and how many motions were checked."""


@runtime_checkable
class ConnectsItself(Shortens, Protocol):
    """A world with a compiled planner of its own; planners ask it before they build a roadmap."""

    @property
    def planner(self) -> str:
        """What results call this planner."""

    def connect(self, start: Floats, goals: Floats, *, most_motions: int, seconds: float) -> Connection:
        """Join the start, (dim,), to the first of the goals, (g, dim), that can be reached within the budget."""


@runtime_checkable
class ConnectsAnew(ConnectsItself, Protocol):
    """A world whose own planner finds other paths when it is asked again; a planner that improves asks it often."""

    def connect_anew(
        self, start: Floats, goals: Floats, *, variant: int, most_motions: int, seconds: float
    ) -> Connection:
        """As `connect`, planned in another way for each variant >= 1; the same one gives the same path."""


@runtime_checkable
class Separates(Protocol):
    """A world that can prove that no path leads from one configuration to another."""

    def may_connect(self, a: Floats, b: Floats) -> bool:
        """Return False where it is proved that no path leads from `a` to `b`, (dim,) each; True says nothing."""


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
