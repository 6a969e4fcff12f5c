"""Constraints of the tip for a trajectory, because its rounded corners may violate them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from evenroad._arrays import Bools, Floats
from evenroad.collision.arm_world import ArmWorld
from evenroad.constraints.constrained_world import KeptWorld, keeps_of, kept_world
from evenroad.geometry.curve import STEP
from evenroad.poses.cartesian_line import CartesianLine, between, line_at, misses
from evenroad.poses.chain import Chain, chain_of, default_tip
from evenroad.poses.constraint import Constraint, part_of
from evenroad.space import Space

FINE = 8
"""Number of states of each motion at which the distance from a straight line is measured."""


@dataclass(frozen=True, eq=False)
class ConstrainedWorld:
    """An arm's world whose strict check includes the constraints of the tip.

    The Cartesian lines of `straight` begin at the start and the goal of the planned `path`, (p, dim).
    """

    world: ArmWorld
    path: Floats
    straight: CartesianLine | None
    kept: KeptWorld | None

    @property
    def space(self) -> Space:
        """Space of the arm."""
        return self.world.space

    @property
    def proof(self) -> str:
        """The proof of the world, for collisions and constraints; lines are only measured."""
        return self.world.proof

    def valid(self, q: Floats) -> Bools:
        """As the world's."""
        free: Bools = self.world.valid(q)
        return free

    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """As the world's."""
        free: Bools = self.world.motion_valid(a, b)
        return free

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, dim), are proved free and keep the constraints: (p - 1,)."""
        good = self.world.validate(path)
        if self.kept is not None:
            good &= (self.kept.bounds(path) <= 1.0).all(axis=1)
        if self.straight is not None:
            chain = chain_of(self.world.robot, self.straight.tip or default_tip(self.world.robot))
            for end, length in ((0, self.straight.retreat), (-1, self.straight.approach)):
                # A part of a path that begins elsewhere has no line.
                if length and np.allclose(path[end], self.path[end], rtol=0.0, atol=1e-9):
                    waypoints = path if end == 0 else path[::-1]
                    off = self._off_line(chain, self.straight, waypoints, length)
                    good &= ~(off if end == 0 else off[::-1])
        return good

    def _off_line(self, chain: Chain, straight: CartesianLine, waypoints: Floats, length: float) -> Bools:
        """Return which motions of a path leave its first line, (p - 1,); the last half step may be a rounded corner."""
        turn, here, away = line_at(chain, straight, waypoints[0])
        off_m, off_rad, along = misses(chain, between(self.world, waypoints, FINE)[1:], here, away, turn)
        over = np.flatnonzero(along >= length - 0.5 * STEP)
        missed = (off_m > straight.line_tolerance) | (off_rad > straight.angle_tolerance)
        missed[over[0] if len(over) else len(missed) :] = False
        return np.asarray(missed.reshape(-1, FINE).any(axis=1))


def constrained_world(world: ArmWorld, path: Floats, constraints: Constraint | None) -> ConstrainedWorld | ArmWorld:
    """Return the world in which a path, (p, dim), keeps its constraints, if any."""
    if constraints is None:
        return world
    keeps = keeps_of(constraints)
    kept = kept_world(world, keeps, path[0], "") if keeps else None
    return ConstrainedWorld(world, path, part_of(constraints, CartesianLine), kept)
