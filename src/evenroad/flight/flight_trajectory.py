"""FlightTrajectory: where something flies at each time, along parabolas."""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from evenroad._arrays import Floats
from evenroad._checks import as_row, as_times, require_positive
from evenroad._files import Json, atomic_write
from evenroad.errors import BrokenFile, InvalidValue, UnknownName
from evenroad.world import World

STEP = 0.01
"""Default time between two states [s]: the cycle of many flight controllers, 100 Hz."""
FORMAT = "evenroad flight 1"
_UP = np.array((0.0, 0.0, 9.80665))
"""Thrust by the mass that keeps a multirotor at its height [m/s^2]."""
_NO_THRUST = 1e-9
_JOINED = 1e-6
"""Largest jump between two pieces of a file, as a share of the largest number [m, m/s]."""
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
        Proof of the whole motion: ``certified``, or ``unchecked`` of one from a file, which has no world.
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

    @property
    def most_thrust(self) -> float:
        """Largest thrust of a multirotor by its mass on the whole flight [m/s^2]: it is constant in each piece."""
        return float(np.linalg.norm(self.pieces[:, 7:] + _UP, axis=1).max())

    @property
    def most_tilt(self) -> float:
        """Largest angle between a multirotor's axis and the vertical on the whole flight [rad]."""
        thrusts = self.pieces[:, 7:] + _UP
        return float(np.arctan2(np.hypot(thrusts[:, 0], thrusts[:, 1]), thrusts[:, 2]).max())

    def attitudes(self, yaw: float = 0.0) -> Floats:
        """Return the attitudes of a multirotor at `times` as rotation matrices, (n, 3, 3); they jump between pieces.

        Their third columns point along the thrust, acceleration less gravity, and their first ones are the nearest to a
        horizontal direction: at an angle of `yaw` from x [rad].  InvalidValue where a piece has no such attitude.
        """
        angle = as_row("yaw", [yaw], 1)[0]
        up = self.accelerations + _UP
        aside = np.cross(up, (np.cos(angle), np.sin(angle), 0.0))
        lengths = np.linalg.norm(up, axis=1, keepdims=True), np.linalg.norm(aside, axis=1, keepdims=True)
        if min(each.min() for each in lengths) < _NO_THRUST:
            raise InvalidValue("there is no attitude where a flight falls freely, or the thrust points along the yaw")
        up, aside = up / lengths[0], aside / lengths[1]
        return np.stack([np.cross(aside, up), aside, up], axis=2)

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


def flight_trajectory(world: World | None, pieces: Floats, *, step: float = STEP) -> FlightTrajectory:
    """Return the trajectory of pieces, (k, 10), whose states are at most a `step` apart [s]."""
    step = require_positive("step", step)
    if float(pieces[:, 0].sum()) / step > _MOST_STATES:
        raise InvalidValue(f"step must be larger: there would be more than {_MOST_STATES} states, got {step:g} s")
    return FlightTrajectory(pieces=pieces, step=step, proof="certified", world=world)


def flight_of(record: Json, path: str | os.PathLike[str]) -> FlightTrajectory:
    """Return the flight of a JSON record of a file, unchecked and without its world; BrokenFile if it is damaged."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            return _joined(np.array([_piece_of(each) for each in record["pieces"]]))
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise BrokenFile(f"{path} is a damaged flight: {error}") from error


def _joined(pieces: Floats) -> FlightTrajectory:
    """Return the flight of pieces, (k, 10); ValueError if they do not join."""
    if not len(pieces) or not np.isfinite(pieces).all() or pieces[:, 0].min() < 0.0:
        raise ValueError("its pieces must be finite numbers, with durations of at least 0 s")
    t = pieces[:-1, :1]
    reached = pieces[:-1, 1:7] + t * pieces[:-1, 4:10]
    reached[:, :3] += 0.5 * t * t * pieces[:-1, 7:]
    jump = np.abs(reached - pieces[1:, 1:7]).max(initial=0.0)
    if not jump <= _JOINED * (1.0 + np.abs(pieces).max()):
        raise ValueError("its pieces do not join")
    return replace(flight_trajectory(None, pieces), proof="unchecked")


def _piece_of(each: Json) -> list[float]:
    rows = np.array([each[axis] for axis in "xyz"], dtype=float).reshape(3, 3)
    return [float(each["duration"]), *rows[:, 0], *rows[:, 1], *(2.0 * rows[:, 2])]
