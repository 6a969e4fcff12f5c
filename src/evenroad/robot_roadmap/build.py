"""Building roadmaps: of any world by joining points, of an arm by milestones that random scenes leave free."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from evenroad._arrays import Floats, Ints, Ints32
from evenroad._call import explains_calls
from evenroad._checks import require_count
from evenroad._rng import RngLike, generator
from evenroad.errors import InvalidValue
from evenroad.points import PointSet
from evenroad.roadmap.neighbours import nearest
from evenroad.roadmap.point_roadmap import Roadmap, roadmap_of_points
from evenroad.roadmap.points_of import as_points
from evenroad.roadmap.rules import KNearest, Rule
from evenroad.robot import ArmWorld, in_scene, scene_seen_by
from evenroad.robot_roadmap.arm_roadmap import ArmRoadmap, read_only
from evenroad.robot_roadmap.recipe import MEASURED, Recipe, chosen, displacement_weights, precomputed, recipe_for
from evenroad.robot_roadmap.turns import OneTurn, one_turn, shifts, whole_turns, winding_motions_free
from evenroad.space import JointSpace
from evenroad.world import World

MOST = 1 << 15
"""Largest number of milestones: ordering them takes time with the square of their number."""

TRIED = 60
"""Number of nearest milestones that each is tried to be joined to."""

K = 16
"""Default number of neighbours of a milestone of an arm."""

Progress = Callable[[str, float], None]


@explains_calls
def build_roadmap(
    world: World,
    points: int | PointSet,
    *,
    rule: Rule | None = None,
    rng: RngLike = 0,
    progress: Progress = lambda what, share: None,
) -> Roadmap:
    """Build a roadmap of a world once, for many queries in it and in worlds that have more obstacles.

    For an arm, milestones and edges are proved free of the arm and of the scene of `world`, which takes some seconds.
    For other worlds they are candidates, checked when a query needs them.

    Parameters
    ----------
    world : World
        For an arm: the robot with all that never moves (mount, fence, walls, a scan) and the ranges to plan in.
    points : int or PointSet
        The milestones, or their number.  For an arm they are chosen from Halton's points, each as far as
        possible from the earlier ones in the metric of displacement.  They are denser where random scenes leave the arm
        free and around narrow passages.  In other worlds they are even points.
    rule : Rule, optional
        How milestones are joined.  Default for an arm: each to the 16 nearest that it can reach, ``KNearest(16)``; no
        other kind of rule is possible.  Default else: the 20 nearest, or 2 d.
    rng : int, SeedSequence or Generator
        Seed of what is drawn for an arm.
    progress : callable, optional
        Called with the name of the step and the share of it that is done; for an arm only.

    Returns
    -------
    Roadmap
        ``roadmap.within(world)`` plans, ``roadmap.save(file)`` writes it.

    Raises
    ------
    InvalidValue
        If an argument is no such value, or the arm is never free; the text says what blocks it.

    Examples
    --------
    >>> import evenroad as er
    >>> world = er.FunctionWorld(er.spaces.Rectangle((0, 0), (1, 0), (0, 1)), lambda q: q[:, 0] < 2, resolution=0.1)
    >>> er.build_roadmap(world, 64).within(world).plan((0.1, 0.1), (0.9, 0.9)).solved
    True
    """
    if not isinstance(world, ArmWorld):
        return roadmap_of_points(world.space, points, rule)
    rule = KNearest(K) if rule is None else rule
    if not isinstance(rule, KNearest):
        raise InvalidValue(f"a roadmap of an arm joins each milestone to its nearest: KNearest(k), not {rule}")
    if isinstance(points, int | np.integer):
        return arm_roadmap(world, points, rule.k, rng=rng, progress=progress)
    world, points = _static(world), as_points(points, world.space, rule)
    one = one_turn(world.space, whole_turns(world.robot))
    q = one.low + points.points * (one.high - one.low)
    q = q[world.valid(q)]
    if not len(q):
        raise InvalidValue(f"the robot is free at none of the {points.n} points")
    return joined(_empty(world, displacement_weights(world.robot, q[:MEASURED])), q, rule.k)


def arm_roadmap(
    world: ArmWorld,
    n: int,
    k: int = K,
    *,
    recipe: Recipe | None = None,
    rng: RngLike = 0,
    progress: Progress = lambda what, share: None,
) -> ArmRoadmap:
    """Build a roadmap of n milestones that a recipe chooses, by default the one for this robot."""
    require_size(n, k)
    world = _static(world)
    if world.fixed_contact is not None:
        first, second = world.fixed_contact
        raise InvalidValue(f"the robot is never free: {first!r} always touches {second!r}")
    recipe, one = recipe or recipe_for(world.robot), one_turn(world.space, whole_turns(world.robot))
    known = precomputed(world, one, int(n), recipe, generator(rng).spawn(3), progress)
    progress("choosing and joining milestones", 0.0)
    milestones = known.pool[chosen(known, recipe, min(int(n), len(known.pool)))]
    return joined(_empty(world, known.weights), milestones, int(k))


def require_size(n: int, k: int) -> None:
    """Raise InvalidValue unless an arm's roadmap can have n milestones, each joined to k."""
    if require_count("n", n) > MOST:
        raise InvalidValue(f"n must be at most {MOST}, got {n}")
    require_count("k", k)


def _static(world: ArmWorld) -> ArmWorld:
    """Return the world of a robot with empty hands in its scene."""
    robot = in_scene(world.robot, world.scene)
    if robot.holds:
        raise InvalidValue(f"a roadmap is built of a robot with empty hands, not one that holds {robot.holds[0]!r}")
    return replace(world, robot=robot, scene=scene_seen_by(robot, world.scene))


def _empty(world: ArmWorld, weights: Floats) -> ArmRoadmap:
    """Return a roadmap without milestones."""
    dim = world.space.dim
    return ArmRoadmap(
        world.robot,
        world.scene,
        milestones=np.empty((0, dim)),
        edges=np.empty((0, 2), np.int32),
        turns=np.empty((0, dim), np.int64),
        weights=weights,
        resolution=world.resolution,
        clearance=world.clearance,
    )


def joined(roadmap: ArmRoadmap, milestones: Floats, k: int) -> ArmRoadmap:
    """Return a roadmap with other milestones, (n, dim), each joined to the `k` nearest that it reaches
    by free motions.
    """
    edges, turns = _free_edges(roadmap.world, roadmap.one_turn, milestones, roadmap.weights, k)
    return read_only(replace(roadmap, milestones=milestones, edges=edges, turns=turns))


def _free_edges(world: ArmWorld, one: OneTurn, milestones: Floats, weights: Floats, k: int) -> tuple[Ints32, Ints]:
    """Return the motions to the `k` nearest that are proved free, (m, 2), and their turns, (m, dim)."""
    metric = JointSpace(one.low.tolist(), one.high.tolist(), one.wraps.tolist(), weights.tolist())
    near = nearest(milestones, min(max(TRIED, k), max(len(milestones) - 1, 1)), metric)
    count, own = len(milestones), np.arange(len(milestones))[:, np.newaxis]
    # One number for a pair: rows take much longer to sort.
    numbers, which = np.unique(np.minimum(own, near) * count + np.maximum(own, near), return_inverse=True)
    pairs, which = np.stack(np.divmod(numbers, count), axis=1), which.reshape(near.shape)
    turns = shifts(one, milestones[pairs[:, 0]], milestones[pairs[:, 1]])
    checked, free = np.zeros((2, len(pairs)), dtype=np.bool_)
    reached = np.zeros(near.shape, dtype=np.bool_)
    for first in range(0, near.shape[1], k):
        # Farther ones only for those that still reach too few.
        rest = np.flatnonzero(reached.sum(axis=1) < k)
        some = which[rest, first : first + k]
        new = np.unique(some[~checked[some]])
        a, b = milestones[pairs[new, 0]], milestones[pairs[new, 1]]
        free[new] = winding_motions_free(world, one, a, b, turns[new])
        checked[new] = True
        reached[rest, first : first + k] = free[some]
    kept = np.unique(which[reached & (np.cumsum(reached, axis=1) <= k)])
    return pairs[kept].astype(np.int32), turns[kept].astype(np.int8)
