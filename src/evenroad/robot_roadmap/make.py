"""Making a roadmap for one robot in its cell, once: some seconds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._checks import require_count, require_positive
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.geometry.shapes import PRIMITIVES
from evenroad.points import draw
from evenroad.roadmap.neighbours import nearest
from evenroad.robot import ArmWorld, Robot, Scene, in_scene
from evenroad.robot_roadmap.chance import chance_of_freedom
from evenroad.robot_roadmap.pockets import ends_in_pockets
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.spread import displacement_weights, spread_order
from evenroad.robot_roadmap.turns import TURN, OneTurn, lifted_motions_free, one_turn, shifts, whole_turns
from evenroad.space import JointSpace

CANDIDATES = 16
"""Free configurations that one milestone is chosen from."""

MOST_DRAWN = 1 << 20
"""Where fewer than the wanted ones are free among so many, the robot is said to be hardly ever free."""

MOST = 1 << 15
"""Milestones: their order takes time with the square of their number."""

TRIED = 60
"""Nearest milestones that each is tried to be joined to."""

GAMMA = 2.0
"""Power of the chance of being free that milestones are as dense as, before the ends count."""

ENDS = 1500
"""Ends in pockets at random that milestones learn from."""

SCENES = 400
"""Random scenes by which the chance of being free is measured."""

FIRST = 1500
"""Configurations that the weights of the metric are measured on."""


def make_roadmap(
    robot: Robot,
    cell: Scene | None = None,
    n: int = 1024,
    *,
    k: int = 16,
    gamma: float = GAMMA,
    ends: int = ENDS,
    resolution: float = 0.05,
    rng: RngLike = 0,
    progress: Callable[[str, float], None] = lambda what, share: None,
) -> RobotRoadmap:
    """Make the roadmap of a robot in its cell: some seconds, once.

    Milestones are chosen from scrambled Sobol points that are free of robot and cell, each as far as possible from
    those before, in the metric of displacement, and denser where random scenes leave the robot free, and where ends in
    pockets at random can be joined to them: what fails without is an end that sees no milestone.

    Parameters
    ----------
    robot : Robot
        With its tool, if it has one.
    cell : Scene, optional
        What never moves around it: mount, fence, walls; and the ranges to plan in.  Default: nothing.
    n : int
        Milestones, 1 to 32768; fewer where hardly any configuration is free.
    k : int
        Each is joined to so many of its nearest ones that it can reach freely, >= 1, and to those that choose it.
    gamma : float, optional
        The spacing is in proportion to the chance of being free to the power of -gamma, >= 0.
    ends : int
        How many ends in pockets are learned from, >= 0.
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
    n, k, ends = require_count("n", n), require_count("k", k), require_count("ends", ends, at_least=0)
    if n > MOST:
        raise InvalidValue(f"n must be at most {MOST}, got {n}")
    cell = Scene("nothing") if cell is None else cell
    for obstacle in cell.obstacles:
        if obstacle.shape not in PRIMITIVES:
            raise InvalidValue(
                f"a cell must consist of {', '.join(PRIMITIVES)}, which a roadmap's file holds, got"
                f" {obstacle.name!r}, a {obstacle.body}: leave it to the scene of the day"
            )
    robot = in_scene(robot, cell)
    if robot.holds:
        raise InvalidValue(
            f"a roadmap is made of a robot with empty hands, not one that holds {robot.holds[0]!r}"
        )
    world = ArmWorld(robot, cell, resolution=resolution)
    if world.fixed_contact is not None:
        first, second = world.fixed_contact
        raise InvalidValue(f"the robot is never free in its cell: {first!r} always touches {second!r}")
    dim = world.space.dim
    gamma = require_positive("gamma", gamma, or_zero=True)
    pool_rng, scene_rng, pocket_rng = generator(rng).spawn(3)
    one = one_turn(world.space, whole_turns(robot))
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
    scaled = weights * pool
    seen = ends_in_pockets(
        robot, cell, pool, scaled, ends, pocket_rng, lambda share: progress("pockets", share)
    )
    progress("choosing milestones", 0.0)
    order = spread_order(scaled, weights * _periods(one), preference, n, seen.first, seen.which)
    progress("joining milestones", 0.0)
    nothing = RobotRoadmap(
        robot,
        cell,
        world.resolution,
        pool[:0],
        np.empty((0, 2), np.int32),
        np.empty((0, dim), np.int8),
        weights,
        gamma,
    )
    return joined(nothing, pool[order], k)


def joined(roadmap: RobotRoadmap, milestones: Floats, k: int) -> RobotRoadmap:
    """Return a roadmap with other milestones, (n, dim), each joined to the `k` nearest that it can reach freely."""
    edges, turns = _free_edges(roadmap.world, roadmap.one_turn, milestones, roadmap.weights, k)
    for array in (milestones, edges, turns, roadmap.weights):
        array.setflags(write=False)
    return replace(roadmap, milestones=milestones, edges=edges, turns=turns)


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
    """Return motions that are proved free, (m, 2), and their turns, (m, dim).

    Where joints turn more than once, motions to the nearest that leads over no end of a range are among them, too: what
    leads to the goal within one turn is not to be lost.
    """
    found = _joined_to_nearest(world, one, milestones, weights, k)
    if one.lifts.any():
        within = replace(one, wraps=one.wraps & ~one.lifts)
        more = _joined_to_nearest(world, within, milestones, weights, k)
        found = np.unique(np.concatenate([found, more]), axis=0)
    return found[:, :2].astype(np.int32), found[:, 2:].astype(np.int8)


def _joined_to_nearest(world: ArmWorld, one: OneTurn, milestones: Floats, weights: Floats, k: int) -> Ints:
    """Return two milestones and the turns of the motions to the `k` nearest that are proved free, (m, 2 + dim)."""
    metric = JointSpace(one.low.tolist(), one.high.tolist(), one.wraps.tolist(), weights.tolist())
    near = nearest(milestones, min(max(TRIED, k), max(len(milestones) - 1, 1)), metric)
    own = np.repeat(np.arange(len(milestones)), near.shape[1])
    pairs, which = np.unique(np.sort(np.stack([own, near.ravel()], axis=1)), axis=0, return_inverse=True)
    turns = shifts(one, milestones[pairs[:, 0]], milestones[pairs[:, 1]])
    free = lifted_motions_free(world, one, milestones[pairs[:, 0]], milestones[pairs[:, 1]], turns)
    reached = free[which.reshape(near.shape)]
    kept = reached & (np.cumsum(reached, axis=1) <= k)
    chosen = np.unique(which.reshape(near.shape)[kept])
    return np.concatenate([pairs[chosen], turns[chosen]], axis=1)
