"""ChainWorld: a planar chain in a horn, the kinematic chain benchmark."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from evenroad._checks import require_count
from evenroad.errors import InvalidValue
from evenroad.research.worlds.chain.horn import horn
from evenroad.research.worlds.chain.kernel import FREE, SELF, WALL, motions_are_free, verdicts
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.chain import ChainSpace

_END_PIECE = 0.001
"""Length by which the last link is longer than the others, as one more segment."""

_REASONS = {SELF: "two links of the chain cross", WALL: "a link crosses the horn"}


@dataclass(frozen=True)
class ChainWorld:
    """A planar chain of equal links that must cross neither itself nor the walls of :func:`horn`.

    OMPL's kinematic chain benchmark.  A configuration is free if no two of the segments (the links, and a piece of
    .001 that goes on after the last) and no segment and wall cross.  Segments that are parallel or only touch do
    not cross.  A motion turns all joints the short way; it is divided into ``ceil(distance / resolution)`` segments,
    whose ends are tested in bisection order.

    Parameters
    ----------
    links : int
        Number of links, >= 2.

    Raises
    ------
    InvalidValue
        If `links` is not such a number.
    """

    links: int = 10
    _space: ChainSpace = field(init=False, repr=False, compare=False)
    _walls: npt.NDArray[np.float64] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        links = require_count("links", self.links, at_least=2)
        if links > 1000:
            raise InvalidValue(f"links must be at most 1000, got {self.links!r}")
        walls = horn(links)
        walls.setflags(write=False)
        for name, value in (("links", links), ("_space", ChainSpace(links)), ("_walls", walls)):
            object.__setattr__(self, name, value)

    @property
    def space(self) -> ChainSpace:
        """The joint angles, measured in the plane."""
        return self._space

    @property
    def walls(self) -> npt.NDArray[np.float64]:
        """The walls, (4, 2 (links - 1)): a column x, y, dx, dy for each segment; read-only."""
        return self._walls

    @property
    def resolution(self) -> float:
        """Largest distance between tested states, ``.01 sqrt(links) 2 pi``: a hundredth of the angles' range."""
        return 0.01 * math.sqrt(self.links) * 2.0 * math.pi

    @property
    def start(self) -> npt.NDArray[np.float64]:
        """The chain bent to a half circle inside the horn: (0, pi / links, .., pi / links)."""
        return np.array([0.0] + [math.pi / self.links] * (self.links - 1))

    @property
    def goal(self) -> npt.NDArray[np.float64]:
        """The chain stretched out to the other side: (pi - .001, 0, .., 0)."""
        return np.array([math.pi - 0.001] + [0.0] * (self.links - 1))

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which configurations, (n, links), are free: (n,).

        Raises
        ------
        InvalidValue
            If `q` has another shape or an entry that is not finite.
        """
        return verdicts(as_batch("q", q, self.links), self._walls, _END_PIECE) == FREE

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return which motions from each row of `a` to that of `b`, two (m, links) arrays, are free: (m,).

        Raises
        ------
        InvalidValue
            If the two differ in length, or as `valid`.
        """
        first, second = as_batch_pair(a, b, self.links)
        return motions_are_free(
            self._space.wrapped(first), self._space.wrapped(second), self.resolution, self._walls, _END_PIECE
        )

    def explain(self, q: npt.NDArray[np.float64]) -> str:
        """Return in words why the configuration `q`, (links,), is not free."""
        batch = as_batch("q", np.asarray(q, dtype=np.float64)[np.newaxis], self.links)
        return _REASONS[int(verdicts(batch, self._walls, _END_PIECE)[0])]
