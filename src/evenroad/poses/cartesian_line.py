"""Cartesian lines: the tip approaches its goal, and leaves its start, in straight lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from evenroad._arrays import Floats, set_fields
from evenroad._checks import require_positive
from evenroad.collision.arm_world import ArmWorld
from evenroad.errors import InvalidValue
from evenroad.geometry.curve import STEP, Curve
from evenroad.geometry.pose import Vector
from evenroad.poses.cartesian_path import Followed, Follower
from evenroad.poses.chain import Chain
from evenroad.poses.constraint import Constraint
from evenroad.poses.pose_goal import as_axis


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


def line_at(chain: Chain, straight: CartesianLine, q: Floats) -> tuple[Floats, Floats, Floats]:
    """Return rotation, (3, 3), and position of the tip at a configuration, (dim,), and the direction of its line."""
    tip = chain.tip_poses(q[np.newaxis])[0]
    turn = tip[:9].reshape(3, 3)
    up = straight.away == "up"
    return turn, tip[9:], np.array([0.0, 0.0, 1.0]) if up else turn @ np.array(straight.away)


def line_from(world: ArmWorld, chain: Chain, straight: CartesianLine, q: Floats, length: float) -> Followed:
    """Return the line of length `length` [m] on which the tip leaves a free configuration, (dim,)."""
    farthest = 2.0 * chain.reach()[1]
    if length > farthest:
        # Before such a line is laid out: a kilometre would need too much memory.
        return Followed(q[np.newaxis], f"it is {length:g} m long, {chain.tip!r} moves no farther than {farthest:.3g} m")
    turn, here, away = line_at(chain, straight, q)
    shares = np.linspace(0.0, length, max(1, math.ceil(length / STEP)) + 1)
    poses = np.empty((len(shares), 12))
    poses[:, :9], poses[:, 9:] = turn.ravel(), here + shares[:, np.newaxis] * away
    curve = Curve(poses, np.array([0, len(shares) - 1]), np.empty(0, dtype=np.int64))
    line = Follower(world, chain, curve, straight.line_tolerance, straight.angle_tolerance).from_posture(q)
    if line.why:
        why = f"after {length * line.share:.3g} m of the straight line of {length:g} m {line.why}"
        return replace(line, path=q[np.newaxis], why=why)
    return line


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
    return np.asarray(np.arctan2(across, pointing @ np.array(direction)))
