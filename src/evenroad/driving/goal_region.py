"""GoalRegion: positions and angles of which any one will do as the goal of a car, or of a disk."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import as_row, require_positive
from evenroad.errors import InvalidValue

_STEPS = 0.8191725133961645, 0.6710436067037893, 0.5497004779019703
"""Steps of a sequence that fills a cube evenly: powers of a generalised golden ratio."""


@explains_calls
@dataclass(frozen=True)
class GoalRegion:
    """A disk or a box of positions, with any angle or a range of angles, of which one is to be reached.

    Parameters
    ----------
    centre : array_like, shape (2,)
        Its middle, in map units.
    radius : float
        Of a disk of positions, >= 0.  Default: 0, the middle alone.
    size : array_like, shape (2,), optional
        In place of a radius: lengths of a box along x and y, >= 0.
    angle : float, optional
        Angle of the goal [rad].  Default: any.
    within : float
        With an angle: by how much it may differ, 0 to pi [rad].

    Raises
    ------
    InvalidValue
        If a number is not such a one, or both a radius and a size are given.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> from evenroad.driving import GoalRegion
    >>> grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    >>> car = grid.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=1.0)
    >>> result = er.plan(car, (2, 2, 0), GoalRegion((4, 4), radius=0.5, angle=1.57, within=0.3))
    >>> bool(np.hypot(*(result.path[-1][:2] - (4, 4))) <= 0.5)
    True
    """

    centre: Sequence[float]
    radius: float = 0.0
    size: Sequence[float] | None = None
    angle: float | None = None
    within: float = 0.0
    half: Floats = field(init=False, repr=False, compare=False)
    """Half the lengths of a box around it, (2,)."""

    def __post_init__(self) -> None:
        centre = as_row("centre", self.centre, 2)
        radius = require_positive("radius", self.radius, or_zero=True)
        if self.size is not None and radius > 0.0:
            raise InvalidValue("a goal region is a disk, with radius=, or a box, with size=; give one of the two")
        half = np.full(2, radius) if self.size is None else 0.5 * np.array(as_row("size", self.size, 2))
        if (half < 0.0).any():
            raise InvalidValue(f"size must be two lengths >= 0, got {self.size!r}")
        if self.angle is not None and not (math.isfinite(self.angle) and abs(self.angle) <= 4.0 * math.pi):
            raise InvalidValue(f"angle must be at most 4 pi in radians, got {self.angle!r}")
        within = require_positive("within", self.within, or_zero=True, at_most=math.pi)
        if within > 0.0 and self.angle is None:
            raise InvalidValue(
                "within= goes with angle=, from which the goal's may differ; without both any angle will do"
            )
        set_fields(self, centre=centre, radius=radius, half=half, within=within)

    @property
    def middle(self) -> Floats:
        """Its middle, (2,)."""
        return np.asarray(self.centre, dtype=np.float64)

    @property
    def angles(self) -> tuple[float, float]:
        """The middle of its angles, and by how much they differ from it."""
        return (0.0, math.pi) if self.angle is None else (self.angle, self.within)

    def sampled(self, count: int, dim: int) -> Floats:
        """Return configurations that fill the region evenly, the middle first.

        Parameters
        ----------
        count : int
            Number of tries; of a disk fewer configurations lie in it.
        dim : int
            2 for positions, 3 for poses.

        Returns
        -------
        ndarray, shape (n, dim)

        Examples
        --------
        >>> from evenroad.driving import GoalRegion
        >>> GoalRegion((4, 4), radius=0.5, angle=1.0).sampled(100, 3)[0].tolist()
        [4.0, 4.0, 1.0]
        """
        share = 2.0 * ((0.5 + np.outer(np.arange(count), _STEPS)) % 1.0) - 1.0
        middle, within = self.angles
        if self.size is None:
            share = share[np.hypot(share[:, 0], share[:, 1]) <= 1.0]
        poses = np.column_stack([self.middle + share[:, :2] * self.half, middle + within * share[:, 2]])
        # A region of one position, or of one pose, has it once.
        return np.unique(poses[:, :dim], axis=0) if not self.half.any() and within == 0.0 else poses[:, :dim]
