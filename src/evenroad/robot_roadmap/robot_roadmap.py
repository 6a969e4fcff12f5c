"""RobotRoadmap: milestones and motions that are free of a robot itself and of its fixed cell, whatever the day brings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from evenroad._arrays import Bools, Floats, Ints, Ints32
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.points import draw
from evenroad.roadmap.neighbours.find import nearest
from evenroad.robot import ArmWorld, Robot, Scene
from evenroad.robot.arm_world import RECHECK_TOLERANCE
from evenroad.robot_roadmap.chance import chance_of_freedom
from evenroad.robot_roadmap.spread import displacement_weights, spread_order
from evenroad.robot_roadmap.turns import TURN, OneTurn, one_turn, shifts
from evenroad.space import JointSpace

CANDIDATES = 16
"""Free configurations that one milestone is chosen from."""

BATCH = 4096
"""Configurations that are drawn at once, until enough are free."""

MOST_DRAWN = 1 << 20
"""Where fewer than the wanted ones are free among so many, the robot is said to be hardly ever free."""

TRIED = 60
"""Nearest milestones that each is tried to be joined to."""

SCENES = 400
"""Random scenes by which the chance of being free is measured."""

FIRST = 1500
"""Configurations that the weights of the metric are measured on."""


@dataclass(frozen=True, eq=False)
class RobotRoadmap:
    """Milestones and motions of a robot in its cell; made once by :func:`make_roadmap`, good for every scene.

    Attributes
    ----------
    robot : Robot
        Whose roadmap it is.
    cell : Scene
        What never moves around it.
    resolution : float
        Largest step of a motion check [rad].
    milestones : ndarray, shape (n, dim)
        Free of robot and cell, of which every beginning is well spread [rad or m]; read-only.
    edges : ndarray of int32, shape (m, 2)
        Motions that are proved free of robot and cell, smaller row first, ascending; read-only.
    turns : ndarray of int8, shape (m, dim)
        By how many turns each edge leads past its second milestone; read-only.
    weights : ndarray, shape (dim,)
        What a unit of each joint counts in the roadmap's metric.
    gamma : float
        The power of the chance of being free that milestones are as dense as.
    """

    robot: Robot
    cell: Scene
    resolution: float
    milestones: Floats
    edges: Ints32
    turns: Ints
    weights: Floats
    gamma: float

    @cached_property
    def world(self) -> ArmWorld:
        """The robot in its cell alone."""
        return ArmWorld(self.robot, self.cell, resolution=self.resolution)

    @cached_property
    def one_turn(self) -> OneTurn:
        """The ranges that the milestones are in."""
        return one_turn(self.world.space, revolute(self.robot))

    @cached_property
    def ways(self) -> Any:
        """The roadmap by node, for the compiled search."""
        from evenroad.robot_roadmap.lazy_search import Ways

        one, m = self.one_turn, len(self.edges)
        own = np.concatenate([self.edges[:, 0], self.edges[:, 1]]).astype(np.int64)
        order = np.argsort(own, kind="stable")
        first = np.searchsorted(own[order], np.arange(len(self.milestones) + 1))
        turned = np.where(one.lifts, self.turns, 0) @ (16 ** np.arange(self.turns.shape[1]))
        return Ways(
            self.milestones,
            first,
            np.concatenate([self.edges[:, 1], self.edges[:, 0]])[order].astype(np.int64),
            np.tile(np.arange(m), 2)[order],
            np.concatenate([turned, -turned])[order],
            np.tile(self.lengths, 2)[order],
            self.weights,
            one.limits,
            one.lifts,
            one.wraps & ~one.lifts,
            m,
        )

    @property
    def lengths(self) -> Floats:
        """Lengths of the edges in the roadmap's metric, (m,)."""
        a, b = self.milestones[self.edges[:, 0]], self.milestones[self.edges[:, 1]]
        return np.linalg.norm(self.weights * (b + TURN * self.turns - a), axis=1)


def revolute(robot: Robot) -> Bools:
    """Return which joints of the group turn, (dim,); the others slide."""
    kinds = {joint.name: joint.kind for joint in robot.joints}
    return np.array([kinds[name] != "prismatic" for name in robot.group])


def make_roadmap(
    robot: Robot,
    cell: Scene | None = None,
    n: int = 1024,
    *,
    k: int = 16,
    gamma: float | None = None,
    resolution: float = 0.05,
    rng: RngLike = 0,
    progress: Callable[[str, float], None] = lambda what, share: None,
) -> RobotRoadmap:
    """Make the roadmap of a robot in its cell: some seconds, once.

    Milestones are chosen from scrambled Sobol points that are free of robot and cell, each as far as possible from
    those before, in the metric of displacement, and denser where random scenes leave the robot free.

    Parameters
    ----------
    robot : Robot
        With its tool, if it has one.
    cell : Scene, optional
        What never moves around it: mount, fence, walls.  Default: nothing.
    n : int
        Milestones, >= 1.
    k : int
        Each is joined to so many of its nearest ones that it can reach freely, >= 1, and to those that choose it.
    gamma : float, optional
        The spacing is in proportion to the chance of being free to the power of -gamma, >= 0.  Default: 8 for 64
        milestones, 6 for 256, 4 from 1024 on; 0 for seven joints and more, where it was no gain.
    resolution : float
        Largest step of a motion check, > 0 [rad].
    rng : int, SeedSequence or Generator
        Of the pool and the random scenes.
    progress : callable, optional
        Called with what is being done and its share that is over.

    Raises
    ------
    InvalidValue
        If an argument is no such number, or the robot is never free in its cell; the text says what blocks.
    """
    n, k = require_count("n", n), require_count("k", k)
    cell = Scene("nothing") if cell is None else cell
    world = ArmWorld(robot, cell, resolution=resolution)
    dim = world.space.dim
    gamma = default_gamma(n, dim) if gamma is None else float(gamma)
    if not (np.isfinite(gamma) and gamma >= 0.0):
        raise InvalidValue(f"gamma must be a finite number >= 0, got {gamma!r}")
    pool_rng, scene_rng = generator(rng).spawn(2)
    one = one_turn(world.space, revolute(robot))
    progress("drawing configurations", 0.0)
    pool = _free_pool(world, one, CANDIDATES * n, pool_rng)
    n = min(n, len(pool))
    weights = displacement_weights(robot, pool[:FIRST])
    preference = np.ones(len(pool))
    if gamma > 0.0:
        chance = chance_of_freedom(
            robot, pool, SCENES, scene_rng, lambda share: progress("random scenes", share)
        )
        preference = np.maximum(chance, 1.0 / SCENES) ** gamma
    progress("choosing milestones", 0.0)
    order = spread_order(weights * pool, weights * _periods(one), preference, n)
    milestones = pool[order]
    progress("joining milestones", 0.0)
    edges, turns = _free_edges(world, one, milestones, weights, k)
    for array in (milestones, edges, turns, weights):
        array.setflags(write=False)
    return RobotRoadmap(robot, cell, resolution, milestones, edges, turns, weights, gamma)


def default_gamma(n: int, dim: int) -> float:
    """Return the power that was best for so many milestones: fewer of them keep more to where there is room."""
    return 0.0 if dim >= 7 else float(np.clip(8.0 - np.log2(n / 64.0), 4.0, 8.0))


def _periods(one: OneTurn) -> Floats:
    """Return after how much each joint repeats for the spacing: a joint with stops repeats after its range."""
    return np.where(one.wraps, TURN, one.high - one.low)


def _free_pool(world: ArmWorld, one: OneTurn, count: int, rng: np.random.Generator) -> Floats:
    """Return the first free ones of a low-discrepancy sequence, (count, dim), or the fewer that MOST_DRAWN hold."""
    drawn = 2 * count
    while True:
        cube = draw("sobol", drawn, world.space.dim, rng=rng.spawn(1)[0]).points
        q = one.low + cube * (one.high - one.low)
        free = q[world.valid(q)]
        if len(free) >= count or drawn >= MOST_DRAWN:
            break
        drawn *= 2
    if not len(free):
        raise InvalidValue(
            f"the robot is never free in its cell: of {drawn} configurations none; in the last one"
            f" {world.explain(q[-1])}"
        )
    return free[:count]


def _free_edges(
    world: ArmWorld, one: OneTurn, milestones: Floats, weights: Floats, k: int
) -> tuple[Ints32, Ints]:
    """Return motions that are proved free, (m, 2), and their turns, (m, dim)."""
    metric = JointSpace(one.low, one.high, one.wraps.tolist(), weights.tolist())
    near = nearest(milestones, min(TRIED, max(len(milestones) - 1, 1)), metric)
    own = np.repeat(np.arange(len(milestones)), near.shape[1])
    pairs, which = np.unique(np.sort(np.stack([own, near.ravel()], axis=1)), axis=0, return_inverse=True)
    turns = shifts(one, milestones[pairs[:, 0]], milestones[pairs[:, 1]])
    free = motions_free(world, one, milestones[pairs[:, 0]], milestones[pairs[:, 1]], turns)
    reached = free[which.reshape(near.shape)]
    kept = reached & (np.cumsum(reached, axis=1) <= k)
    chosen = np.unique(which.reshape(near.shape)[kept])
    return pairs[chosen].astype(np.int32), turns[chosen].astype(np.int8)


def motions_free(world: ArmWorld, one: OneTurn, a: Floats, b: Floats, turns: Ints) -> Bools:
    """Return which motions are proved free, with both ends turned so that they are within the limits: (m,)."""
    b = np.where(one.lifts, b + TURN * turns, b)
    low, high = np.minimum(a, b), np.maximum(a, b)
    least, most = np.ceil((one.limits[0] - low) / TURN), np.floor((one.limits[1] - high) / TURN)
    turned = np.where(one.lifts, TURN * np.clip(0.0, least, most), 0.0)
    fits = np.all(~one.lifts | (least <= most), axis=1)
    free = np.zeros(len(a), dtype=np.bool_)
    free[fits] = world.motion_certified((a + turned)[fits], (b + turned)[fits], RECHECK_TOLERANCE)
    return free


def beginning(roadmap: RobotRoadmap, n: int) -> RobotRoadmap:
    """Return the roadmap of its first `n` milestones and the edges between them."""
    n = require_count("n", n)
    kept = np.all(roadmap.edges < n, axis=1)
    return replace(
        roadmap, milestones=roadmap.milestones[:n], edges=roadmap.edges[kept], turns=roadmap.turns[kept]
    )
