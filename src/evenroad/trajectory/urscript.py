"""URScript: a trajectory as a program for the controller of a UR arm, state by state or by corners."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats
from evenroad.errors import InvalidValue
from evenroad.trajectory.corners import drivable
from evenroad.trajectory.trajectory import Trajectory
from evenroad.world import World

CYCLES = (0.008, 0.002)
"""Cycle times of the controllers [s]: CB3 (125 Hz) and e-Series (500 Hz)."""

LOOKAHEAD = 0.1
"""Time over which the controller smooths ``servoj`` commands [s]."""

_STILL = 1e-6
"""Speed of an arm that is at rest [rad/s]."""
_JOINTS = 6
_AT_START = 0.01
"""Largest distance of a joint from the start at which the program begins [rad]."""

_FASTEST = 3.14
"""Largest speed of a ``movej`` that the controller accepts [rad/s]."""

_SAME = 1e-6
"""Largest distance of a state from the waypoint at which the arm rests [rad]."""

_SHARES = (0.45, 0.2, 0.1, 0.05)
"""Shares of the shorter motion at a corner to try in turn as blends; two corners never overlap."""

_CHORDS = 16


def servoj_script(trajectory: Trajectory, order: Sequence[str] | None = None) -> str:
    """Return a program of ``servoj`` that drives through one state per cycle and waits at the last one.

    Raises InvalidValue unless there are six joints and the states are 8 ms (CB3) or 2 ms (e-Series) apart.
    """
    _, (positions, _, _) = columns_of_ur(trajectory, order)
    cycle = trajectory.step
    if not np.isclose(cycle, CYCLES).any():
        raise InvalidValue(
            f"URScript needs states 0.008 s apart (CB3) or 0.002 s (e-Series), these are {cycle:.6g} s apart"
        )
    states = np.concatenate([positions[1:], np.repeat(positions[-1:], held_cycles(cycle), axis=0)])
    moves = [f"servoj({_row(q)}, t={cycle:g}, lookahead_time={LOOKAHEAD:g}, gain=300)" for q in states]
    return _program("evenroad_servoj", positions[0], [*moves, "stopj(2.0)"])


def held_cycles(cycle: float) -> int:
    """Return the number of repetitions of the last state, because an arm lags by about its lookahead time."""
    return math.ceil(2.0 * LOOKAHEAD / cycle)


def movej_script(trajectory: Trajectory, order: Sequence[str] | None = None) -> str:
    """Return a program of ``movej`` that drives to each waypoint of the path.

    Corners are rounded by `radii`; without these it stops at each.  All joints keep the limits of the slowest one.
    If the trajectory waits at a waypoint, the program sleeps.  Raises InvalidValue unless there are six joints.
    """
    names, _ = columns_of_ur(trajectory, order)
    path = trajectory.waypoints
    columns = {name: np.full(len(path), value) for name, value in trajectory.held.items()}
    columns |= dict(zip(trajectory.names, path.T, strict=True))
    waypoints = np.column_stack([columns[name] for name in names])
    radii = [*(trajectory.radii or np.zeros(len(path) - 2)), 0.0]
    fastest = (
        f"a={min(trajectory.limits.symmetric().acceleration):.6g}, v={min(*trajectory.limits.velocity, _FASTEST):.6g}"
    )
    first, *waits = _waits(trajectory)
    moves = [f"sleep({first:.6g})"] if first else []
    for q, radius, wait in zip(waypoints[1:], radii, waits, strict=True):
        moves.append(f"movej({_row(q)}, {fastest}, r={0.0 if wait else radius:.6g})")
        moves += [f"sleep({wait:.6g})"] if wait else []
    return _program("evenroad_movej", waypoints[0], moves)


def _waits(trajectory: Trajectory) -> list[float]:
    """Return the time that the trajectory rests at each of its waypoints [s]."""
    positions, step = trajectory.positions, trajectory.step
    waits, waypoint = [0.0] * len(trajectory.waypoints), 0
    for i in np.flatnonzero((positions[1:] == positions[:-1]).all(axis=1)):
        near = np.abs(trajectory.waypoints[waypoint:] - positions[i]).max(axis=1) < _SAME
        waypoint += int(np.argmax(near)) if near.any() else 0
        waits[waypoint] += step
    return waits


def with_radii(trajectory: Trajectory, world: World, tip_at: Callable[[Floats], Floats]) -> Trajectory:
    """Return the trajectory with radii around corners within which a controller may leave the path.

    The controller stays within the triangle of the corner and the two points where it leaves and returns.  A radius is
    allowed if straight motions between its sides, at sixteenths of them, are free.

    Parameters
    ----------
    trajectory : Trajectory
    world : World
        World that checks configurations of the trajectory.
    tip_at : callable
        Returns the positions of the tip, (n, 3) [m], at configurations, (n, dim).
    """
    path, radii = trajectory.waypoints, []
    for before, corner, after in zip(path[:-2], path[1:-1], path[2:], strict=True):
        reach = next((share for share in _SHARES if _triangle_free(world, before, corner, after, share)), 0.0)
        radii.append(_radius(tip_at, before, corner, after, reach))
    return replace(trajectory, radii=tuple(radii))


def _triangle_free(world: World, before: Floats, corner: Floats, after: Floats, share: float) -> bool:
    sides = np.linspace(0.0, share, _CHORDS + 1)[1:, None]
    leaves, returns = corner + sides * (before - corner), corner + sides * (after - corner)
    return all(drivable(world, np.array(chord))[0].all() for chord in zip(leaves, returns, strict=True))


def _radius(tip_at: Callable[[Floats], Floats], before: Floats, corner: Floats, after: Floats, share: float) -> float:
    """Return the largest radius [m] that the tip reaches only within a `share` of the motions at the corner."""
    if share == 0.0:
        return 0.0
    beyond = np.linspace(share, 1.0, 64)[:, None]
    around = np.concatenate([corner + beyond * (before - corner), corner + beyond * (after - corner)])
    gap = np.linalg.norm(tip_at(around) - tip_at(corner[None]), axis=1)
    return float(np.min(gap))


def columns_of_ur(
    trajectory: Trajectory, order: Sequence[str] | None
) -> tuple[tuple[str, ...], tuple[Floats, Floats, Floats]]:
    """Return `Trajectory.columns` for the six joints of a UR arm; InvalidValue for another number of joints."""
    names, tables = trajectory.columns(order)
    if len(names) != _JOINTS:
        raise InvalidValue(f"URScript needs the six joints of a UR arm, got {len(names)}: {', '.join(names)}")
    if np.abs(trajectory.velocities[[0, -1]]).max() > _STILL:
        raise InvalidValue("a UR arm starts and stops at rest, but the trajectory begins or ends in motion")
    return names, tables


def _program(name: str, start: Floats, moves: Sequence[str]) -> str:
    """Return a program that moves only from the start."""
    lines = [
        f"def {name}():",
        f"  start = {_row(start)}",
        "  actual = get_actual_joint_positions()",
        "  i = 0",
        f"  while i < {_JOINTS}:",
        f"    if norm(actual[i] - start[i]) > {_AT_START}:",
        '      popup("The robot is not at the start of this path.", title="evenroad", error=True, blocking=True)',
        "      halt",
        "    end",
        "    i = i + 1",
        "  end",
        *(f"  {move}" for move in moves),
        "end",
        f"{name}()",
    ]
    return "".join(line + "\n" for line in lines)


def _row(q: Floats) -> str:
    return "[" + ", ".join(f"{value:.9g}" for value in q) + "]"
