"""Sender of trajectories to a UR arm, state by state, through ur_rtde, after all checks."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any, TypeAlias

import numpy as np

from evenroad._arrays import Floats
from evenroad._checks import require_extra, require_positive
from evenroad.errors import EvenroadError, InvalidValue, NotAvailable
from evenroad.trajectory.trajectory import Trajectory
from evenroad.trajectory.urscript import CYCLES, LOOKAHEAD, columns_of_ur, held_cycles

AT_START = 0.01
"""Largest distance of a joint from the start at which a program begins [rad]."""

ASTRAY = 0.3
"""Distance of a joint from its set value above which the arm is stopped [rad]."""

_RUNNING, _NORMAL, _REDUCED = 7, 1, 2
"""Mode of a robot with released brakes, and the two safety modes in which it may move."""

_READ = ["timestamp", "actual_q", "robot_mode", "safety_mode", "runtime_state"]
_PATIENCE = 8.0
"""Time without a message after which the connection counts as lost [s]."""

Rtde: TypeAlias = Any
"""A connection of ur_rtde, whose bindings have no types."""
_ERRORS = {kind.__name__: kind for kind in (InvalidValue, NotAvailable)}
_GAIN = 300.0
_STOP = 2.0
"""Deceleration at the end, and after a fault [rad/s^2]."""


@dataclass(frozen=True)
class _Drive:
    """States for an arm, (n, joints) [rad], one per cycle [s], with its address, model and joints."""

    host: str
    model: str
    names: Sequence[str]
    positions: Floats
    cycle: float
    go: bool


@dataclass(frozen=True)
class Sent:
    """Number of states sent, and the largest error of a joint [rad]."""

    states: int
    largest_error: float


def send_trajectory(
    trajectory: Trajectory,
    host: str,
    *,
    model: str,
    fastest: float,
    go: bool = False,
    order: Sequence[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Sent:
    """Drive a UR arm along a trajectory; without `go`, only check it.

    One state is sent per cycle, so the controller stops the arm by itself when the connection is lost.

    Parameters
    ----------
    trajectory : Trajectory
        Six joints, states 8 ms (CB3) or 2 ms (e-Series) apart; checked in a world.
    host : str
        Address of the controller.
    model : str
        Model of the arm, as its controller names it: ``UR5``.
    fastest : float
        Limit of each joint's speed, > 0 [rad/s].
    go : bool
        Whether to move the arm.
    order : sequence of str, optional
        As for :func:`save_trajectory`.
    progress : callable, optional
        Called with the number of states sent and the number of all.

    Raises
    ------
    InvalidValue
        If the trajectory is unchecked, too fast, or not for a UR arm; or if the arm is another model, not ready, or not
        at the start.
    NotAvailable
        If ur_rtde is not installed, the connection fails, the arm deviates from the trajectory, or it was stopped.
    """
    names, positions, cycle = checked_states(trajectory, fastest, order)
    spawned = multiprocessing.get_context("spawn")
    ours, theirs = spawned.Pipe()
    drive = _Drive(host, model, names, positions, cycle, go)
    process = spawned.Process(target=_talk, args=(theirs, drive), daemon=True)
    process.start()
    theirs.close()
    try:
        return _listened(ours, host, progress)
    finally:
        # Without a listener, as after Ctrl-C, the process stops the arm. If it hangs, the controller stops the arm.
        ours.close()
        process.join(_PATIENCE)
        process.kill()
        process.join()


def checked_states(
    trajectory: Trajectory, fastest: float, order: Sequence[str] | None = None
) -> tuple[Sequence[str], Floats, float]:
    """Return the joints, positions, (n, joints), and cycle [s] to send.

    Parameters and errors are those of :func:`send_trajectory`.
    """
    limit = require_positive("fastest", fastest)
    if trajectory.proof == "unchecked":
        raise InvalidValue("nobody has checked the trajectory in its world: proved_in of evenroad.trajectory does")
    names, (positions, velocities, _) = columns_of_ur(trajectory, order)
    cycle = trajectory.step
    if not np.isclose(cycle, CYCLES).any():
        raise InvalidValue(f"a controller takes a state every 0.008 s or 0.002 s, these are {cycle:g} s apart")
    # Speeds between the states to send count, too.
    driven = np.abs(np.diff(positions, axis=0)) / cycle
    speeds = np.maximum(np.abs(velocities).max(axis=0), driven.max(axis=0, initial=0.0))
    if speeds.max() > limit * (1.0 + 1e-9):
        name = names[int(np.argmax(speeds))]
        raise InvalidValue(f"{name} moves at up to {speeds.max():.3g} rad/s, faster than the {limit:g} rad/s allowed")
    return names, positions, cycle


def _listened(pipe: Connection, host: str, progress: Callable[[int, int], None] | None) -> Sent:
    """Return the result of the process that talks to the arm; raise NotAvailable if it is silent."""
    while True:
        if not pipe.poll(_PATIENCE):
            raise NotAvailable(f"lost the connection to {host!r}; the controller stops the arm by itself")
        try:
            kind, *said = pipe.recv()
        except EOFError:
            raise NotAvailable(f"lost the connection to {host!r}: what talked to it died") from None
        if kind == "sent" and progress is not None:
            progress(*said)
        elif kind == "done":
            return Sent(*said)
        elif kind in _ERRORS:
            raise _ERRORS[kind](said[0])


def _talk(pipe: Connection, drive: _Drive) -> None:
    """Check, and drive if `go`, in a separate process, because ur_rtde may wait for ever."""
    try:
        pipe.send(("ready", 0))
        sent = _checked_and_driven(pipe, drive)
        pipe.send(("done", sent.states, sent.largest_error))
    except EvenroadError as error:
        pipe.send((type(error).__name__, str(error)))
    except (KeyboardInterrupt, OSError):
        # The parent process is gone or interrupted.
        pass


def _checked_and_driven(pipe: Connection, drive: _Drive) -> Sent:
    receive = require_extra("rtde_receive", "ur", "sending to an arm")
    with _connection_to(drive.host):
        state = receive.RTDEReceiveInterface(drive.host, 1.0 / drive.cycle, _READ)
    try:
        _require_ready(state, drive)
        if not drive.go:
            return Sent(0, 0.0)
        controls = require_extra("rtde_control", "ur", "sending to an arm")
        with _connection_to(drive.host):
            control = controls.RTDEControlInterface(drive.host, 1.0 / drive.cycle)
        return _driven(pipe, control, state, drive)
    finally:
        with suppress(Exception):
            state.disconnect()


@contextmanager
def _connection_to(host: str) -> Iterator[None]:
    """Turn errors of ur_rtde into one line about the controller."""
    try:
        yield
    except EvenroadError:
        raise
    except (RuntimeError, ValueError, OSError) as error:
        raise NotAvailable(f"no answer that makes sense from a controller at {host!r}: {error}") from None


def _require_ready(state: Rtde, drive: _Drive) -> None:
    host, model, start = drive.host, drive.model, drive.positions[0]
    dashboards = require_extra("dashboard_client", "ur", "sending to an arm")
    with _connection_to(host):
        dashboard = dashboards.DashboardClient(host)
        dashboard.connect(2000)
        there = str(dashboard.getRobotModel()).strip()
        dashboard.disconnect()
    if there.lower() != model.lower():
        raise InvalidValue(f"the arm at {host} is a {there}, not a {model}")
    with _connection_to(host):
        q = np.array(state.getActualQ(), dtype=np.float64)
        mode, safety = state.getRobotMode(), state.getSafetyMode()
    if mode != _RUNNING or safety not in (_NORMAL, _REDUCED):
        raise InvalidValue(f"the arm at {host} is not ready to move: robot mode {mode}, safety mode {safety}")
    if q.shape != start.shape:
        raise NotAvailable(f"the controller at {host} does not say where the arm is")
    off = np.abs(q - start)
    if off.max() > AT_START:
        i = int(np.argmax(off))
        raise InvalidValue(
            f"the arm is not at the start: {drive.names[i]} is at {q[i]:.4f} rad,"
            f" more than {AT_START} from {start[i]:.4f}"
        )


def _driven(pipe: Connection, control: Rtde, state: Rtde, drive: _Drive) -> Sent:
    """Send the states; stop the arm in any case."""
    positions, cycle, worst, i = drive.positions, drive.cycle, 0.0, 0
    try:
        # The last state is repeated until the arm has caught up.
        states = np.concatenate([positions, np.repeat(positions[-1:], held_cycles(cycle), axis=0)])
        for i, q in enumerate(states):
            began = control.initPeriod()
            sent = control.servoJ(q.tolist(), 0.0, 0.0, cycle, LOOKAHEAD, _GAIN)
            if not sent or not state.isConnected():
                raise RuntimeError("no answer")
            if state.getSafetyMode() not in (_NORMAL, _REDUCED):
                raise NotAvailable(f"the arm was stopped after {i * cycle:.3f} s by its safety")
            off = np.abs(np.array(state.getActualQ()) - q)
            worst = max(worst, float(off.max()))
            if worst > ASTRAY:
                name = drive.names[int(np.argmax(off))]
                raise NotAvailable(f"stopped after {i * cycle:.3f} s: {name} is {worst:.3f} rad astray")
            pipe.send(("sent", i + 1, len(states)))
            control.waitPeriod(began)
    except RuntimeError as error:
        raise NotAvailable(
            f"lost the connection after {i * cycle:.3f} s; the controller stops the arm by itself ({error})"
        ) from None
    finally:
        # The arm also stops after Ctrl-C.
        with suppress(Exception):
            control.servoStop(_STOP)
        with suppress(Exception):
            control.stopScript()
    return Sent(len(states), worst)
