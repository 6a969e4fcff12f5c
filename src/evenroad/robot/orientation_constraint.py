"""OrientationWorld: an arm that keeps an axis of its tip upright, as when it carries a glass of water."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._checks import require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad.geometry.pose import Vector
from evenroad.robot.arm_world import ArmWorld
from evenroad.robot.cartesian_line import between, tilts
from evenroad.robot.chain import Chain
from evenroad.robot.constraint import Constraint
from evenroad.robot.pose_goal import AXES, as_axis
from evenroad.robot.pose_task import PoseTask
from evenroad.robot.tree_sequences import share_pairs
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.path import path_length

UP = (0.0, 0.0, 1.0)

FINE = 8
"""Number of states of each step at which the tilt is measured."""

_STEP = 0.1
"""Longest step along a motion in the metric of the joints."""
_AIM = 0.5
"""Largest tilt of projected states, as a share of the tolerance: the rest is for motions between them."""
_JUMP = 2.5
"""Number of steps beyond which neighbouring projected states are of two branches."""
_TOGETHER = 64
"""Number of motions that are projected at once."""


@dataclass(frozen=True)
class OrientationConstraint(Constraint):
    """A constraint that keeps an axis of a link upright along the whole path.

    Parameters
    ----------
    tolerance : float
        Largest tilt, > 0, up to pi [rad].
    axis : sequence of 3 floats, "x", "-x", ..., or None
        The axis in the frame of the tip; None is the one of the six that is most upright at the start.
    tip : str
        The link of the tip; default: that of the goal poses, or the last one.
    """

    tolerance: float
    axis: Vector | str | None = None
    tip: str = ""

    def __post_init__(self) -> None:
        set_fields(self, tolerance=require_positive("the tolerance of upright", self.tolerance, at_most=math.pi))
        if self.axis is not None:
            set_fields(self, axis=as_axis("the axis of upright", self.axis))


def orientation_world(world: ArmWorld, chain: Chain, upright: OrientationConstraint, start: Floats) -> OrientationWorld:
    """Return the world in which a path from `start`, (dim,), keeps an axis upright."""
    axis = upright.axis
    if axis is None:
        every = [as_axis("axis", sign + name) for name in AXES for sign in ("", "-")]
        axis = min(every, key=lambda each: float(tilts(chain, start[np.newaxis], each, UP)[0]))
    return OrientationWorld(world, chain, axis, upright.tolerance)  # type: ignore[arg-type]


class ProjectedSpace(JointSpace):
    """The joints' space, with points of the cube projected to where the axis is upright, if that is found."""

    def projected_by(self, world: OrientationWorld) -> ProjectedSpace:
        """Return a copy that projects in a world; frozen values need it."""
        object.__setattr__(self, "_world", world)
        return self

    def from_cube(self, u: Floats) -> Floats:
        """Return configurations, (n, dim), of points of the cube, (n, dim); those without a projection stay tilted."""
        q = super().from_cube(u)
        world: OrientationWorld = self._world  # type: ignore[attr-defined]
        return self.wrapped(np.clip(world.projected(q)[0], *world.limits))


@dataclass(frozen=True, eq=False)
class OrientationWorld:
    """The configurations of an arm's world in which an axis of a link is upright, and motions that keep it so.

    Milestones are projected, and a motion is the straight one with its states projected, one by one: `along`.  It is
    free if no state jumps to another branch, every step is proved free, and the tilt is within the tolerance on a grid.

    Attributes
    ----------
    world : ArmWorld
    chain : Chain
        The chain from the root to the link.
    axis : tuple of 3 floats
        The axis in the frame of the link.
    tolerance : float
        Largest angle between axis and upright [rad].
    """

    world: ArmWorld
    chain: Chain
    axis: Vector
    tolerance: float
    space: ProjectedSpace = field(init=False, repr=False)

    def __post_init__(self) -> None:
        plain = self.world.space
        space = ProjectedSpace(plain.low, plain.high, plain.wrapping, plain.weights)
        object.__setattr__(self, "space", space.projected_by(self))

    @property
    def proof(self) -> str:
        """``certified``: collisions are proved absent; the tilt is measured."""
        return "certified"

    @property
    def limits(self) -> Floats:
        """Limits of the joints, (2, dim); infinite for those that wrap."""
        return np.where(self.world.space.flat.wrapping, [[-np.inf], [np.inf]], self.chain.bounds)

    @property
    def step(self) -> float:
        """Longest step along a motion: between two upright states the tilt grows with its square."""
        return min(_STEP, math.sqrt(0.5 * self.tolerance))

    def tilts(self, q: Floats) -> Floats:
        """Return the tilts of the axis, (n,) [rad], at configurations (n, dim)."""
        return tilts(self.chain, q, self.axis, UP)

    def projected(self, q: Floats) -> tuple[Floats, Bools]:
        """Return the configurations, (n, dim), projected to a share of the tolerance, and which succeeded."""
        task = PoseTask(pointing=(self.axis, UP), placed=False, angle_tolerance=_AIM * self.tolerance)
        moved, missing = self.chain.reached(q, task.row)
        return moved, missing == 0.0

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free and upright: (n,)."""
        return self.world.valid(q) & (self.tilts(as_batch("q", q, self.space.dim)) <= self.tolerance)

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, from rows of `a` to those of `b`, (m, dim) arrays, are free and upright: (m,)."""
        first, second = as_batch_pair(a, b, self.space.dim)
        free = np.zeros(len(first), dtype=np.bool_)
        for begin in range(0, len(first), _TOGETHER):
            some = slice(begin, begin + _TOGETHER)
            free[some] = self._followed(first[some], second[some])[0]
        return free

    def along(self, a: Floats, b: Floats) -> Floats | None:
        """Return the states of the motion between two configurations, (n, dim), with both; None where it
        is not free.
        """
        free, states = self._followed(a[np.newaxis], b[np.newaxis])
        return states if free[0] else None

    def _followed(self, a: Floats, b: Floats) -> tuple[Bools, Floats]:
        """Return which motions are free, and the states of all, one after the other."""
        world = self.world
        parts = np.maximum(1, np.ceil(world.space.distance(a, b) / self.step)).astype(np.int64)
        motion = np.repeat(np.arange(len(a)), parts + 1)
        number = np.arange(len(motion)) - np.repeat(np.cumsum(parts + 1) - parts - 1, parts + 1)
        states = world.space.interpolate(a[motion], b[motion], number / parts[motion])
        inner = (number > 0) & (number < parts[motion])
        states[inner], upright = self.projected(states[inner])
        good = np.ones(len(a), dtype=np.bool_)
        good[motion[inner][~upright]] = False
        steps = np.flatnonzero(motion[1:] == motion[:-1])
        far = world.space.distance(states[steps], states[steps + 1]) > _JUMP * self.step
        good[motion[steps[far]]] = False
        steps = steps[good[motion[steps]]]
        if len(steps):
            shares = np.tile(np.arange(FINE) / FINE, len(steps))
            fine = np.repeat(steps, FINE)
            tilted = self.tilts(world.space.interpolate(states[fine], states[fine + 1], shares)) > self.tolerance
            good[motion[fine[tilted]]] = False
            steps = steps[good[motion[steps]]]
        if len(steps):
            # States first, which costs less than proofs.
            blocked = steps[~world.motion_valid(states[steps], states[steps + 1])]
            good[motion[blocked]] = False
            steps = steps[good[motion[steps]]]
            open_ = steps[~world.motion_certified(states[steps], states[steps + 1], 1e-6)]
            good[motion[open_]] = False
        return good, states

    def path_through(self, waypoints: Floats, *, shorten: bool) -> tuple[Floats, float]:
        """Return a path through waypoints between which motions are free, (p, dim), made shorter if wanted, and its
        largest tilt on a grid twice as fine as the one that motions are checked on.
        """
        pieces = [self.along(a, b) for a, b in pairwise(waypoints)]
        assert all(followed is not None for followed in pieces), "a motion of a path was free and is not"
        path = np.concatenate([waypoints[:1], *(followed[1:] for followed in pieces if followed is not None)])
        if shorten:
            path = self._shortened(path)
        return path, self.largest_tilt(path)

    def largest_tilt(self, path: Floats) -> float:
        """Return the largest tilt [rad] along a path, (p, dim), on a grid twice as fine as that of motions."""
        return float(self.tilts(between(self.world, path, 2 * FINE)).max())

    def _shortened(self, path: Floats) -> Floats:
        space = self.world.space
        for low, high in [(0.0, 1.0), *np.sort(share_pairs(), axis=1)]:
            travelled = np.concatenate([[0.0], np.cumsum(space.distance(path[:-1], path[1:]))])
            i, j = np.searchsorted(travelled, [low * travelled[-1], high * travelled[-1]])
            if j - i < 2:
                continue
            followed = self.along(path[i], path[j])
            if followed is not None and path_length(followed, space) < travelled[j] - travelled[i] - 1e-9:
                path = np.concatenate([path[:i], followed, path[j + 1 :]])
        return path

    def fingerprint(self) -> str:
        """Return a text that is equal for worlds in which the same is free."""
        return fingerprint_of("upright", self.world.fingerprint(), self.chain.tip, self.axis, self.tolerance)

    def explain(self, q: Floats) -> str:
        """Return, in words, why one configuration, (dim,), is not free: which bodies touch, or how far it is tilted."""
        tilt = float(self.tilts(q[np.newaxis])[0])
        if tilt <= self.tolerance:
            return self.world.explain(q)
        return self.tilted(tilt)

    def tilted(self, tilt: float) -> str:
        """Return, in words, that a tilt [rad] is too large, and of what."""
        every = (sign + name for name in AXES for sign in ("", "-"))
        numbers = f"({', '.join(f'{each:.3g}' for each in self.axis)})"
        axis = next((name for name in every if as_axis("axis", name) == self.axis), numbers)
        return f"axis {axis} of {self.chain.tip!r} is tilted by {tilt:.4g} rad, more than {self.tolerance:.4g}"
