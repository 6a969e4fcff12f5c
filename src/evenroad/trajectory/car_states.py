"""CarTrajectory: where a car is at each time, along pieces whose curvature is constant or changes evenly."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Bools, Floats
from evenroad._checks import as_times, counted
from evenroad.trajectory.clothoid import poses_on, starts_of
from evenroad.trajectory.drive_limits import DriveLimits
from evenroad.trajectory.speed_law import Segments, SpeedLaw, fastest_law
from evenroad.world import World

_PER_CLOTHOID = 16
"""Number of parts of a clothoid, each with the largest speed of its sharper end."""
_SAME = 1e-9
"""Share of the larger curvature up to which two are the same."""


class Driven(NamedTuple):
    """States of a car at its steps, (n, 3) or (n,)."""

    positions: Floats
    velocities: Floats
    accelerations: Floats
    speeds: Floats
    curvatures: Floats


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class CarTrajectory:
    """Poses of a car at equal steps of time, from rest to rest.

    Attributes
    ----------
    start : ndarray, shape (3,)
        Pose x, y, angle.
    pieces : ndarray, shape (k, 3)
        What is driven: the curvature where each piece begins and where it ends, and its signed length.  Of a turn on
        the spot both are infinite, and the length is an angle.
    limits : DriveLimits
        Limits that it keeps.
    step : float
        Largest time between two states [s].
    deviation : float
        Largest distance of the reference point from the path that was planned.
    blends, stops : int
        Numbers of jumps of the curvature that became continuous, and at which the car stops to steer.
    proof : str
        Proof of the motion: ``exact``, ``certified`` (with blends), or ``unchecked`` in what a file says.
    source : mapping of str to JSON values
        Inputs of the ``evenroad plan`` that made it; empty if unknown.
    world : World or None
        World that it was made in; None if unknown.

    Examples
    --------
    >>> import numpy as np
    >>> import evenroad as er
    >>> grid = er.GridMap(np.zeros((60, 60), dtype=bool), resolution=0.1)
    >>> car = grid.world(footprint=[(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)], turning_radius=1.0)
    >>> er.plan(car, (2, 2, 0), (4, 2, 0)).trajectory(speed=1.0, acceleration=1.0)
    CarTrajectory(3 s, exact)
    """

    start: Floats
    pieces: Floats
    limits: DriveLimits
    step: float
    deviation: float = 0.0
    blends: int = 0
    stops: int = 0
    proof: str = "unchecked"
    source: Mapping[str, Any] = field(default_factory=dict)
    world: World | None = None

    def at(self, t: npt.ArrayLike) -> Floats:
        """Return poses x, y, angle at times, 0 <= t <= duration [s], (..., 3); angles go on beyond whole turns.

        InvalidValue for a time outside of it.
        """
        times = as_times(t, self.duration)
        return self._states(times.reshape(-1)).positions.reshape(*times.shape, 3)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it: ``.json`` (read by `load_trajectory`), ``.csv``, ``.yaml`` or ``.mcap`` (ROS 2, `nav_msgs/Path`).

        UnknownName for another suffix, BrokenFile if the file cannot be written.
        """
        from evenroad.trajectory.formats import save_trajectory

        save_trajectory(path, self)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.law.times[-1])

    @cached_property
    def times(self) -> Floats:
        """Times from 0, at equal steps, (n,) [s]."""
        return np.linspace(0.0, self.duration, math.ceil(self.duration / self.step - _SAME) + 1)

    @property
    def positions(self) -> Floats:
        """Poses x, y, angle, (n, 3)."""
        return self.states.positions

    @property
    def velocities(self) -> Floats:
        """How fast these change, (n, 3)."""
        return self.states.velocities

    @property
    def speeds(self) -> Floats:
        """Speeds along the heading, < 0 backwards, (n,)."""
        return self.states.speeds

    @property
    def curvatures(self) -> Floats:
        """Curvatures of the path, > 0 to the left, infinite in turns on the spot, (n,)."""
        return self.states.curvatures

    @cached_property
    def states(self) -> Driven:
        """The states at `times`."""
        return self._states(self.times)

    @cached_property
    def law(self) -> SpeedLaw:
        """The fastest motion along the pieces."""
        return fastest_law(_segments(self.pieces, self.limits))

    @cached_property
    def _starts(self) -> Floats:
        return starts_of(self.start, self.pieces)

    def _states(self, t: Floats) -> Driven:
        where = self.law.at(t)
        pieces = self.pieces[where.piece]
        poses = poses_on(self._starts[where.piece], pieces, where.length)
        spot, sense = np.isinf(pieces[:, 0]), np.sign(pieces[:, 2])
        first, last = (np.where(spot, 0.0, each) for each in pieces[:, :2].T)
        change = (last - first) / np.abs(pieces[:, 2])
        curvature = first + change * where.length
        speed, push = (np.where(spot, 0.0, sense * each) for each in (where.speed, where.push))
        around, faster_around = (
            np.where(spot, np.sign(pieces[:, 0]) * each, 0.0) for each in (where.speed, where.push)
        )
        across, turning = curvature * speed**2, curvature * speed + around
        faster = curvature * push + sense * change * speed**2 + faster_around
        across, ahead, aside = curvature * speed**2, np.cos(poses[:, 2]), np.sin(poses[:, 2])
        # At rest the wheels turn from the curvature before to that of the next piece.
        before = np.append(self.pieces[:1, 0], self.pieces[:-1, 1])[where.piece]
        is_rest = where.rested < 1.0
        steered = np.where(
            is_rest, np.where(is_rest, before, 0.0) * (1.0 - where.rested) + where.rested * first, curvature
        )
        return Driven(
            poses,
            np.column_stack([speed * ahead, speed * aside, turning]),
            np.column_stack([push * ahead - across * aside, push * aside + across * ahead, faster]),
            speed,
            np.where(spot, pieces[:, 0], steered),
        )

    def __repr__(self) -> str:
        made = [counted(number, what) for number, what in ((self.blends, "blend"), (self.stops, "stop")) if number]
        return f"CarTrajectory({', '.join([f'{self.duration:.4g} s', *made, self.proof])})"


def jumps_of(pieces: Floats) -> tuple[Floats, Bools]:
    """Return by how much the curvature jumps before each piece but the first, and where the car stops anyway, (k - 1,).

    It stops where it changes its direction, and before and after a turn on the spot.
    """
    before, after = pieces[:-1, 1], pieces[1:, 0]
    spot = np.isinf(before) | np.isinf(after)
    jump = np.abs(np.where(spot, 0.0, after) - np.where(spot, 0.0, before))
    jump[jump <= _SAME * np.abs(pieces[:, :2][np.isfinite(pieces[:, :2])]).max(initial=0.0)] = 0.0
    return jump, spot | (pieces[:-1, 2] * pieces[1:, 2] < 0.0)


def _segments(pieces: Floats, limits: DriveLimits) -> Segments:
    """Return the parts of pieces with the largest speed and acceleration of each."""
    jump, stops = jumps_of(pieces)
    steering = 0.0 if limits.curvature_rate is None else 1.0 / limits.curvature_rate
    rests = np.concatenate([[math.nan], np.where(stops | (jump * steering > 0.0), jump * steering, math.nan)])
    rows: list[tuple[float, float, float, float, float, float]] = []
    for number, ((first, last, signed), rest) in enumerate(zip(pieces.tolist(), rests.tolist(), strict=True)):
        count = 1 if first == last else _PER_CLOTHOID
        length = abs(signed) / count
        change = 0.0 if first == last else abs(last - first) / abs(signed)
        for k in range(count):
            sharpest = max(abs(first + (last - first) * i / count) for i in (k, k + 1)) if count > 1 else abs(first)
            within = limits.along(sharpest, change)
            rows.append((number, k * length, length, *within, math.nan if k else rest))
    table = np.array(rows)
    return Segments(table[:, 0].astype(np.int64), *table[:, 1:].T)
