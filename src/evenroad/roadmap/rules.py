"""Connection rules: each chooses the pairs of milestones that a roadmap tries to join, and has a name.

The rule is part of every result: the same points give 15 % or 62 % success under two rules.  Candidates are all other
configurations.  Ties go to the lower index; start and goals come last.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats, Ints32
from evenroad._checks import require_count, require_positive
from evenroad._native.roadmap import ascending_pairs
from evenroad.errors import UnknownName
from evenroad.roadmap.neighbours import nearest, within
from evenroad.space import Space


@dataclass(frozen=True)
class Reach:
    """The milestones that a start or goal is joined to: its `k` nearest ones, or those within `radius`.

    If both are None, it is joined to all.
    """

    k: int | None = None
    radius: float | None = None


class Rule(Protocol):
    """Chooses candidate edges among configurations, before anything is checked; ``str()`` is its name."""

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs i < j of configurations `q`, (n, dim), to try, (m, 2), in ascending order, each once.

        Distances are those of the space, by default Euclidean.  The last `terminals` rows are starts and goals.
        """

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return the reach of a start or goal in a finished roadmap of this number of milestones."""


def ascending(pairs: npt.NDArray[np.integer], n: int) -> Ints32:
    """Return the distinct unordered pairs of numbers below `n`, smaller first, sorted, as int32 (m, 2)."""
    if not len(pairs):
        return np.empty((0, 2), dtype=np.int32)
    return ascending_pairs(np.ascontiguousarray(pairs, dtype=np.int32), n)


def plain(number: float) -> str:
    """Return a number with the fewest digits that give back the same number."""
    short = f"{number:g}"
    return short if float(short) == number else repr(number)


@dataclass(frozen=True)
class Complete(Rule):
    """``complete``: every pair is an edge, O(n^2) in all."""

    def __str__(self) -> str:
        return "complete"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return all pairs; see :class:`Rule`."""
        return np.stack(np.triu_indices(len(q), k=1), axis=1).astype(np.int32)

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return the reach of all milestones; see :class:`Rule`."""
        return Reach()


@dataclass(frozen=True)
class ByNumber(Rule):
    """A rule with a number of neighbours."""

    k: int = 10
    which: ClassVar[str]

    def __post_init__(self) -> None:
        require_count("k", self.k)

    def __str__(self) -> str:
        return f"k={self.k} {self.which}"

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return the reach of the k nearest; see :class:`Rule`."""
        return Reach(k=self.k)


@dataclass(frozen=True)
class KNearest(ByNumber):
    """``k symmetrised``: edge i-j iff i is among the k nearest of j, or j among those of i."""

    which = "symmetrised"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs of each with its k nearest; see :class:`Rule`."""
        return ascending(arcs_of(nearest(q, self.k, space)), len(q))


def arcs_of(neighbours: Ints32) -> Ints32:
    """Return (row, neighbour) for every entry that is not -1, shape (m, 2)."""
    n, k = neighbours.shape
    arcs = np.stack([np.repeat(np.arange(n, dtype=np.int32), k), neighbours.ravel()], axis=1)
    return arcs[arcs[:, 1] >= 0]


@dataclass(frozen=True)
class Radius(Rule):
    """``radius``: edge i-j iff the distance is at most r, in the units of the space (Algorithm 1's r_N)."""

    r: float

    def __post_init__(self) -> None:
        require_positive("connection radius", self.r)

    def __str__(self) -> str:
        return f"radius={plain(self.r)}"

    def edges(self, q: Floats, space: Space | None = None, *, terminals: int = 0) -> Ints32:
        """Return the pairs within the radius; see :class:`Rule`."""
        return ascending(within(q, self.r, space), len(q))

    def reach(self, milestones: int, space: Space) -> Reach:
        """Return the reach of the radius; see :class:`Rule`."""
        return Reach(radius=self.r)


def default_rule(space: Space) -> KNearest:
    """Return ``k=10 symmetrised`` below six dimensions, else ``k=20 symmetrised``; never fewer than 2 d.

    The nearest points of a lattice are opposite each other in pairs, so fewer than 2 d of them miss some directions.

    From six dimensions on, k matters more than the sampler.  Success in random worlds of balls and of boxes with
    Owen-Sobol points at k = 4 / 6 / 10 / 20: 53 / 67 / 75 / 78 % (d=5, N=256), 46 / 59 / 69 / 75 % (d=6, N=512),
    49 / 62 / 72 / 78 % (d=7, N=512), 46 / 56 / 64 / 71 % (d=10, N=512).  The step from 10 to 20 gives 3 to 4 points
    in d=5, and 6 to 7 from d=6 on.  It costs a lazy search few checks.
    """
    d = space.cube_dim
    return KNearest(max(20 if d >= 6 else 10, 2 * d))


NUMBER = r"([0-9.]+(?:e[+-]?[0-9]+)?)"
"""Pattern of a number in the name of a rule."""

Forms = dict[str, tuple[str, Callable[..., Rule]]]

FORMS: Forms = {
    "k=K symmetrised": (r"k=(\d+) symmetrised", lambda k: KNearest(int(k))),
    "radius=R": (rf"radius={NUMBER}", lambda r: Radius(float(r))),
    "complete": (r"complete", Complete),
}
"""Form of a rule's name -> its pattern, and the constructor of the rule from its numbers."""


def rule_named(name: str, forms: Forms = FORMS) -> Rule:
    """Return the rule whose ``str()`` is `name`, for example ``k=10 symmetrised``.

    Raises UnknownName, with the known forms, if there is no such rule; InvalidValue for a number out of its range.
    """
    for pattern, make in forms.values():
        if match := re.fullmatch(pattern, name.strip()):
            return make(*match.groups())
    raise UnknownName.among("connection rule", name, forms)
