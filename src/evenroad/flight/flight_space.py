"""FlightSpace: positions and velocities, with the quickest motion between two of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_row, require_positive
from evenroad._native.flight import Limits
from evenroad.errors import InvalidValue, shown
from evenroad.geometry.pose import Vector
from evenroad.space import Space
from evenroad.space.batch import as_batch, as_batch_pair, as_cube_batch, as_fractions

_LEAST = 1e-6
"""Least speed and acceleration of an axis that may move [m/s, m/s^2]."""


@explains_calls
@dataclass(frozen=True)
class FlightSpace(Space):
    """States (x, y, z, and the velocities along these): the distance of two is the least time from one to the other.

    Every axis accelerates with at most its `acceleration`, and is at most as fast as its `speed`.  A motion takes the
    least time in which all three axes can arrive together.  Each of them accelerates fully to one velocity, keeps it,
    and accelerates fully to its last velocity.  The way back is another one.

    Parameters
    ----------
    low, high : sequence of 3 floats
        Corners of the box of positions, ``low <= high`` [m].
    speed, acceleration : float or sequence of 3 floats
        Largest speed [m/s] and acceleration [m/s^2] of each axis, or of all, > 0.

    Raises
    ------
    InvalidValue
        If a number is not such a one.

    Examples
    --------
    >>> from evenroad.flight import FlightSpace
    >>> space = FlightSpace((0, 0, 0), (9, 9, 3), speed=2.0, acceleration=4.0)
    >>> space.distance([(1, 1, 1, 0, 0, 0)], [(5, 1, 1, 0, 0, 0)]).tolist()
    [2.5]
    """

    low: Vector
    high: Vector
    speed: Vector | float
    acceleration: Vector | float
    native: Limits = field(init=False, repr=False, compare=False)
    """The limits, as compiled code has them."""
    box: Floats = field(init=False, repr=False, compare=False)
    """Least and largest coordinates, (2, 6)."""

    def __post_init__(self) -> None:
        low, high = (as_row(name, getattr(self, name), 3, within=FARTHEST) for name in ("low", "high"))
        if any(least > most for least, most in zip(low, high, strict=True)):
            raise InvalidValue(f"low must be at most high on every axis, got {shown(low)} and {shown(high)}")
        speed, acceleration = (of_axes(name, getattr(self, name)) for name in ("speed", "acceleration"))
        native = Limits(np.array(speed), np.array(acceleration))
        set_fields(self, low=low, high=high, speed=speed, acceleration=acceleration, native=native)
        set_fields(self, box=np.array([(*low, *(-each for each in speed)), (*high, *speed)]))

    def __reduce__(self) -> tuple[type[FlightSpace], tuple[object, ...]]:
        """Return what a copy is made of, here or in another process."""
        return type(self), (self.low, self.high, self.speed, self.acceleration)

    @property
    def dim(self) -> int:
        """Number of coordinates: 6."""
        return 6

    @property
    def names(self) -> tuple[str, ...]:
        """What the coordinates are."""
        return "x", "y", "z", "the speed along x", "the speed along y", "the speed along z"

    @property
    def is_directed(self) -> bool:
        """Whether a motion and its reverse differ: they do."""
        return True

    @property
    def period(self) -> Floats:
        """After how much each coordinate repeats: none does."""
        return np.full(6, np.inf)

    def from_cube(self, u: Floats) -> Floats:
        """Return states evenly over positions and velocities for `u`, (n, 6) in [0, 1], as (n, 6)."""
        low, high = self.box
        return np.asarray(low + as_cube_batch(u, 6) * (high - low))

    def contains(self, q: Floats) -> Bools:
        """Return for each state, (n, 6), whether its position and its velocities are within the limits: (n,)."""
        low, high = self.box
        states = as_batch("q", q, 6)
        return np.asarray(((low <= states) & (states <= high)).all(axis=1))

    def distance(self, a: Floats, b: Floats) -> Floats:
        """Return the least time from each row of `a` to that of `b`, (n, 6), as (n,) [s]."""
        return self.native.least_times(*as_batch_pair(a, b, 6))

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return the states after a share `t`, scalar or (n,) in [0, 1], of the times of the motions, (n, 6)."""
        first, second = as_batch_pair(a, b, 6)
        share = as_fractions(t, len(first))
        between = self.native.states_between(first, second, np.ascontiguousarray(share[:, 0]))
        between[:, 3:] = np.clip(between[:, 3:], *self.box[:, 3:])  # rounding must not exceed a limit
        return np.where(share == 0.0, first, np.where(share == 1.0, second, between))


def of_axes(name: str, value: object) -> tuple[float, float, float]:
    """Return a limit of each axis, given as one number or three; InvalidValue unless they are finite and > 0."""
    if isinstance(value, Sequence | np.ndarray):
        numbers = as_row(name, value, 3)  # type: ignore[arg-type]
    else:
        numbers = (require_positive(name, value),) * 3
    if min(numbers) < _LEAST or max(numbers) > FARTHEST:
        raise InvalidValue(f"{name} must be from {_LEAST:g} to {FARTHEST:g} on every axis, got {shown(value)}")
    x, y, z = numbers
    return x, y, z
