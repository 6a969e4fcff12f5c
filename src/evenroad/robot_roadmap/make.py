"""Making a roadmap for one robot in its cell, once: some seconds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._checks import require_count, require_positive
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.roadmap.neighbours import nearest
from evenroad.robot import ArmWorld, Robot, Scene, in_scene, scene_seen_by
from evenroad.robot.robot import require_robot
from evenroad.robot_roadmap.recipe import GAMMA, Recipe, chosen, ends_for, known_of
from evenroad.robot_roadmap.robot_roadmap import RobotRoadmap
from evenroad.robot_roadmap.turns import OneTurn, lifted_motions_free, one_turn, shifts, whole_turns
from evenroad.space import JointSpace

MOST = 1 << 15
"""Milestones: their order takes time with the square of their number."""

TRIED = 60
"""Nearest milestones that each is tried to be joined to."""


def make_roadmap(
    robot: Robot,
    cell: Scene | None = None,
    n: int = 1024,
    *,
    k: int = 16,
    gamma: float = GAMMA,
    ends: int | None = None,
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
        What never moves around it: mount, fence, walls, a scan; and the ranges to plan in.  Default: nothing.
    n : int
        Milestones, 1 to 32768; fewer where hardly any configuration is free.
    k : int
        Each is joined to so many of its nearest ones that it can reach freely, >= 1, and to those that choose it.
    gamma : float, optional
        The spacing is in proportion to the chance of being free to the power of -gamma, >= 0.
    ends : int, optional
        How many ends in pockets are learned from, >= 0.  Default: 3000, fewer for a robot of more than 60 pairs of
        capsules, but 300 at least.
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
    require_robot(robot)
    require_settings(n, k, gamma, resolution)
    n, k, gamma = int(n), int(k), float(gamma)
    ends = ends_for(robot) if ends is None else require_count("ends", ends, at_least=0)
    cell = Scene(name="nothing") if cell is None else cell
    robot = in_scene(robot, cell)
    cell = scene_seen_by(robot, cell)
    if robot.holds:
        raise InvalidValue(
            f"a roadmap is made of a robot with empty hands, not one that holds {robot.holds[0]!r}"
        )
    world = ArmWorld(robot, cell, resolution=resolution)
    if world.fixed_contact is not None:
        first, second = world.fixed_contact
        raise InvalidValue(f"the robot is never free in its cell: {first!r} always touches {second!r}")
    recipe, one = Recipe(gamma, ends), one_turn(world.space, whole_turns(robot))
    known = known_of(world, one, n, recipe, generator(rng).spawn(3), progress)
    progress("choosing and joining milestones", 0.0)
    nothing = RobotRoadmap(
        robot,
        cell,
        world.resolution,
        known.pool[:0],
        np.empty((0, 2), np.int32),
        np.empty((0, world.space.dim), np.int8),
        known.weights,
        gamma,
        ends,
    )
    return joined(nothing, known.pool[chosen(known, recipe, min(n, len(known.pool)))], k)


def require_settings(n: int, k: int, gamma: float, resolution: float) -> None:
    """Raise InvalidValue unless these numbers are what `make_roadmap` takes: what costs nothing to refuse."""
    require_count("n", n)
    if n > MOST:
        raise InvalidValue(f"n must be at most {MOST}, got {n}")
    require_count("k", k)
    require_positive("gamma", gamma, or_zero=True)
    require_positive("resolution", resolution)


def joined(roadmap: RobotRoadmap, milestones: Floats, k: int) -> RobotRoadmap:
    """Return a roadmap with other milestones, (n, dim), each joined to the `k` nearest that it can reach freely."""
    edges, turns = _free_edges(roadmap.world, roadmap.one_turn, milestones, roadmap.weights, k)
    for array in (milestones, edges, turns, roadmap.weights):
        array.setflags(write=False)
    return replace(roadmap, milestones=milestones, edges=edges, turns=turns)


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
    which = which.reshape(near.shape)
    turns = shifts(one, milestones[pairs[:, 0]], milestones[pairs[:, 1]])
    asked, free = np.zeros((2, len(pairs)), dtype=np.bool_)
    reached = np.zeros(near.shape, dtype=np.bool_)
    for first in range(0, near.shape[1], k):
        # Farther ones only for those that still reach too few.
        rest = np.flatnonzero(reached.sum(axis=1) < k)
        some = which[rest, first : first + k]
        new = np.unique(some[~asked[some]])
        a, b = milestones[pairs[new, 0]], milestones[pairs[new, 1]]
        free[new] = lifted_motions_free(world, one, a, b, turns[new])
        asked[new] = True
        reached[rest, first : first + k] = free[some]
    kept = reached & (np.cumsum(reached, axis=1) <= k)
    chosen = np.unique(which[kept])
    return np.concatenate([pairs[chosen], turns[chosen]], axis=1)
