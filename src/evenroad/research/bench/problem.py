"""Problem: one planning question, and where it comes from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from evenroad.points.pointset import PointSet
from evenroad.world import World


@dataclass(frozen=True, eq=False)
class Problem:
    """A world, a start and a goal.

    Attributes
    ----------
    world : World
        Says which configurations and motions are free.
    start, goal : ndarray, shape (dim,)
        Configurations of the world's space.
    set_dim : int
        Dimension of the point sets, at most the space's `cube_dim`.  Where it is smaller, as for the paper's
        SE(3) puzzles, the sets give the first coordinates of the cube and the others are drawn uniformly.
    """

    world: World
    start: npt.NDArray[np.float64]
    goal: npt.NDArray[np.float64]
    set_dim: int

    def configurations(self, points: PointSet, rng: np.random.Generator) -> npt.NDArray[np.float64]:
        """Return the set's configurations, (n, dim); `rng` draws the coordinates that the set does not give."""
        missing = self.world.space.cube_dim - self.set_dim
        cube = points.points
        if missing:
            cube = np.concatenate([cube, rng.random((points.n, missing))], axis=1)
        return self.world.space.from_cube(cube)


@dataclass(frozen=True)
class ProblemSource:
    """A named problem, or a named stream of random problems.

    Attributes
    ----------
    name : str
        What tasks and tables call it, e.g. ``maze-3``.
    set_dim : int
        As in :class:`Problem`; known without making one.
    make : callable
        From the number of an instance (>= 0; a fixed problem takes no notice of it) to the problem.  The same number
        gives the same problem in every process.
    random : bool
        Whether instances differ.
    about : str
        One line for lists and tables: geometry, protocol, source.
    """

    name: str
    set_dim: int
    make: Callable[[int], Problem]
    random: bool = False
    about: str = ""
