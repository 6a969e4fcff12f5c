"""Cartesian lines: the tip approaches its goal, and leaves its start, in straight lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import require_positive
from evenroad.errors import InvalidValue
from evenroad.geometry.pose import Pose, Vector
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.chain import Chain
from evenroad.robot.constraint import Constraint
from evenroad.robot.pose_goal import as_axis
from evenroad.robot.pose_task import PoseTask

STEP = 0.005
"""Distance between configurations of a line [m]."""

FINE = 16
"""Number of states between two of these, at which the distance of the tip from the line is measured."""

_LONGEST = 0.2
"""Largest movement of a joint in such a step [rad or m]."""


@dataclass(frozen=True)
class CartesianLine(Constraint):
    """Straight lines of a tip at constant rotation.

    Parameters
    ----------
    approach, retreat : float
        Lengths of the lines to the goal and from the start, >= 0 [m].
    away : sequence of 3 floats, "x", "-x", ..., or "up"
        Direction in which the tip leaves its start, and from which it approaches its goal: in the frame of the tip, or
        along the root's z axis.
    tip : str
        The link of the tip; default: that of the goal poses, or the last one.
    line_tolerance, angle_tolerance : float
        Largest deviations from the line and the rotation, > 0 [m, rad].
    """

    approach: float = 0.0
    retreat: float = 0.0
    away: Vector | str = "-z"
    tip: str = ""
    line_tolerance: float = 1e-3
    angle_tolerance: float = 1e-2

    def __post_init__(self) -> None:
        for name in ("approach", "retreat"):
            set_fields(self, **{name: require_positive(name, getattr(self, name), or_zero=True)})
        for name in ("line_tolerance", "angle_tolerance"):
            set_fields(self, **{name: require_positive(name, getattr(self, name))})
        if not (self.approach or self.retreat):
            raise InvalidValue("a straight line must have a length: give approach or retreat")
        if self.away != "up":
            set_fields(self, away=as_axis("away", self.away))


@dataclass(frozen=True, eq=False)
class Line:
    """A straight line as configurations, (n, dim), from its beginning; or why there is none.

    `off_m` and `off_rad` are the largest deviations of the tip from line and rotation on a fine grid.
    """

    path: Floats
    why: str = ""
    off_m: float = 0.0
    off_rad: float = 0.0


def line_at(chain: Chain, straight: CartesianLine, q: Floats) -> tuple[Floats, Floats, Floats]:
    """Return rotation, (3, 3), and position of the tip at a configuration, (dim,), and the direction of its line."""
    tip = chain.tip_poses(q[np.newaxis])[0]
    turn = tip[:9].reshape(3, 3)
    up = straight.away == "up"
    return turn, tip[9:], np.array([0.0, 0.0, 1.0]) if up else turn @ np.array(straight.away)


def line_from(world: ArmWorld, chain: Chain, straight: CartesianLine, q: Floats, length: float) -> Line:
    """Return the line of length `length` [m] on which the tip leaves a free configuration, (dim,)."""
    farthest = 2.0 * chain.reach()[1]
    if length > farthest:
        # Before such a line is laid out: a kilometre would need too much memory.
        return Line(q[np.newaxis], f"it is {length:g} m long, {chain.tip!r} moves no farther than {farthest:.3g} m")
    turn, here, away = line_at(chain, straight, q)
    count = max(1, int(np.ceil(length / STEP)))
    shares = length * np.arange(count + 1) / count
    task = PoseTask(Pose(tuple(here.tolist()), tuple(turn.ravel().tolist())))
    positions = here + shares[:, np.newaxis] * away
    path = chain.followed(q, task.row, positions, _LONGEST, world.space.flat.wrapping)
    done = len(path)
    where = f"of the straight line of {length:g} m"
    if done <= count:
        return Line(q[np.newaxis], f"after {shares[max(done - 1, 0)]:.3g} m {where} no joint angles go on")
    free = world.validate(path)
    if not free.all():
        first = int(np.flatnonzero(~free)[0])
        states = between(world, path[first : first + 2], FINE)
        blocked = states[~world.valid(states)]
        why = world.explain(blocked[0]) if len(blocked) else "it comes too near to contact for a proof"
        return Line(path[:1], f"after {length * first / count:.3g} m {where} {why}")
    off_m, off_rad = _off(world, chain, path, here, away, turn)
    if off_m > straight.line_tolerance or off_rad > straight.angle_tolerance:
        return Line(path[:1], f"the tip misses the straight line by {off_m:.3g} m and {off_rad:.3g} rad")
    return Line(path, "", off_m, off_rad)


def _off(world: ArmWorld, chain: Chain, path: Floats, here: Floats, away: Floats, turn: Floats) -> tuple[float, float]:
    """Return the largest deviations of the tip from a line and its rotation on a fine grid [m, rad]."""
    off_m, off_rad, _ = misses(chain, between(world, path, FINE), here, away, turn)
    return float(off_m.max()), float(off_rad.max())


def misses(chain: Chain, q: Floats, here: Floats, away: Floats, turn: Floats) -> tuple[Floats, Floats, Floats]:
    """Return the deviations of the tip from a line and its rotation, and the length along it, (n,) each,
    at (n, dim).
    """
    tips = chain.tip_poses(q)
    gap = tips[:, 9:] - here
    along = gap @ away
    turns = np.einsum("nij,kj->nik", tips[:, :9].reshape(-1, 3, 3), turn)
    sine = 0.5 * np.linalg.norm(turns - turns.transpose(0, 2, 1), axis=(1, 2)) / np.sqrt(2.0)
    cosine = 0.5 * (np.trace(turns, axis1=1, axis2=2) - 1.0)
    return np.linalg.norm(gap - np.outer(along, away), axis=1), np.arctan2(sine, cosine), along


def between(world: ArmWorld, path: Floats, count: int) -> Floats:
    """Return the states of a path at `count` equal parts of each of its motions, (n, dim)."""
    shares = np.tile(np.arange(1, count + 1) / count, len(path) - 1)
    first, last = (np.repeat(path[i : len(path) - 1 + i], count, axis=0) for i in (0, 1))
    return np.concatenate([path[:1], world.space.interpolate(first, last, shares)])


def tilts(chain: Chain, q: Floats, axis: Sequence[float], direction: Sequence[float]) -> Floats:
    """Return the angles, (n,) [rad], between a direction of the root's frame and an axis of the tip's, at (n, dim)."""
    pointing = chain.tip_poses(q)[:, :9].reshape(-1, 3, 3) @ np.array(axis)
    across = np.linalg.norm(np.cross(pointing, np.array(direction)), axis=1)
    return np.arctan2(across, pointing @ np.array(direction))
