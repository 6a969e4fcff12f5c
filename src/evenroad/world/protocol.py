"""World: what a planner asks of a robot among its obstacles."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from evenroad.space import Space


class World(Protocol):
    """Validity of configurations and of motions, always for a batch.

    Implementations never write to their arguments, give every row the verdict that it would get alone, and
    raise InvalidValue for a wrong shape or an entry that is not finite.  A motion is the shortest
    interpolation of the space; it is free only if both of its ends are, and reversing it changes nothing.
    """

    @property
    def space(self) -> Space:
        """The space that the configurations live in."""
        ...

    def valid(self, q: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return for each configuration, (n, dim), whether it is free: (n,)."""
        ...

    def motion_valid(self, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]) -> npt.NDArray[np.bool_]:
        """Return for each pair of rows of two (m, dim) arrays whether the motion is free: (m,)."""
        ...


@runtime_checkable
class Explains(Protocol):
    """A world that can say in words why a configuration is not free; planners put it into their answers."""

    def explain(self, q: npt.NDArray[np.float64]) -> str:
        """Return for one configuration, (dim,), that is not free, what it collides with."""
        ...
