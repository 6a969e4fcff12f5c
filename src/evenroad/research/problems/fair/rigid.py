"""Rigid bodies among random boxes, in the plane and in space: a family that no default was chosen with.

The obstacles are scattered over more than the body can reach, so that their density is the same everywhere that it
can: as free at the bounds of the space as in its middle.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import numpy.typing as npt

from evenroad.geometry import rotation_from_heading, rotation_from_quaternion
from evenroad.research.bench.problem import Problem
from evenroad.research.problems.fair.query import draw_query, far_on_torus
from evenroad.research.problems.fair.streams import Family, Stream, instance_rng
from evenroad.space import SE2, SE3
from evenroad.world.solids import OrientedBox, SolidWorld

DENSITY = {2: 25.0, 3: 60.0}
"""Dimension of the place -> boxes in a unit of area or volume."""

BODY = {
    2: (OrientedBox((0.0, -0.04), (0.10, 0.02)), OrientedBox((-0.08, 0.04), (0.02, 0.06))),
    3: (
        OrientedBox((0.0, -0.06, 0.0), (0.14, 0.03, 0.03)),
        OrientedBox((-0.11, 0.05, 0.0), (0.03, 0.08, 0.03)),
        OrientedBox((0.11, -0.06, 0.08), (0.03, 0.03, 0.05)),
    ),
}
"""An L in the plane, and in space one with a foot: each side of them can be in the way."""

BODY_REACH = {2: 0.15, 3: 0.22}
"""How far the body reaches from its reference point, at most."""

RESOLUTION = {2: (0.01, 0.05), 3: (0.02, 0.08)}
"""Way, and turn [rad] as the space measures it, between states that are tested on a motion."""

TURN_WEIGHT = {2: 0.15, 3: 0.3}
"""What a radian of the space's metric counts: about the way that it moves the far end of the body."""


def rigid_problem(stream: Stream, family: Family, difficulty: int, size: float, instance: int) -> Problem:
    """Return one instance among boxes with half extents about `size`; sets have all 3 or 6 coordinates."""
    dim = 2 if family is Family.SE2 else 3
    cube_dim = 3 if dim == 2 else 6
    rng = instance_rng(stream, family, cube_dim, difficulty, instance)
    world, start, goal = draw_query(partial(draw_clutter, dim, size), partial(places_far_apart, dim), rng)
    return Problem(world, start, goal, set_dim=cube_dim)


def draw_clutter(dim: int, size: float, rng: np.random.Generator) -> SolidWorld:
    """Return a body in the unit square or cube among boxes turned at random, half extents in [.4, 1.6] times `size`."""
    margin = BODY_REACH[dim] + 1.6 * size * np.sqrt(dim)
    count = rng.poisson(DENSITY[dim] * (1.0 + 2.0 * margin) ** dim)
    centres = -margin + (1.0 + 2.0 * margin) * rng.random((count, dim))
    half_extents = size * (0.4 + 1.2 * rng.random((count, dim)))
    turns = [_random_turn(dim, rng) for _ in range(count)]
    obstacles = [
        OrientedBox(centre, extents, turn)
        for centre, extents, turn in zip(centres.tolist(), half_extents.tolist(), turns, strict=True)
    ]
    weights = (1.0, TURN_WEIGHT[dim])
    space = (
        SE2([0.0] * 2, [1.0] * 2, weights=weights) if dim == 2 else SE3([0.0] * 3, [1.0] * 3, weights=weights)
    )
    return SolidWorld(space, BODY[dim], obstacles, RESOLUTION[dim])


def places_far_apart(
    dim: int, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """Return which rows of the unit cube have places as far apart as :func:`far_on_torus` asks; turns are free."""
    return far_on_torus(a[:, :dim], b[:, :dim])


def _random_turn(dim: int, rng: np.random.Generator) -> tuple[float, ...]:
    if dim == 2:
        return rotation_from_heading(float(rng.uniform(-np.pi, np.pi)))
    return rotation_from_quaternion(rng.standard_normal(4).tolist())
