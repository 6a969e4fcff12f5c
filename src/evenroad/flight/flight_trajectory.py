"""FlightTrajectory: where something flies at each time, along parabolas."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_times, require_positive
from evenroad._files import atomic_write
from evenroad.errors import InvalidValue, UnknownName
from evenroad.world import World

STEP = 0.01
"""Default time between two states [s]: the cycle of many flight controllers, 100 Hz."""
FORMAT = "evenroad flight 1"
_SUFFIXES = (".csv", ".json")
_MOST_STATES = 10_000_000
"""Largest number of states of a table."""
_HEADER = "time [s],x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],ax [m/s^2],ay [m/s^2],az [m/s^2]\n"


class Flown(NamedTuple):
    """Positions, velocities and accelerations at some times, (n, 3)."""

    positions: Floats
    velocities: Floats
    accelerations: Floats


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class FlightTrajectory:
    """A flight in pieces of constant acceleration, and its states at equal steps of time.

    Attributes
    ----------
    pieces : ndarray, shape (k, 10)
        Duration, position, velocity and acceleration of each piece, at its beginning [s, m, m/s, m/s^2].
    step : float
        Largest time between two states [s].
    proof : str
        Proof of the whole motion: ``certified``.
    world : World or None
        World that it was made in.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.FlightWorld(er.Scene(), speed=6.0, acceleration=8.0)
    >>> flight = er.plan(world, er.State((0, 0, 1)), er.State((9, 0, 1))).trajectory()
    >>> flight.duration, flight.at(0.25).tolist()
    (2.25, [0.25, 0.0, 1.0])
    """

    pieces: Floats
    step: float = STEP
    proof: str = "certified"
    world: World | None = field(default=None)

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self._begins[-1])

    @cached_property
    def times(self) -> Floats:
        """Times from 0, at equal steps, (n,) [s]."""
        return np.linspace(0.0, self.duration, math.ceil(self.duration / self.step - 1e-9) + 1)

    @property
    def positions(self) -> Floats:
        """Positions at `times`, (n, 3) [m]."""
        return self.states.positions

    @property
    def velocities(self) -> Floats:
        """Velocities at `times`, (n, 3) [m/s]."""
        return self.states.velocities

    @property
    def accelerations(self) -> Floats:
        """Accelerations at `times`, (n, 3) [m/s^2]."""
        return self.states.accelerations

    @cached_property
    def states(self) -> Flown:
        """The states at `times`."""
        return self._flown(self.times)

    def at(self, t: npt.ArrayLike) -> Floats:
        """Return positions at times, 0 <= t <= duration [s], (..., 3) [m]; InvalidValue for a time outside of it."""
        times = as_times(t, self.duration)
        return self._flown(times.reshape(-1)).positions.reshape(*times.shape, 3)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it: ``.csv``, the states at `times`, or ``.json``, the coefficients of the polynomials.

        In the JSON every piece has its duration and, for x, y and z, the coefficients of 1, t and t^2, where t is the
        time since the piece began.

        UnknownName for another suffix, BrokenFile if the file cannot be written.
        """
        suffix = Path(path).suffix.lower()
        if suffix not in _SUFFIXES:
            raise UnknownName.among("format of a flight", suffix or str(path), _SUFFIXES)
        data = self._as_csv() if suffix == ".csv" else self._as_json()
        with atomic_write(path) as file:
            file.write(data.encode())

    def _as_csv(self) -> str:
        rows = np.column_stack([self.times, *self.states]).tolist()
        return _HEADER + "".join(",".join(map(repr, row)) + "\n" for row in rows)

    def _as_json(self) -> str:
        pieces = []
        for row in self.pieces:
            coefficients = np.stack([row[1:4], row[4:7], 0.5 * row[7:10]], axis=1)
            pieces.append({"duration": float(row[0]), **dict(zip("xyz", coefficients.tolist(), strict=True))})
        return json.dumps({"format": FORMAT, "duration": self.duration, "proof": self.proof, "pieces": pieces}) + "\n"

    @cached_property
    def _begins(self) -> Floats:
        """When each piece begins, and the last one ends, (k + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.pieces[:, 0])])

    def _flown(self, times: Floats) -> Flown:
        number = np.clip(np.searchsorted(self._begins, times, side="right") - 1, 0, len(self.pieces) - 1)
        t = (times - self._begins[number])[:, np.newaxis]
        position, velocity, acceleration = np.split(self.pieces[number, 1:], 3, axis=1)
        return Flown(position + t * (velocity + 0.5 * t * acceleration), velocity + t * acceleration, acceleration)

    def __repr__(self) -> str:
        return f"FlightTrajectory({self.duration:.4g} s, {self.proof})"


def flight_trajectory(world: World, pieces: Floats, *, step: float = STEP) -> FlightTrajectory:
    """Return the trajectory of pieces, (k, 10), whose states are at most a `step` apart [s]."""
    step = require_positive("step", step)
    if float(pieces[:, 0].sum()) / step > _MOST_STATES:
        raise InvalidValue(f"step must be larger: there would be more than {_MOST_STATES} states, got {step:g} s")
    return FlightTrajectory(pieces=pieces, step=step, proof="certified", world=world)
