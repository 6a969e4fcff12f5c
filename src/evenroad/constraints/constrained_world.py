"""KeptWorld: an arm that keeps constraints along its whole path, such as a glass upright, or a hand on a door."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from evenroad._arrays import Bools, Floats, Ints
from evenroad._fingerprint import fingerprint_of
from evenroad._native import robot as kernel
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.keep import Keep
from evenroad.points.reversed_halton import share_pairs
from evenroad.poses.cartesian_path import Followed, moves_of
from evenroad.poses.chain import Chain, chain_of, default_tip
from evenroad.poses.constraint import Constraint
from evenroad.space import JointSpace
from evenroad.space.batch import as_batch, as_batch_pair
from evenroad.space.path import path_length

_STEP = 0.1
"""Longest step along a motion, in the metric of the joints."""
_AIM, _ENOUGH = 0.3, 0.5
"""Lengths of residuals that a projection aims at, and that it must reach, as shares of their limits.  The rest is for
motions between projected states."""
_STEPS, _FEW = 20, 12
"""Largest number of steps of a projection, and of one for states along a motion."""
_LONGEST = 0.3
"""Largest movement of a joint in such a step [rad or m]."""
_JUMP = 2.5
"""Distance, in steps, above which neighbouring projected states belong to two branches."""
_PARTS = 4
"""Number of parts of a motion. Residuals are measured at their ends, and bounded between."""
_SHORTCUTS, _ROUNDS, _LONGER = 24, 3, 0.1
"""Numbers of motions and rounds of shortening, and the least excess over the straight motion, as a share."""
TOLERANCE = 1e-6
"""Distance from contact down to which a step is proved free [m]."""
_TOGETHER = 64
"""Number of motions that are projected together."""


def keeps_of(constraints: Constraint | None) -> tuple[Keep, ...]:
    """Return the constraints that hold along the whole path."""
    return tuple(each for each in (constraints.parts if constraints else ()) if isinstance(each, Keep))


def kept_world(world: ArmWorld, keeps: tuple[Keep, ...], start: Floats, tip: str) -> KeptWorld:
    """Return the world in which a path from `start`, (dim,), keeps constraints; one without a link is about `tip`."""
    said = all(getattr(keep, "tip", "said") for keep in keeps)
    last = tip or ("" if said else default_tip(world.robot))
    return KeptWorld(world, tuple(keep.bound(world.robot, start, last) for keep in keeps))


class ProjectedSpace(JointSpace):
    """The joints' space with samples and interpolated points projected to the constraints, if that succeeds."""

    def projected_by(self, world: KeptWorld) -> ProjectedSpace:
        """Return a copy that projects in a world; frozen values need it."""
        object.__setattr__(self, "_world", world)
        return self

    def from_cube(self, u: Floats) -> Floats:
        """Return configurations, (n, dim), for points of the cube, (n, dim); some may have no projection."""
        return self._on(super().from_cube(u))

    def interpolate(self, a: Floats, b: Floats, t: Floats | float) -> Floats:
        """Return projected points between configurations, (n, dim) each; endpoints do not change."""
        share = np.broadcast_to(np.asarray(t, dtype=np.float64), len(a))
        q, inner = super().interpolate(a, b, t), (share > 0.0) & (share < 1.0)
        q[inner] = self._on(q[inner])
        return q

    def _on(self, q: Floats) -> Floats:
        world: KeptWorld = self._world  # type: ignore[attr-defined]
        return self.wrapped(np.clip(world.projected(q)[0], *world.limits))


@dataclass(frozen=True, eq=False)
class KeptWorld:
    """An arm's world restricted to configurations and motions that keep constraints.

    Milestones are projected.  A motion is the straight one with its states projected, one by one: `along`.  It is free
    if no state jumps to another branch, and each step is proved to have no contact and residuals within their limits.

    Attributes
    ----------
    world : ArmWorld
    keeps : tuple of Keep
        Bound constraints.
    """

    world: ArmWorld
    keeps: tuple[Keep, ...]
    space: ProjectedSpace = field(init=False, repr=False)
    chains: dict[str, Chain] = field(init=False, repr=False)
    native: kernel.Keeps = field(init=False, repr=False)

    def __post_init__(self) -> None:
        plain = self.world.space
        space = ProjectedSpace(plain.low, plain.high, plain.wrapping, plain.weights)
        tips = dict.fromkeys(tip for keep in self.keeps for tip in keep.tips)
        object.__setattr__(self, "chains", {tip: chain_of(self.world.robot, tip) for tip in tips})
        object.__setattr__(self, "space", space.projected_by(self))
        number = {tip: i for i, tip in enumerate(self.chains)}
        keeps = []
        for keep in self.keeps:
            kind, numbers = keep.residual
            first, last = (number[keep.tips[0]], number[keep.tips[-1]]) if keep.tips else (0, 0)
            given = np.ascontiguousarray(numbers, dtype=np.float64)
            keeps.append(kernel.Keep(kind, first, last, keep.limit, given))
        chains = [chain.native for chain in self.chains.values()]
        object.__setattr__(self, "native", kernel.Keeps(chains, keeps, self.limits))

    @property
    def proof(self) -> str:
        """``certified``: collisions are proved absent, and the constraints proved kept."""
        return "certified"

    @property
    def bodies(self) -> str:
        """The kinds of bodies that stand for the robot, see `Robot.bodies`."""
        return self.world.bodies

    def path_clearance(self, path: Floats) -> float | None:
        """Return the proved distance of a path, (p, dim), from obstacles [m], as `ArmWorld` does."""
        return self.world.path_clearance(path)

    def nearest_along(self, path: Floats) -> tuple[str, str] | None:
        """Return the link and the obstacle that come nearest to each other along a path, (p, dim)."""
        return self.world.nearest_along(path)

    @property
    def limits(self) -> Floats:
        """Limits of the joints, (2, dim); infinite for those that wrap."""
        ranges = np.array([self.world.space.low, self.world.space.high])
        return np.where(self.world.space.flat.wrapping, [[-np.inf], [np.inf]], ranges)

    @cached_property
    def step(self) -> float:
        """Longest step along a motion; residuals between two states grow with its square."""
        return min(_STEP, *(math.sqrt(3.0 * keep.limit) for keep in self.keeps if keep.tips), _STEP)

    def shares(self, q: Floats) -> Floats:
        """Return the lengths of the residuals as shares of their limits, (n, c), at configurations, (n, dim)."""
        return self.native.shares(np.ascontiguousarray(q))

    def projected(self, q: Floats, *, steps: int = _STEPS) -> tuple[Floats, Bools]:
        """Return configurations, (n, dim), projected to residuals within a share of their limits, and which succeeded.

        The method is damped Gauss-Newton (Nakamura and Hanafusa 1986).
        """
        return self.native.project(np.ascontiguousarray(q), kernel.Projecting(_AIM, _ENOUGH, steps, _LONGEST))

    def bounds(self, path: Floats) -> Floats:
        """Return bounds on the residuals along each motion of a path, (n, dim), as shares of limits: (n - 1, c).

        They are measured at some states.  Between two states they exceed both values by at most an eighth of the
        largest second derivative times the squared distance (de Boor 1978, II).
        """
        moved = self.space.flat.difference(path[:-1], path[1:])
        states = [path[:-1] + share * moved for share in np.arange(_PARTS) / _PARTS]
        measured = self.shares(np.concatenate([*states, path[-1:]]))
        most = np.maximum(measured[: len(moved)], np.vstack([measured[1 : len(moved)], measured[-1:]]))
        for part in range(1, _PARTS):
            most = np.maximum(most, measured[part * len(moved) : (part + 1) * len(moved)])
        moves = {tip: moves_of(chain, moved) for tip, chain in self.chains.items()}
        for k, keep in enumerate(self.keeps):
            most[:, k] += keep.bend([moves[tip] for tip in keep.tips]) / (8.0 * _PARTS**2 * keep.limit)
        return most

    def valid(self, q: Floats) -> Bools:
        """Return which configurations, (n, dim), are free and keep the constraints: (n,)."""
        free: Bools = self.world.valid(q) & (self.shares(as_batch("q", q, self.space.dim)) <= 1.0).all(axis=1)
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return which motions, from rows of `a` to those of `b`, (m, dim) arrays, are free and keep them: (m,)."""
        first, second = as_batch_pair(a, b, self.space.dim)
        free = np.zeros(len(first), dtype=np.bool_)
        for begin in range(0, len(first), _TOGETHER):
            some = slice(begin, begin + _TOGETHER)
            free[some] = self._followed(first[some], second[some])[0]
        return free

    def along(self, a: Floats, b: Floats) -> Floats | None:
        """Return the states of the motion between two configurations, (n, dim), with both; None if it is blocked."""
        row, states = self.first_along(a[np.newaxis], b[np.newaxis])
        return states if row == 0 else None

    def first_along(self, a: Floats, b: Floats) -> tuple[int, Floats]:
        """Return the number of the first free motion, (m, dim) each, or -1, and its states."""
        good, motion, states = self._followed(a, b)
        row = int(good.argmax()) if good.any() else -1
        return row, states[motion == row]

    def _followed(self, a: Floats, b: Floats) -> tuple[Bools, Ints, Floats]:
        """Return which motions are free, the states of those in sequence, and the motion of each state.

        Each motion walks to its end along the constraints.  States between these are then projected, from nearby.  A
        motion and its reverse have the same states.
        """
        world, flat, finer = self.world, self.space.flat, max(1, int(_STEP / self.step))
        back, given = is_backwards(a, b), (a, b)
        a, b = np.where(back[:, np.newaxis], given[::-1], given)
        states, counts = self.native.walk(a, flat.difference(a, b), self._walking(finer * self.step))
        states, counts = _without(states, counts, ~world.valid(self.space.wrapped(states)))
        if finer > 1:
            states, counts = self.native.refine(states, counts, finer, self._walking(self.step))
        free = np.flatnonzero(counts)
        motion, states = np.repeat(np.arange(len(a)), counts), self.space.wrapped(states).copy()
        # Sums round, so the given endpoints replace them.
        states[np.cumsum(counts[free]) - 1] = b[free]
        good = counts > 0
        drop_blocked(
            good,
            motion,
            lambda rows: world.motion_valid(states[rows], states[rows + 1]),
            lambda rows: np.asarray((self.bounds(states)[rows] <= 1.0).all(axis=1)),
            lambda rows: world.motion_certified(states[rows], states[rows + 1], TOLERANCE),
        )
        rows = good[motion]
        return good, *turned_round(motion[rows], states[rows], back)

    def _walking(self, step: float) -> kernel.Walking:
        """Return the walk by such steps in compiled code."""
        projecting = kernel.Projecting(_AIM, _ENOUGH, _FEW, _LONGEST)
        return kernel.Walking(self.space.flat.scale, step, _JUMP, projecting)

    def path_through(self, waypoints: Floats) -> Floats:
        """Return the path through waypoints between which motions are free, (p, dim)."""
        pieces = [self.along(a, b) for a, b in pairwise(waypoints)]
        assert all(followed is not None for followed in pieces), "a motion of a path was free and is not"
        return np.concatenate([waypoints[:1], *(followed[1:] for followed in pieces if followed is not None)])

    def largest(self, path: Floats) -> Floats:
        """Return bounds on the residuals along a path, (p, dim), as shares of limits: (c,)."""
        return np.asarray(self.bounds(path).max(axis=0))

    def deviation(self, largest: Floats) -> dict[str, float]:
        """Return the deviation of each constraint, for residuals as shares of limits, (c,)."""
        off: dict[str, float] = {}
        for keep, share in zip(self.keeps, largest.tolist(), strict=True):
            by = float(keep.off(np.array([share * keep.limit]))[0])
            off[keep.deviation] = max(off.get(keep.deviation, 0.0), by)
        return off

    def shortened(self, path: Floats) -> Floats:
        """Return a path, (p, dim), shortened by free motions between positions along it.

        Nothing is tried unless the path is much longer than the straight motion, which may violate the constraints.
        """
        space = self.world.space
        least = (1.0 + _LONGER) * float(space.distance(path[:1], path[-1:])[0])
        for pairs in np.split(np.sort(share_pairs(_SHORTCUTS), axis=1), _ROUNDS):
            travelled = np.concatenate([[0.0], np.cumsum(space.distance(path[:-1], path[1:]))])
            if travelled[-1] <= least:
                break
            i, j = np.searchsorted(travelled, pairs.T * travelled[-1])
            # A path hardly longer than the straight motion cannot become much shorter.
            some = j - i > 1
            some[some] = travelled[j[some]] - travelled[i[some]] > 1.01 * space.distance(path[i[some]], path[j[some]])
            i, j = i[some], j[some]
            good, motion, states = self._followed(path[i], path[j])
            found = {k: states[motion == k] for k in np.flatnonzero(good).tolist()}
            saved = {k: travelled[j[k]] - travelled[i[k]] - path_length(each, space) for k, each in found.items()}
            taken: list[int] = []
            for k in sorted(found, key=lambda k: -saved[k]):
                if saved[k] > 1e-9 and all(j[k] <= i[other] or j[other] <= i[k] for other in taken):
                    taken.append(k)
            for k in sorted(taken, key=lambda k: -int(i[k])):
                path = np.concatenate([path[: i[k]], found[k], path[j[k] + 1 :]])
        return path

    def fingerprint(self) -> str:
        """Return a text that is equal for worlds with the same free configurations."""
        return fingerprint_of("kept", self.world.fingerprint(), *self.keeps)

    def explain(self, q: Floats) -> str:
        """Return in words why one configuration, (dim,), is not free: a contact, or a violated constraint."""
        shares = self.shares(q[np.newaxis])[0]
        return self.world.explain(q) if (shares <= 1.0).all() else self.exceeded(shares)

    def exceeded(self, shares: Floats) -> str:
        """Return in words which residual is too large, and by how much; `shares`, (c,), are those of the limits."""
        k = int(shares.argmax())
        keep = self.keeps[k]
        return keep.words(float(keep.off(np.array([shares[k] * keep.limit]))[0]))


def drop_blocked(good: Bools, motion: Ints, *checks: Callable[[Ints], Bools]) -> None:
    """Clear the entries in `good` of motions with a blocked step; `motion` is the motion of each state.

    Each check returns which steps are free, given the numbers of the states at which they begin.
    """
    steps = np.flatnonzero(motion[1:] == motion[:-1])
    for is_free in checks:
        steps = steps[good[motion[steps]]]
        if len(steps):
            good[motion[steps[~is_free(steps)]]] = False


def turned_round(motion: Ints, states: Floats, back: Bools) -> tuple[Ints, Floats]:
    """Return the states of motions, in reverse order for those in `back`, (m,), and the motion of each state."""
    number, until = np.arange(len(motion)), np.searchsorted(motion, motion, "right")
    begins = np.searchsorted(motion, motion, "left")
    return motion, states[np.where(back[motion], begins + until - 1 - number, number)]


def is_backwards(a: Floats, b: Floats) -> Bools:
    """Return which rows of `a` come after those of `b`, (m, dim) each, in lexicographic order."""
    moved = b - a
    number = (moved != 0.0).argmax(axis=1)
    return np.asarray(moved[np.arange(len(a)), number] < 0.0)


def _without(states: Floats, counts: Ints, off: Bools) -> tuple[Floats, Ints]:
    """Return the states of motions, and the number of each, without motions that have a state in `off`."""
    motion = np.repeat(np.arange(len(counts)), counts)
    good = np.ones(len(counts), dtype=np.bool_)
    good[motion[off]] = False
    return states[good[motion]], np.where(good, counts, 0)


def kept_line(world: KeptWorld, line: Followed) -> Followed:
    """Return a followed line or curve, without its path if that violates the constraints."""
    if len(line.path) < 2:
        return line
    largest = world.largest(line.path)
    return line if (largest <= 1.0).all() else Followed(line.path[:1], f"along it {world.exceeded(largest)}")
