"""CarSpace: poses of a car on a map, with the shortest curve that it can drive between two of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import require_positive
from evenroad._native.drive import Steering
from evenroad.space import Circle, Product, Rectangle, Space
from evenroad.space.batch import as_batch_pair, as_fractions


@explains_calls
@dataclass(frozen=True)
class CarSpace(Space):
    """The poses (x, y, angle) of a car: the distance of two is the length of the shortest curve that leads there.

    Curves are those of Reeds and Shepp (1990), straight drives and turns at the least radius, forwards and backwards;
    without `reverse` those of Dubins (1957), and then the distance from `a` to `b` is not that from `b` to `a`.
    With a radius of 0 the car turns on the spot, drives straight, and turns again.

    Parameters
    ----------
    positions : Rectangle
        Where the reference point may be.
    turning_radius : float
        Least radius of a turn, >= 0; 0 turns on the spot.
    reverse : bool
        Whether the car may drive backwards.
    spot : float
        Length that counts for a radian of a turn on the spot, > 0.

    Raises
    ------
    InvalidValue
        If a number is not such a one.

    Examples
    --------
    >>> import evenroad as er
    >>> from evenroad.driving import CarSpace
    >>> space = CarSpace(er.spaces.Rectangle((0, 0), (9, 0), (0, 9)), turning_radius=1.0)
    >>> space.distance([(1, 1, 0)], [(5, 1, 0)]).tolist()
    [4.0]
    """

    positions: Rectangle
    turning_radius: float = 0.0
    reverse: bool = True
    spot: float = 1.0
    steering: Steering = field(init=False, repr=False, compare=False)
    _poses: Product = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        radius = require_positive("turning_radius", self.turning_radius, or_zero=True, at_most=1e9)
        spot = require_positive("spot", self.spot, at_most=1e9)
        steering = Steering(radius, spot, bool(self.reverse), 0.0)
        poses = Product((self.positions, Circle()), combine="l2")
        set_fields(self, turning_radius=radius, spot=spot, steering=steering, _poses=poses)

    def __reduce__(self) -> tuple[type[CarSpace], tuple[object, ...]]:
        """Return what a copy is made of, here or in another process."""
        return type(self), (self.positions, self.turning_radius, self.reverse, self.spot)

    @property
    def dim(self) -> int:
        """Number of coordinates: 3."""
        return 3

    @property
    def names(self) -> tuple[str, str, str]:
        """What the coordinates are."""
        return "x", "y", "the angle"

    @property
    def is_directed(self) -> bool:
        """Whether a motion and its reverse differ: of a car that drives only forwards."""
        return not self.reverse

    @property
    def period(self) -> Floats:
        """After how much each coordinate repeats: the angle after 2 pi."""
        return np.array([np.inf, np.inf, 2.0 * math.pi])

    def from_cube(self, u: Floats) -> Floats:
        """Return poses evenly over positions and angles for `u`, (n, 3) in [0, 1], as (n, 3)."""
        return self._poses.from_cube(u)

    def contains(self, q: Floats) -> Bools:
        """Return for each pose, (n, 3), whether its reference point is in the rectangle: (n,)."""
        return self._poses.contains(q)

    def wrapped(self, q: Floats) -> Floats:
        """Return poses, (n, 3), with angles in [-pi, pi)."""
        return self._poses.wrapped(q)

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the length of the shortest curve from each row of `a` to that of `b`, (n, 3), as (n,)."""
        return self.steering.distances(*as_batch_pair(a, b, 3))

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the poses after a share `t`, scalar or (n,) in [0, 1], of the shortest curves, (n, 3)."""
        first, second = as_batch_pair(a, b, 3)
        share = as_fractions(t, len(first))
        between = self.wrapped(self.steering.poses_between(first, second, np.ascontiguousarray(share[:, 0])))
        return np.where(share == 0.0, first, np.where(share == 1.0, second, between))

    def pieces(self, a: Floats, b: Floats) -> Floats:
        """Return the shortest curve from one pose, (3,), to another, piece by piece.

        Parameters
        ----------
        a, b : array_like, shape (3,)

        Returns
        -------
        ndarray, shape (k, 2)
            The curvature, positive to the left, and the length of each piece, negative backwards.  A turn on the spot
            has an infinite curvature and an angle, >= 0, in place of the length.

        Examples
        --------
        >>> import evenroad as er
        >>> from evenroad.driving import CarSpace
        >>> space = CarSpace(er.spaces.Rectangle((0, 0), (9, 0), (0, 9)), turning_radius=2.0)
        >>> space.pieces((1, 1, 0), (3, 3, 1.5707963267948966)).round(3).tolist()
        [[0.5, 3.142]]
        """
        first, second = as_batch_pair([a], [b], 3)
        return as_pieces(self.steering.pieces_between(first[0], second[0]), self)


def as_pieces(rows: Floats, space: CarSpace) -> Floats:
    """Return curvatures and signed lengths, (k, 2), of the sides and lengths that compiled code has."""
    side, length = rows[np.abs(rows[:, 1]) > _NO_LENGTH].T
    if space.turning_radius > 0.0:
        return np.column_stack([side / space.turning_radius, length])
    on_the_spot = side != 0.0
    curvature = np.where(on_the_spot, np.copysign(np.inf, side), 0.0)
    return np.column_stack([curvature, length / np.where(on_the_spot, space.spot, 1.0)])


def rows_of(pieces: Floats, space: CarSpace) -> Floats:
    """Return the sides and lengths, (k, 2), that compiled code has, of curvatures and signed lengths."""
    on_the_spot = np.isinf(pieces[:, 0])
    return np.column_stack([np.sign(pieces[:, 0]), np.where(on_the_spot, space.spot * pieces[:, 1], pieces[:, 1])])


def cusps_of(pieces: Floats) -> int:
    """Return how often pieces, (k, 2), change between forwards and backwards; turns on the spot do not count."""
    signs = np.sign(pieces[np.isfinite(pieces[:, 0]), 1])
    return int(np.count_nonzero(signs[1:] != signs[:-1]))


_NO_LENGTH = 1e-12
"""Pieces that are shorter are left out, in map units."""
