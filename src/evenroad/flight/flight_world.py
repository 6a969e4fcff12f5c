"""FlightWorld: a ball that flies among the obstacles of a scene, with proofs of its states and motions."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from evenroad._arrays import Bools, Floats, set_fields
from evenroad._call import explains_calls
from evenroad._checks import FARTHEST, as_batch, as_row, counted, require_positive
from evenroad._fingerprint import fingerprint_of
from evenroad._native.flight import Airspace
from evenroad.errors import InvalidValue, NotAvailable, shown
from evenroad.flight.flight_bodies import FlightBodies, bodies_of
from evenroad.flight.flight_space import FlightSpace, of_axes
from evenroad.geometry.pose import Vector
from evenroad.scenes.scene import Scene
from evenroad.scenes.scene_file import load_scene
from evenroad.space.batch import as_batch_pair
from evenroad.world.one_or_many import OneOrMany, one_or_many

_BEYOND = 100.0
"""Least distance of the default bounds from the obstacles [m]."""
_NEAREST = 1e-2
"""Distance up to which an obstacle is named that is in the way, beyond the radius [m]."""


@explains_calls
@dataclass(frozen=True, eq=False, repr=False)
class FlightWorld(OneOrMany):
    """A ball with a velocity among obstacles, a double integrator: its acceleration is chosen at every instant.

    A state is x, y, z and the velocities along these; see :class:`evenroad.flight.FlightSpace` for the motion from one
    state to another.  A motion is free only if that is proved for all of it: it consists of parabolas, and a plane
    keeps each part of them away from each obstacle.  A motion that comes within about 1 mm of touching may be refused.

    Parameters
    ----------
    scene : Scene, str or path-like
        The obstacles, or the file or name of a scene: boxes, cylinders, spheres, capsules, meshes and clouds.
    radius : float
        Radius of the ball, > 0 [m].
    speed : float or sequence of 3 floats
        Largest speed along each axis, or along any of them, > 0 [m/s].
    acceleration : float or sequence of 3 floats
        Largest acceleration along each axis, > 0 [m/s^2].
    jerk : None
        Limits of the jerk are not supported yet.
    bounds : sequence of 3 pairs of floats, optional
        Least and largest x, y and z of the middle of the ball [m].  Two equal numbers hold an axis: the flight is then
        planar.  Default: the box around all obstacles, larger by its longest side and 100 m.

    Raises
    ------
    InvalidValue
        If a number is not such a one.
    NotAvailable
        For a limit of the jerk.

    Examples
    --------
    >>> import evenroad as er
    >>> scene = er.Scene([er.Cylinder(0.3, 4.0, xyz=(5, 0, 2), name="tree")])
    >>> world = er.FlightWorld(scene, radius=0.25, speed=6.0, acceleration=8.0)
    >>> result = er.plan(world, er.State((0, 0, 2)), er.State((10, 0.1, 2)))
    >>> result.status, result.proof
    (<Status.SOLVED: 'solved'>, 'certified')
    """

    scene: Scene
    radius: float = 0.25
    speed: Vector | float = field(kw_only=True)
    acceleration: Vector | float = field(kw_only=True)
    jerk: None = field(default=None, kw_only=True)
    bounds: Sequence[Sequence[float]] | None = field(default=None, kw_only=True)
    space: FlightSpace = field(init=False, repr=False)
    airspace: Airspace = field(init=False, repr=False)
    """The obstacles and limits, as compiled code has them."""
    _bodies: FlightBodies = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if self.jerk is not None:
            raise NotAvailable(f"limits of the jerk are not supported yet: leave jerk out, got {shown(self.jerk)}")
        scene = load_scene(self.scene) if isinstance(self.scene, str | os.PathLike) else self.scene
        if not isinstance(scene, Scene):
            raise InvalidValue(f"scene must be a Scene, or the file or name of one, got {shown(self.scene)}")
        radius = require_positive("radius", self.radius, at_most=FARTHEST)
        speed, acceleration = of_axes("speed", self.speed), of_axes("acceleration", self.acceleration)
        bodies = bodies_of(scene)
        low, high = _default_bounds(bodies.box) if self.bounds is None else _as_bounds(self.bounds)
        space = FlightSpace(low, high, speed, acceleration)
        airspace = Airspace(bodies.solids, bodies.triangles, bodies.balls, np.array([low, high]), space.native, radius)
        set_fields(self, scene=scene, radius=radius, speed=speed, acceleration=acceleration)
        set_fields(self, bounds=tuple(zip(low, high, strict=True)), space=space, airspace=airspace, _bodies=bodies)

    def __reduce__(self) -> tuple[object, ...]:
        """Return what a copy is made of, here or in another process: it makes its own tables."""
        return _world_of, (self.scene, self.radius, self.speed, self.acceleration, self.bounds)

    @property
    def proof(self) -> str:
        """What a check of a motion shows: ``certified``.

        It is never called free if it is not, but may be refused where it comes within about 1 mm of touching.
        """
        return "certified"

    def __repr__(self) -> str:
        names = self.scene.names
        limits = f"speed {self.speed}, acceleration {self.acceleration}"
        return f"FlightWorld({counted(len(names), 'obstacle')}, radius {self.radius:g}, {limits})"

    @one_or_many
    def valid(self, q: Floats) -> Bools:
        """Return whether the ball is free, within bounds and not too fast in each state, (n, 6): (n,)."""
        states = as_batch("q", q, 6)
        free = self.airspace.states_free(states)
        for solid in self._bodies.inside:
            free &= ~solid.contains(states[:, :3])
        return free

    @one_or_many
    def motion_valid(self, a: Floats, b: Floats) -> Bools:
        """Return whether the quickest motion from each row of `a` to that of `b` is proved free: two (m, 6) -> (m,)."""
        first, second = as_batch_pair(a, b, 6)
        free = self.airspace.motions_free(first, second)
        for solid in self._bodies.inside:
            # A ball that touches no side of a mesh on its way stays outside.
            free &= ~solid.contains(first[:, :3])
        return free

    def validate(self, path: Floats) -> Bools:
        """Return which motions of a path, (p, 6), are proved free: (p - 1,)."""
        states = as_batch("path", path, 6)
        return np.asarray(self.motion_valid(states[:-1], states[1:]))

    def explain(self, q: Floats) -> str:
        """Return, in words, why a state, (6,), is not free: a limit, or the obstacle that is touched."""
        state = as_batch("q", [q], 6)
        low, high = self.space.box
        for name, value, least, most in zip(self.space.names, state[0], low, high, strict=True):
            if not least <= value <= most:
                return f"{name} must be from {least:.6g} to {most:.6g}, got {value:.6g}"
        for solid in self._bodies.inside:
            if solid.contains(state[:, :3])[0]:
                return f"it is inside of {solid.name!r}"
        found = self.airspace.nearest(state[0, :3].copy(), self.radius + _NEAREST)
        if found.body < 0:
            return "nothing touches"
        by = f"its middle is {found.distance:.3g} m away and its radius {self.radius:g} m"
        return f"the ball touches {self._bodies.name_of(found.body)!r}: {by}"

    def fingerprint(self) -> str:
        """Return the SHA-256 (hex) of obstacles, ball and limits: equal for worlds of equal results."""
        return fingerprint_of(
            "flight", self.scene.fingerprint(), self.radius, self.speed, self.acceleration, self.bounds
        )


def _world_of(scene: Scene, radius: float, speed: Vector, acceleration: Vector, bounds: object) -> FlightWorld:
    return FlightWorld(scene, radius, speed=speed, acceleration=acceleration, bounds=bounds)  # type: ignore[arg-type]


def _as_bounds(bounds: Sequence[Sequence[float]]) -> tuple[Vector, Vector]:
    """Return the corners of bounds that are given as pairs."""
    wanted = "bounds must be three pairs of finite numbers, (least, largest) of x, y and z"
    try:
        pairs = [as_row("bounds", pair, 2, within=FARTHEST) for pair in bounds]
    except (TypeError, InvalidValue):
        pairs = []
    if len(pairs) != 3 or any(least > most for least, most in pairs):
        raise InvalidValue(f"{wanted}, got {shown(bounds)}")
    (x, right), (y, back), (z, top) = pairs
    return (x, y, z), (right, back, top)


def _default_bounds(box: Floats) -> tuple[Vector, Vector]:
    beyond = _BEYOND + float((box[1] - box[0]).max())
    low, high = np.clip(box + np.array([[-beyond], [beyond]]), -FARTHEST, FARTHEST).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])
