"""Configurations with which a tip follows a curve, proved near to it and free; or what stops it, and where."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from evenroad._arrays import Floats, Ints
from evenroad.collision.arm_world import ArmWorld
from evenroad.geometry.curve import Curve
from evenroad.geometry.pose import Pose
from evenroad.poses.chain import Chain
from evenroad.poses.pose_task import PoseTask

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

OFF_M, OFF_RAD = 4e-5, 1e-3
"""Largest deviations of a tip from its curve [m, rad].  With rounded corners, 0.1 mm and 0.1 degrees are kept."""

LONGEST = 0.2
"""Largest movement of a joint between two poses of a curve [rad or m]."""

_PARTS = 4
"""Number of parts of a motion at whose ends the deviation is measured; between them it is bounded."""
_HALVINGS = 5
"""Number of times that poses are put between those of a curve where the deviation is too large."""


@dataclass(frozen=True, eq=False)
class Followed:
    """A followed curve as configurations, (n, dim), from its beginning; or why there is none.

    `off_m` and `off_rad` are bounds on how far the tip is from the curve.  `via` and `stops` are rows of the path, as
    those of a :class:`Curve`.  Without a whole path `share` says how much of the curve can be followed.
    """

    path: Floats
    why: str = ""
    off_m: float = 0.0
    off_rad: float = 0.0
    share: float = 1.0
    via: tuple[int, ...] = ()
    stops: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Follower:
    """A tip that follows a curve in a world, its poses in the frame of the root."""

    world: ArmWorld
    chain: Chain
    curve: Curve
    off_m: float = OFF_M
    off_rad: float = OFF_RAD

    def from_posture(self, q: Floats) -> Followed:
        """Return the path that begins at a configuration, (dim,), and goes on from each to the nearest."""
        path = self.steps(q, slice(None))
        done = len(path)
        if done < len(self.curve.poses):
            return self.stopped(path, done)
        return self.checked(path)

    def steps(self, q: Floats, rows: slice, towards: Floats | None = None) -> Floats:
        """Return configurations along some poses of the curve, as far as they go on, (m, dim)."""
        poses = np.ascontiguousarray(self.curve.poses[rows])
        return self.chain.followed(q, poses, LONGEST, self.world.space.flat.wrapping, towards)

    def checked(self, path: Floats) -> Followed:
        """Return the answer for configurations at all poses of the curve, (n, dim)."""
        curve, off_m, off_rad = self.curve, np.zeros(0), np.zeros(0)
        for _ in range(_HALVINGS):
            off_m, off_rad = deviations(self.chain, path)
            far = np.flatnonzero((off_m > self.off_m) | (off_rad > self.off_rad))
            if not len(far):
                break
            curve, path = self._halved(curve, path, far)
        free = self.world.validate(path)
        if not free.all():
            first = int(np.flatnonzero(~free)[0])
            states = np.linspace(path[first], path[first + 1], 17)
            blocked = states[~self.world.valid(states)]
            why = self.world.explain(blocked[0]) if len(blocked) else "it comes too near to contact for a proof"
            return replace(self, curve=curve)._with_why(path, first + 1, why)
        if len(far):
            why = f"the tip misses its curve by {off_m[far[0]]:.3g} m and {off_rad[far[0]]:.3g} rad"
            return replace(self, curve=curve)._with_why(path, int(far[0]) + 1, why)
        return Followed(
            path,
            "",
            float(off_m.max()),
            float(off_rad.max()),
            1.0,
            tuple(curve.via.tolist()),
            tuple(curve.stops.tolist()),
        )

    def stopped(self, path: Floats, done: int) -> Followed:
        """Return the answer where configurations, (done, dim), lead no farther; the cause may come before the end."""
        if done > 1 and (before := self.checked_part(path)) is not None:
            return before
        if not done:
            return self._with_why(path, 0, "no joint angles reach its beginning")
        return self._with_why(path, done, self._cause(path[-1], self.curve.poses[done]))

    def checked_part(self, path: Floats) -> Followed | None:
        """Return the answer of configurations at the first poses of the curve if they are not free; else None."""
        free = self.world.validate(path)
        if free.all():
            return None
        some = replace(self, curve=Curve(self.curve.poses[: len(path)], self.curve.via[:0], self.curve.via[:0]))
        return replace(some.checked(path), share=self._share(int(np.flatnonzero(~free)[0]) + 1))

    def _with_why(self, path: Floats, done: int, why: str) -> Followed:
        return Followed(path[:done], why, share=self._share(done))

    def _share(self, done: int) -> float:
        """Return the share of the curve up to its last of `done` poses."""
        along = self.curve.lengths
        rows = max(done - 1, 0) / max(len(along) - 1, 1)
        return float(along[max(done - 1, 0)] / along[-1]) if along[-1] > 1e-9 else rows

    def _cause(self, q: Floats, pose: Floats) -> str:
        """Return, in words, why joints go no farther from a configuration, (dim,), to a pose, (12,)."""
        task = PoseTask(Pose(tuple(pose[9:].tolist()), tuple(pose[:9].tolist()))).row
        beyond, missing = self.chain.reached(q[np.newaxis], task, limits=False)
        over = np.maximum(self.chain.bounds[0] - beyond[0], beyond[0] - self.chain.bounds[1])
        over[self.world.space.flat.wrapping] = 0.0
        k = int(over.argmax())
        if missing[0] == 0.0 and np.abs(beyond[0] - q).max() <= LONGEST and over[k] > 0.0:
            low, high = self.chain.bounds[:, k]
            return f"joint {self.chain.group[k]!r} is at its limit there, of [{low:.4g}, {high:.4g}]"
        condition = condition_of(self.chain, q)
        return f"no joint angles go on: the posture has the condition number {condition:.3g}"

    def _halved(self, curve: Curve, path: Floats, rows: Ints) -> tuple[Curve, Floats]:
        """Return curve and path with a pose more in the middle of some motions."""
        middles = _share_between(curve.poses, _turns(curve.poses), 0.5)[rows]
        q = 0.5 * (path[rows] + path[rows + 1])
        for k, pose in enumerate(middles):
            moved = self.chain.followed(q[k], pose[np.newaxis], LONGEST, self.world.space.flat.wrapping)
            q[k] = moved[0] if len(moved) else q[k]
        poses = np.insert(curve.poses, rows + 1, middles, axis=0)
        via, stops = (each + np.searchsorted(rows, each) for each in (curve.via, curve.stops))
        return Curve(poses, via, stops), np.insert(path, rows + 1, q, axis=0)


def deviations(chain: Chain, path: Floats) -> tuple[Floats, Floats]:
    """Return bounds, (n - 1,) each, on how far the tip leaves the straight, steady way between neighbouring
    configurations, (n, dim) [m, rad].

    It is measured at some states of each motion.  Between two of them it is larger by an eighth of the largest second
    derivative times their distance squared at most (de Boor 1978, II): that is bounded by how far the joints move.
    """
    tips, moved = chain.tip_poses(path), np.diff(path, axis=0)
    off_m, off_rad = np.zeros(len(moved)), np.zeros(len(moved))
    turned = _turns(tips)
    for share in (np.arange(1, _PARTS) / _PARTS).tolist():
        on, straight = chain.tip_poses(path[:-1] + share * moved), _share_between(tips, turned, share)
        off_m = np.maximum(off_m, np.sqrt(np.square(on[:, 9:] - straight[:, 9:]).sum(axis=1)))
        off_rad = np.maximum(off_rad, _angles(on, straight))
    moves, rest = moves_of(chain, moved), 1.0 / (8.0 * _PARTS**2)
    return off_m + rest * moves.push, off_rad + rest * moves.swing


def condition_of(chain: Chain, q: Floats) -> float:
    """Return the condition number of the tip's derivative by the joints at a configuration, (dim,): m and rad alike."""
    derivative = chain.derivatives(q[np.newaxis])[0][:, chain.moving]
    sizes = np.linalg.svd(derivative, compute_uv=False)
    return float(sizes[0] / max(sizes[-1], 1e-12))


@dataclass(frozen=True)
class Moves:
    """Bounds on how a tip moves along motions, (n,) each, a motion being 1 long: its speed, its turn, and the second
    derivatives of its origin and of a direction that it carries.
    """

    speed: Floats
    turn: Floats
    push: Floats

    @property
    def swing(self) -> Floats:
        """Bound on the second derivative of a direction, and on that of the turn from the steady one."""
        return 1.5 * self.turn**2


def moves_of(chain: Chain, moved: Floats) -> Moves:
    """Return bounds on how the tip moves along straight motions of the joints, (n, dim)."""
    joints = np.abs(moved[:, chain.coordinates] * chain.rows[:-1, 12])
    turning, arms = np.where(chain.slides, 0.0, joints), chain.arms
    # A joint turns what later ones move: of two the later one's arm counts.
    later = np.cumsum(turning, axis=1)
    pushes = (joints * arms * (2.0 * later - turning)).sum(axis=1)
    return Moves((joints * arms).sum(axis=1), turning.sum(axis=1), pushes)


def _rotations(poses: Floats) -> Rotation:
    # A plan without curves that turn does without it.
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(poses[:, :9].reshape(-1, 3, 3))


def _angles(a: Floats, b: Floats) -> Floats:
    """Return the angles between the rotations of poses, (n, 12) each."""
    half = np.sqrt(np.square(a[:, :9] - b[:, :9]).sum(axis=1) / 8.0)
    return np.asarray(2.0 * np.arcsin(np.minimum(half, 1.0)))


def _turns(poses: Floats) -> Floats | None:
    """Return the turns from each pose, (n, 12), to the next in its own frame, (n - 1, 3); None where there are none."""
    if np.abs(np.diff(poses[:, :9], axis=0)).max(initial=0.0) < 1e-9:
        return None
    rotations = _rotations(poses)
    turned: Floats = (rotations[:-1].inv() * rotations[1:]).as_rotvec()
    return turned


def _share_between(poses: Floats, turned: Floats | None, share: float) -> Floats:
    """Return the poses at a share of the straight, steady ways from each pose, (n, 12), to the next."""
    positions = (1.0 - share) * poses[:-1, 9:] + share * poses[1:, 9:]
    if turned is None:
        return np.hstack([poses[:-1, :9], positions])
    first = _rotations(poses[:-1])
    rotations = first * type(first).from_rotvec(share * turned)
    return np.hstack([rotations.as_matrix().reshape(-1, 9), positions])
